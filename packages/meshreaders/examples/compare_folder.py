"""Compare what this package and trimesh read from all meshes below a folder: `compare_folder.py FOLDER`.

The table has a row per format. A line per file follows where only one of the two reads the file, or both differ in
area, box or volume. Nothing is downloaded.
"""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path

import numpy as np
import trimesh

import meshreaders

SAME, DIFFERS, OURS, THEIRS, NEITHER = (
    "same", "differs", "read here only", "read by trimesh only", "refused by both",
)  # fmt: skip
VERDICTS = (SAME, DIFFERS, OURS, THEIRS, NEITHER)
TOLERANCE = 1e-3  # of the size of a mesh: text formats have few digits


def sizes(triangles: np.ndarray) -> np.ndarray:
    """Return the root of the area, the lower and upper corner of the box, and the cube root of the volume: (8,)."""
    points = triangles.reshape(-1, 3)
    crosses = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    area = 0.5 * np.linalg.norm(crosses, axis=1).sum()
    # From the middle, so that an open mesh far from the origin has a small volume.
    volume = abs(np.linalg.det(triangles - points.mean(axis=0)).sum()) / 6
    return np.array([np.sqrt(area), *points.min(axis=0), *points.max(axis=0), np.cbrt(volume)])


def ours(path: Path) -> np.ndarray:
    """Return the triangles (f, 3, 3) that this package reads."""
    return meshreaders.read(path).triangles


def theirs(path: Path) -> np.ndarray:
    """Return the triangles (f, 3, 3) that trimesh reads, as they are in the file."""
    shapes = trimesh.load_scene(path, process=False).dump()
    return np.concatenate([shape.triangles for shape in shapes if hasattr(shape, "triangles")])


def compare(path: Path) -> tuple[str, str]:
    """Return the verdict on a file, and the reason of a refusal or the sizes that differ."""
    measured, reasons = [], []
    for read in (ours, theirs):
        try:
            measured.append(sizes(read(path)))
        # trimesh and what it calls raise errors of any class for a file that they can't read.
        except Exception as error:  # noqa: BLE001
            reasons.append(f"{read.__name__}: {' '.join(str(error).split())[:150]}")
            measured.append(None)
    here, there = measured
    if here is None or there is None:
        verdict = NEITHER if here is there else THEIRS if here is None else OURS
        return verdict, "; ".join(reasons)
    diagonal = np.linalg.norm(here[4:7] - here[1:4])
    if np.allclose(here, there, rtol=0, atol=TOLERANCE * diagonal, equal_nan=True):
        return SAME, ""
    return DIFFERS, f"{np.round(here, 4).tolist()} here, {np.round(there, 4).tolist()} by trimesh"


def main(folder: str) -> None:
    """Print the table of a folder, and the files that are read by one only or differ."""
    paths = sorted(
        path
        for path in Path(folder).rglob("*")
        if path.suffix.lower() in meshreaders.MODEL_SUFFIXES and path.is_file()
    )
    counts: dict[str, Counter[str]] = {}
    lines = []
    for path in paths:
        verdict, reason = compare(path)
        counts.setdefault(path.suffix.lower()[1:], Counter())[verdict] += 1
        if verdict in {DIFFERS, OURS, THEIRS}:
            lines.append(f"{verdict}: {path.relative_to(folder)} ({reason})")
    print(f"| format | files | {' | '.join(VERDICTS)} |\n|---|{'---|' * (len(VERDICTS) + 1)}")
    for kind, of_kind in sorted(counts.items()):
        cells = " | ".join(str(of_kind[verdict]) for verdict in VERDICTS)
        print(f"| {kind} | {of_kind.total()} | {cells} |")
    print("", *lines, sep="\n")


if __name__ == "__main__":
    main(sys.argv[1])
