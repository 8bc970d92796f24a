"""Compare the meshes of folders as this package and other libraries read them: `compare_folder.py FOLDER…`.

The other libraries are those of `REFERENCES` that are installed. The table has a row per folder. A line per file
follows where a library and this package differ, or where only one side reads the file. Nothing is downloaded.
"""

from __future__ import annotations

import multiprocessing
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from importlib import import_module
from multiprocessing.pool import Pool
from pathlib import Path

import numpy as np

import meshreaders

SAME, DIFFERS, HERE, THERE, NOWHERE = (
    "same as a library", "differs from all", "read here only", "refused here only", "refused by all",
)  # fmt: skip
VERDICTS = (SAME, DIFFERS, HERE, THERE, NOWHERE)
TOLERANCE = 1e-3  # of the size of a mesh: text formats have few digits
SECONDS = 60  # for one file by one library


def sizes(triangles: np.ndarray) -> np.ndarray:
    """Return the root of the area, the lower and upper corner of the box, and the cube root of the volume: (8,)."""
    points = triangles.reshape(-1, 3)
    box = np.array([points.min(axis=0), points.max(axis=0)])
    crosses = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    area = 0.5 * np.linalg.norm(crosses, axis=1).sum()
    # From the middle, so that an open mesh far from the origin has a small volume.
    volume = abs(np.linalg.det(triangles - box.mean(axis=0)).sum()) / 6
    return np.array([np.sqrt(area), *box.ravel(), np.cbrt(volume)])


def by_trimesh(path: Path) -> np.ndarray:
    """Return the triangles (f, 3, 3) that trimesh reads."""
    trimesh = import_module("trimesh")
    shapes = trimesh.load_scene(path, process=False).dump()
    return np.concatenate([shape.triangles for shape in shapes if hasattr(shape, "triangles")])


def by_assimp(path: Path) -> np.ndarray:
    """Return the triangles (f, 3, 3) that Assimp reads, in the coordinates of the scene."""
    assimp = import_module("assimp_py")
    steps = assimp.Process_Triangulate | assimp.Process_PreTransformVertices
    scene = assimp.import_file(str(path), steps)
    # The arrays of a scene are freed with the scene, so they are copied.
    parts = [
        np.array(mesh.vertices, float).reshape(-1, 3)[np.array(mesh.indices, int).reshape(-1, 3)]
        for mesh in scene.meshes
        if mesh.num_indices == 3 * mesh.num_faces
    ]
    return np.concatenate(parts)


def by_open3d(path: Path) -> np.ndarray:
    """Return the triangles (f, 3, 3) that Open3D reads."""
    io = import_module("open3d").io
    parts = [one.mesh for one in io.read_triangle_model(str(path)).meshes]
    return np.concatenate([np.asarray(mesh.vertices)[np.asarray(mesh.triangles)] for mesh in parts])


REFERENCES: Mapping[str, Callable[[Path], np.ndarray]] = {
    "trimesh": by_trimesh,
    "assimp_py": by_assimp,
    "open3d": by_open3d,
}


def is_installed(name: str) -> bool:
    """Return whether a library can be imported."""
    try:
        import_module(name)
    except ImportError:
        return False
    return True


def sizes_by(name: str, path: Path) -> np.ndarray:
    """Return the sizes of a mesh as a library reads the file."""
    return sizes(REFERENCES[name](path))


def read_by(name: str, path: Path, pools: dict[str, Pool]) -> np.ndarray | str:
    """Return the sizes of a mesh, or the reason of a refusal; a library that crashes or hangs is started again."""
    if name not in pools:
        pools[name] = multiprocessing.Pool(1)
    try:
        return pools[name].apply_async(sizes_by, (name, path)).get(SECONDS)
    except multiprocessing.TimeoutError:
        pools.pop(name).terminate()
        return f"gives no answer in {SECONDS} s"
    # Libraries raise errors of any class for a file that they can't read.
    except Exception as error:  # noqa: BLE001
        return " ".join(str(error).split())[:100] or type(error).__name__


def read_here(path: Path) -> np.ndarray | str:
    """Return the sizes of a mesh as this package reads the file, or the sentence of the refusal."""
    try:
        return sizes(meshreaders.read(path).triangles)
    except meshreaders.MeshError as error:
        return str(error)


def agree(here: np.ndarray, there: np.ndarray) -> bool:
    """Return whether two meshes have the same sizes, as far as the digits of text formats tell."""
    diagonal = np.linalg.norm(here[4:7] - here[1:4])
    return np.allclose(here, there, rtol=0, atol=TOLERANCE * diagonal, equal_nan=True)


def judge(here: np.ndarray | str, others: Mapping[str, np.ndarray | str]) -> str:
    """Return the verdict on a file from the sizes, or the refusals, of this package and of each library."""
    read = [there for there in others.values() if not isinstance(there, str)]
    if isinstance(here, str):
        return THERE if read else NOWHERE
    if not read:
        return HERE
    return SAME if any(agree(here, there) for there in read) else DIFFERS


def compare(folder: Path) -> Iterator[tuple[Path, str, Mapping[str, np.ndarray | str]]]:
    """Yield each mesh below a folder with its verdict, and the sizes or the refusal by reader."""
    names = [name for name in REFERENCES if is_installed(name)]
    pools: dict[str, Pool] = {}
    for path in sorted(folder.rglob("*")):
        if path.suffix.lower() in meshreaders.MODEL_SUFFIXES and path.is_file():
            here = read_here(path)
            others = {name: read_by(name, path, pools) for name in names}
            yield path, judge(here, others), {"meshreaders": here, **others}
    for pool in pools.values():
        pool.terminate()


def in_words(found: np.ndarray | str) -> str:
    """Return a refusal, or the area, box and volume."""
    if isinstance(found, str):
        return found
    area, *box, volume = found
    return f"area {area**2:.6g}, box {np.round(box, 4).tolist()}, volume {volume**3:.6g}"


def main(*folders: str) -> None:
    """Print a table of folders by verdict, and the files on which the readers differ."""
    print(f"| folder | files | {' | '.join(VERDICTS)} |\n|---|{'---|' * (len(VERDICTS) + 1)}")
    lines = []
    for folder in map(Path, folders):
        counts: Counter[str] = Counter()
        for path, verdict, found in compare(folder):
            counts[verdict] += 1
            if verdict not in {SAME, NOWHERE}:
                lines.append(f"{verdict}: {folder.name}/{path.relative_to(folder)}")
                lines += [f"  {name}: {in_words(sizes)}" for name, sizes in found.items()]
        cells = " | ".join(str(counts[verdict]) for verdict in VERDICTS)
        print(f"| {folder.resolve().name} | {counts.total()} | {cells} |", flush=True)
    print("", *lines, sep="\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
