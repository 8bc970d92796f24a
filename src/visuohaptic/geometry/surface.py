"""A triangle surface with colours, as every phase after the meshes takes it, and its file."""

from __future__ import annotations

import gzip
import io
import json
import tempfile
import zlib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from visuohaptic.errors import MeshError
from visuohaptic.geometry.ply_header import LONGEST, check_ply_size, read_ply_header

_BLOCK_BYTES = 1 << 20

_SET_ASIDE = "set aside: "
_LONGEST_HEADER = 1 << 14  # bytes


@dataclass(frozen=True, eq=False)
class Surface:
    """A triangle mesh with one colour a face; it is equal to itself alone.

    Attributes
    ----------
    vertices : numpy.ndarray
        Shape (v, 3), float64; right-handed, y up. In the object frame the
        bounding sphere's centre is the origin and its radius 1.
    faces : numpy.ndarray
        Shape (f, 3), int64; rows of `vertices`.
    face_colours : numpy.ndarray
        Shape (f, 3), uint8, sRGB.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    face_colours: NDArray[np.uint8]

    def __repr__(self) -> str:
        return f"<Surface: {len(self.vertices):,} vertices, {len(self.faces):,} triangles>"

    @cached_property
    def triangles(self) -> NDArray[np.float64]:
        """Corners of each face, shape (f, 3, 3)."""
        return self.vertices[self.faces]

    @cached_property
    def face_crosses(self) -> NDArray[np.float64]:
        """Cross product of two edges of each face, shape (f, 3); its length is twice the area."""
        corners = self.triangles
        return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])

    @cached_property
    def face_areas(self) -> NDArray[np.float64]:
        """Area of each face in squared units of the vertices, shape (f,)."""
        return 0.5 * np.linalg.norm(self.face_crosses, axis=1)

    @cached_property
    def face_normals(self) -> NDArray[np.float64]:
        """Unit normal of each face by its winding, shape (f, 3); zero for a face without area."""
        crosses = self.face_crosses
        lengths = np.linalg.norm(crosses, axis=1, keepdims=True)
        return np.divide(crosses, lengths, out=np.zeros_like(crosses), where=lengths > 0)


def as_stored(surface: Surface) -> Surface:
    """Round a surface's vertices to the float32 numbers that its file would hold."""
    vertices = surface.vertices.astype(np.float32).astype(np.float64)
    return replace(surface, vertices=vertices)


def write_set_aside(path: str | Path, reason: str) -> None:
    """Write an empty surface, with the reason, in place of a model that can't be used."""
    empty = Surface(np.zeros((0, 3)), np.zeros((0, 3), np.int64), np.zeros((0, 3), np.uint8))
    write_surface(empty, path, comment=f"{_SET_ASIDE}{json.dumps(reason)}")


def set_aside_reason(path: str | Path) -> str | None:
    """Give the sentence why an object was set aside; None for an object that takes part."""
    start = f"comment {_SET_ASIDE}"
    with Path(path).open("rb") as stream:
        header = stream.read(_LONGEST_HEADER).partition(b"end_header")[0].decode(errors="replace")
    for line in header.splitlines():
        if line.startswith(start):
            return str(json.loads(line[len(start) :]))
    return None


def usable_meshes(paths: Iterable[str | Path]) -> list[Path]:
    """List the mesh files of objects that take part, in the given order."""
    return [path for path in map(Path, paths) if set_aside_reason(path) is None]


def write_surface(surface: Surface, path: str | Path, comment: str = "") -> None:
    """Write a surface as binary PLY, gzipped where the name ends in ``.gz``.

    Vertices are stored as float32 (the precision of the ray caster), colours a
    byte a channel. The bytes depend on the surface alone.

    Parameters
    ----------
    surface : Surface
        What to write.
    path : path
        The file; its folder is made where missing.
    comment : str
        A line for the header.
    """
    from plyfile import PlyData, PlyElement

    vertex = np.zeros(len(surface.vertices), dtype=[("x", "<f4"), ("y", "<f4"), ("z", "<f4")])
    for axis, name in enumerate("xyz"):
        vertex[name] = surface.vertices[:, axis]
    face = np.zeros(
        len(surface.faces),
        dtype=[("vertex_indices", "<i4", (3,)), ("red", "u1"), ("green", "u1"), ("blue", "u1")],
    )
    face["vertex_indices"] = surface.faces
    for channel, name in enumerate(("red", "green", "blue")):
        face[name] = surface.face_colours[:, channel]
    elements = [PlyElement.describe(vertex, "vertex"), PlyElement.describe(face, "face")]
    comments = [comment] if comment else []
    header = PlyData(elements, byte_order="<", comments=comments).header
    # The library writes lists one by one; lists of one length are an array, each after its length.
    lists = np.zeros(len(face), dtype=[("length", "u1"), ("face", face.dtype)])
    lists["length"], lists["face"] = 3, face
    data = f"{header}\n".encode() + vertex.tobytes() + lists.tobytes()
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(gzip.compress(data, 9, mtime=0) if path.suffix == ".gz" else data)


def read_surface(path: str | Path, largest_megabytes: float = 512.0) -> Surface:
    """Read a surface that `write_surface` wrote.

    Parameters
    ----------
    path : path
        A ``.ply`` or ``.ply.gz`` file of triangles with face colours.
    largest_megabytes : float
        Files that are larger, unpacked, are refused, in 10⁶ bytes.

    Returns
    -------
    Surface
        Its vertices are float64 numbers that float32 holds exactly.

    Raises
    ------
    MeshError
        If the file is not such a surface, holds less than its header says, or is too large.
    """
    from plyfile import PlyData, PlyParseError

    try:
        with _plain_file(Path(path), largest_megabytes) as stream:
            _check_header(stream)
            data = PlyData.read(stream, known_list_len={"face": {"vertex_indices": 3}})
        vertex, face = data["vertex"], data["face"]
        vertices = np.column_stack([vertex[name] for name in "xyz"]).astype(np.float64)
        faces = np.asarray(face["vertex_indices"], dtype=np.int64).reshape(-1, 3)
        colours = np.column_stack([face[name] for name in ("red", "green", "blue")])
    except (OSError, EOFError, zlib.error, PlyParseError, KeyError, ValueError) as error:
        raise MeshError(
            f"{path} is no coloured triangle mesh of this workflow: {error}."
        ) from error
    return Surface(vertices, faces, colours.astype(np.uint8))


def _check_header(stream: BinaryIO) -> None:
    """Refuse, before any row is read, what `write_surface` can't have written."""
    header = read_ply_header(stream.read(LONGEST))
    if header.ascii:
        raise ValueError("it is text, and binary is needed; a PLY of your own is read without .gz")
    check_ply_size(header, stream.seek(0, io.SEEK_END))
    stream.seek(0)


@contextmanager
def _plain_file(path: Path, largest_megabytes: float) -> Iterator[BinaryIO]:
    """Open a file, or what it unpacks to: only what lies in a file is read as one array."""
    if path.suffix != ".gz":
        with path.open("rb") as plain:
            yield plain
        return
    with gzip.open(path, "rb") as packed, tempfile.TemporaryFile() as unpacked:
        while block := packed.read(_BLOCK_BYTES):
            unpacked.write(block)
            if unpacked.tell() > largest_megabytes * 1e6:
                raise MeshError(
                    f"{path} unpacks to more than {largest_megabytes:g} MB, which are allowed "
                    "(meshes.largest_megabytes)."
                )
        unpacked.seek(0)
        yield unpacked
