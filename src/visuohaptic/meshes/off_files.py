"""OFF files, checked against their header and their concave polygons cut."""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from visuohaptic.base.errors import MeshError
from visuohaptic.meshes.limits import check_lines
from visuohaptic.meshes.polygons import check_corners, cuts, fan

_FIRST_LINE = re.compile(rb"(?:ST)?C?N?OFF\b(.*)", re.IGNORECASE)


def read_off(data: bytes) -> Any:
    """Give the ``trimesh.Trimesh`` of a file, polygons cut into triangles, without colours.

    Raises `MeshError` with the reason alone, if rows are other than the header promises or a face
    names no vertex; `ValueError` where a number is none.
    """
    import trimesh

    check_lines(data)
    lines = [line for raw in data.splitlines() if (line := raw.partition(b"#")[0].strip())]
    vertices, faces, rows = _promised(lines)
    if len(rows) != vertices + faces:
        what = "it is truncated" if len(rows) < vertices + faces else "it holds too much"
        raise MeshError(
            f"{what}: its header promises {vertices} vertices and {faces} faces, one a line, and "
            f"{len(rows)} lines follow"
        )
    points = np.array([[*map(float, row.split()[:3])] for row in rows[:vertices]])
    polygons = [_corners_of(row, place) for place, row in enumerate(rows[vertices:])]
    counts = np.array([len(polygon) for polygon in polygons], dtype=np.int64)
    corners = np.concatenate([np.empty(0, np.int64), *polygons])
    check_corners(corners, vertices)
    cut = {place: fan(len(polygons[place])) for place in np.flatnonzero(counts > 4).tolist()}
    cut |= cuts(points, corners, counts)
    pieces = [
        polygon[triangle]
        for place, polygon in enumerate(polygons)
        for triangle in cut.get(place, [slice(None)])
    ]
    triangles = trimesh.geometry.triangulate_quads(pieces)
    return trimesh.Trimesh(points, triangles, process=False)


def _promised(lines: list[bytes]) -> tuple[int, int, list[bytes]]:
    """Give the counts of vertices and faces, and the lines below them."""
    first = _FIRST_LINE.fullmatch(lines[0]) if lines else None
    if first is None:
        raise MeshError("its first line is not OFF, COFF or NOFF")
    start = 1 if first[1].strip() else 2
    counts = (first[1] if start == 1 else b" ".join(lines[1:2])).split()
    if len(counts) not in {2, 3} or not all(count.isdigit() for count in counts):
        raise MeshError("its header does not promise a number of vertices and one of faces")
    return int(counts[0]), int(counts[1]), lines[start:]


def _corners_of(row: bytes, place: int) -> Any:
    count, *numbers = row.split()
    if not count.isdigit() or int(count) > len(numbers):
        raise MeshError(
            f"face {place} promises {count[:20].decode('latin-1')} corners, and {len(numbers)} "
            "numbers follow"
        )
    return np.array([int(number) for number in numbers[: int(count)]], dtype=np.int64)
