"""Broken model files by the thousand, read in processes that may crash or hang without harm.

`python -m numerics.fuzzing worker FOLDER` reads lines ``suffix number`` from its input, makes each
file from its number alone, reads it, and prints one line of JSON an input.
"""

from __future__ import annotations

import json
import os
import re
import select
import subprocess
import sys
import time
from functools import cache
from pathlib import Path

import numpy as np
from source_folders import PYTHONPATH

SUFFIXES = ("obj", "ply", "stl", "glb", "off")
SECONDS_AN_INPUT = 20.0
MEMORY_BYTES = 3 << 30
TOKENS = (
    b"nan", b"inf", b"-inf", b"1e999", b"-1", b"0", b"99999999999999999999", b"1e-320", b"4294967295",
    b"f 1 2 3\n", b"v 0 0\n", b"f 0 0 0\n", b"f -1 -2 -3\n", b"end_header\n", b"element face 1000000000\n",
    b"property list uchar int vertex_indices\n", b"\x00\x00\x00\x00", b"\xff\xff\xff\xff", b"\n", b" ",
    b"mtllib /etc/passwd\n", b"f 1/1/1 2/2/2 9/9/9\n", b"facet normal nan nan nan\n", b"format ascii 1.0\n",
)  # fmt: skip


@cache
def seeds(suffix):
    """Give whole files of a format, as bytes."""
    import trimesh

    meshes = [trimesh.creation.box(), trimesh.creation.icosphere(1)]
    coloured = trimesh.creation.box()
    coloured.visual.face_colors = np.arange(12)[:, None] * [20, 10, 5, 0] + [0, 0, 0, 255]
    meshes.append(coloured)
    found = []
    for mesh in meshes:
        exported = mesh.export(file_type=suffix)
        found.append(exported if isinstance(exported, bytes) else exported.encode())
    if suffix in ("ply", "stl"):
        exported = meshes[0].export(file_type="ply" if suffix == "ply" else "stl_ascii",
                                    **({"encoding": "ascii"} if suffix == "ply" else {}))  # fmt: skip
        found.append(exported if isinstance(exported, bytes) else exported.encode())
    return found


def make_input(suffix, number):
    """Break a file: cut, flip, drop, double, splice, and put hostile tokens and numbers in."""
    generator = np.random.default_rng([number, SUFFIXES.index(suffix)])
    files = seeds(suffix)
    data = bytearray(files[generator.integers(len(files))])
    kind = generator.integers(8)
    if kind == 0:
        return bytes(data[: generator.integers(len(data) + 1)])
    if kind == 1:
        return generator.bytes(int(generator.integers(0, 400)))
    for _ in range(int(generator.integers(1, 12))):
        place = int(generator.integers(len(data) + 1))
        choice = generator.integers(6)
        if choice == 0 and place < len(data):
            data[place] ^= 1 << int(generator.integers(8))
        elif choice == 1:
            data[place : place + int(generator.integers(1, 40))] = b""
        elif choice == 2:
            token = TOKENS[generator.integers(len(TOKENS))]
            data[place : place + int(generator.integers(0, len(token) + 1))] = token
        elif choice == 3:
            data[place:place] = data[place : place + int(generator.integers(1, 200))]
        elif choice == 4:
            other = files[generator.integers(len(files))]
            start = int(generator.integers(len(other)))
            data[place:place] = other[start : start + int(generator.integers(1, 200))]
        else:
            numbers = list(re.finditer(rb"\d+(\.\d+)?", bytes(data)))
            if numbers:
                match = numbers[generator.integers(len(numbers))]
                data[match.start() : match.end()] = TOKENS[generator.integers(9)]
    return bytes(data)


def judge(path):
    """Read one file; give `refused` or `surface`, or what is wrong."""
    import warnings

    from numerics.shapes import is_one_sentence

    from visuohaptic.errors import MeshError
    from visuohaptic.meshes.model_files import read_model
    from visuohaptic.meshes.preparing import normalise

    warnings.simplefilter("ignore")
    try:
        surface = normalise(read_model(path), path.name)
    except MeshError as error:
        text = str(error)
        if not is_one_sentence(text):
            return f"unclear refusal: {text[:200]!r}"
        return "refused" if path.name in text else f"refusal names no file: {text[:200]!r}"
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
    return "surface" if whole else "a surface that is not finite, not of unit size, or not whole"


def worker(folder):
    """Serve inputs until there are no more."""
    import resource

    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    for line in sys.stdin:
        suffix, number = line.split()
        path = Path(folder) / f"input.{suffix}"
        path.write_bytes(make_input(suffix, int(number)))
        sys.stdout.write(json.dumps([suffix, int(number), judge(path)]) + "\n")
        sys.stdout.flush()


class _Reader:
    """A process that reads models, and is replaced when it crashes or hangs."""

    def __init__(self, folder):
        self.folder = folder
        self.start()

    def start(self):
        tests = Path(__file__).parents[1]
        environment = dict(os.environ)
        environment["PYTHONPATH"] = os.pathsep.join([str(tests), PYTHONPATH])
        self.process = subprocess.Popen(
            [sys.executable, "-m", "numerics.fuzzing", "worker", str(self.folder)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, env=environment,
        )  # fmt: skip
        self.fresh = True

    def ask(self, suffix, number):
        self.process.stdin.write(f"{suffix} {number}\n".encode())
        self.process.stdin.flush()
        limit = SECONDS_AN_INPUT + (40 if self.fresh else 0)  # the first one imports
        self.fresh = False
        ready, _, _ = select.select([self.process.stdout], [], [], limit)
        line = self.process.stdout.readline() if ready else b""
        if line:
            return json.loads(line)[2]
        found = f"crash, exit code {self.process.wait()}" if ready else f"hang of {limit:g} s"
        self.stop()
        self.start()
        return found

    def stop(self):
        self.process.kill()
        self.process.wait()
        self.process.stdin.close()
        self.process.stdout.close()


def fuzz(folder, numbers, suffixes=SUFFIXES):
    """Read inputs; give (suffix, number, finding, seconds) of each."""
    reader = _Reader(folder)
    results = []
    try:
        for suffix in suffixes:
            for number in numbers:
                started = time.perf_counter()
                finding = reader.ask(suffix, number)
                results.append((suffix, number, finding, time.perf_counter() - started))
    finally:
        reader.stop()
    return results


if __name__ == "__main__":
    worker(sys.argv[2])
