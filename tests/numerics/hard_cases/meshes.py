"""Broken model files and wild surfaces: they end in tables or in one clear sentence."""

import re
import tempfile
import warnings
from functools import cache
from pathlib import Path

import numpy as np
import trimesh
from numerics.shapes import run_chain, write_obj
from numerics.surfaces import draw_triangles

from visuohaptic.base.errors import MeshError
from visuohaptic.meshes.model_files import read_mesh
from visuohaptic.meshes.preparing import normalise
from visuohaptic.stability.findings import Finding

SUFFIXES = ("obj", "ply", "stl", "glb", "off")
TOKENS = (
    b"nan", b"inf", b"-inf", b"1e999", b"-1", b"0", b"99999999999999999999", b"1e-320", b"4294967295",
    b"f 1 2 3\n", b"v 0 0\n", b"f 0 0 0\n", b"f -1 -2 -3\n", b"end_header\n", b"element face 1000000000\n",
    b"property list uchar int vertex_indices\n", b"\x00\x00\x00\x00", b"\xff\xff\xff\xff", b"\n", b" ",
    b"mtllib /etc/passwd\n", b"f 1/1/1 2/2/2 9/9/9\n", b"facet normal nan nan nan\n", b"format ascii 1.0\n",
)  # fmt: skip


@cache
def whole_files(suffix):
    """Return whole files of a format."""
    coloured = trimesh.creation.box()
    coloured.visual.face_colors = np.arange(12)[:, None] * [20, 10, 5, 0] + [0, 0, 0, 255]
    meshes = [trimesh.creation.box(), trimesh.creation.icosphere(1), coloured]
    texts = {"ply": {"file_type": "ply", "encoding": "ascii"}, "stl": {"file_type": "stl_ascii"}}
    found = [mesh.export(file_type=suffix) for mesh in meshes]
    found += [meshes[0].export(**texts[suffix])] if suffix in texts else []
    return [one if isinstance(one, bytes) else one.encode() for one in found]


def break_file(suffix, generator):
    """Break a file of a format in up to eleven places."""
    files = whole_files(suffix)
    data = bytearray(files[generator.integers(len(files))])
    kind = generator.integers(8)
    if kind == 0:
        return bytes(data[: generator.integers(len(data) + 1)])
    if kind == 1:
        return generator.bytes(int(generator.integers(0, 400)))
    for _ in range(int(generator.integers(1, 12))):
        _break_once(data, files, generator)
    return bytes(data)


def _break_once(data, files, generator):
    place = int(generator.integers(len(data) + 1))
    length = int(generator.integers(1, 200))
    token = TOKENS[generator.integers(len(TOKENS))]
    match generator.integers(6):
        case 0:
            if place < len(data):
                data[place] ^= 1 << int(generator.integers(8))
        case 1:
            del data[place : place + length // 5]
        case 2:
            data[place : place + length % (len(token) + 1)] = token
        case 3:
            data[place:place] = data[place : place + length]
        case 4:
            other = files[generator.integers(len(files))]
            start = int(generator.integers(len(other)))
            data[place:place] = other[start : start + length]
        case _:
            numbers = list(re.finditer(rb"\d+(\.\d+)?", bytes(data)))
            if numbers:
                found = numbers[generator.integers(len(numbers))]
                data[found.start() : found.end()] = TOKENS[generator.integers(9)]


def judge(path):
    """Read a file; give what is wrong with what came, None where it is a surface or a clear refusal."""
    try:
        surface = normalise(read_mesh(path), path.name).surface
    except MeshError as error:
        text = str(error)
        clear = is_one_sentence(text) and path.name in text
        return None if clear else f"unclear refusal: {text[:200]!r}"
    except Exception as error:  # noqa: BLE001 whatever else comes out is the finding
        return f"{type(error).__name__}: {str(error)[:200]}"
    whole = (
        np.isfinite(surface.vertices).all()
        and np.linalg.norm(surface.vertices, axis=1).max() <= 1.0001
        and surface.faces.min() >= 0
        and surface.faces.max() < len(surface.vertices)
        and len(surface.face_colours) == len(surface.faces)
        and surface.face_areas.sum() > 0
    )
    return None if whole else "a surface that is not finite, not of unit size, or not whole"


def is_one_sentence(text):
    """Tell whether a refusal is one line that ends like a sentence."""
    one_line = "\n" not in text and "Traceback" not in text
    return one_line and text.endswith(".") and 10 < len(text) < 600


def broken_files(generator):
    """Read a broken file of each format: it is a surface, or refused in one sentence."""
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings(action="ignore"):
        for suffix in SUFFIXES:
            path = Path(folder) / f"input.{suffix}"
            path.write_bytes(break_file(suffix, generator))
            wrong = judge(path)
            name = "meshes/fuzzed files: crash, hang, NaN or an unclear refusal"
            yield Finding(name, wrong is not None, f"{suffix}: {wrong}")


def end_of(source, folder):
    """Run the chain; give `tables`, `refused`, or what went wrong."""
    try:
        tables = run_chain(source, folder)
    except MeshError as error:
        return "refused" if is_one_sentence(str(error)) else f"unclear refusal: {error}"
    sizes = {name: table.num_rows for name, table in tables.items()}
    return "tables" if len(set(sizes.values())) == 1 and sizes["features"] else f"rows {sizes}"


def wild_surfaces(generator):
    """Go from random triangles, slivers among them, to features."""
    surface = draw_triangles(generator, int(generator.integers(1, 41)))
    with tempfile.TemporaryDirectory() as folder:
        source = write_obj(Path(folder) / "mesh.obj", surface.vertices, surface.faces)
        end = end_of(source, Path(folder))
    wrong = end not in {"tables", "refused"}
    label = f"{len(surface.faces)} random triangles: {end}"
    yield Finding("meshes/random wild surfaces", wrong, label)
