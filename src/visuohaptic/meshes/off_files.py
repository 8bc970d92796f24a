"""OFF files, checked against their header and their concave polygons cut, for trimesh's reader."""

from __future__ import annotations

import re

import numpy as np

from visuohaptic.errors import MeshError
from visuohaptic.meshes.polygons import check_corners, cuts, fan

_FIRST_LINE = re.compile(rb"(?:ST)?C?N?OFF\b(.*)", re.IGNORECASE)


def checked_off(data: bytes) -> bytes:
    """Give the file, or an equal one whose concave polygons are triangles.

    Raises `MeshError` with the reason alone, if rows are other than the header promises or a face
    names no vertex; `ValueError` where a number is none.
    """
    lines = [line for raw in data.splitlines() if (line := raw.partition(b"#")[0].strip())]
    vertices, faces, rows = _promised(lines)
    if len(rows) != vertices + faces:
        what = "it is truncated" if len(rows) < vertices + faces else "it holds too much"
        raise MeshError(
            f"{what}: its header promises {vertices} vertices and {faces} faces, one a line, and "
            f"{len(rows)} lines follow"
        )
    polygons = [_corners_of(row, place) for place, row in enumerate(rows[vertices:])]
    counts = np.array([len(polygon) for polygon in polygons], dtype=np.int64)
    corners = np.array([corner for polygon in polygons for corner in polygon], dtype=np.int64)
    check_corners(corners, vertices)
    if counts.max(initial=0) <= 3:
        return data
    points = np.array([[*map(float, row.split()[:3])] for row in rows[:vertices]])
    cut = cuts(points, corners, counts)
    # trimesh's reader stops at a polygon of more than four corners.
    if not cut and counts.max() == 4:
        return data
    cut = {place: fan(len(polygons[place])) for place in map(int, np.flatnonzero(counts > 4))} | cut
    written = [
        b"%d %s" % (len(triangle), b" ".join(b"%d" % polygon[corner] for corner in triangle))
        for place, polygon in enumerate(polygons)
        for triangle in cut.get(place, [range(len(polygon))])
    ]
    head = b"OFF\n%d %d 0" % (vertices, len(written))
    return b"\n".join([head, *rows[:vertices], *written, b""])


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


def _corners_of(row: bytes, place: int) -> list[int]:
    count, *numbers = row.split()
    if not count.isdigit() or int(count) > len(numbers):
        raise MeshError(
            f"face {place} promises {count[:20].decode('latin-1')} corners, and {len(numbers)} "
            "numbers follow"
        )
    return [int(number) for number in numbers[: int(count)]]
