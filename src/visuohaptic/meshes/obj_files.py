"""OBJ files, their indices checked and made plain and their concave polygons cut, for trimesh's reader."""

from __future__ import annotations

import re

import numpy as np

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import MeshError
from visuohaptic.meshes.limits import check_lines, check_parts
from visuohaptic.meshes.polygons import check_corners, cuts

# A comment after a face would be a corner to trimesh.
_FACE = re.compile(rb"^f(?:[ \t]+([^\n#]*))?(?:#[^\n]*)?$", re.MULTILINE)
_VERTEX = re.compile(rb"^v ([^\n#]*)", re.MULTILINE)
_MATERIAL = re.compile(rb"^usemtl[ \t]+(.*?)[ \t\r]*$", re.MULTILINE)
_KINDS = (rb"^v ", rb"^vt ", rb"^vn ")  # in the order in which a corner names them
_AFTER_BLANKS = re.compile(rb"^[ \t]*(v|vt|vn|f)[ \t]+", re.MULTILINE)


def checked_obj(data: bytes) -> bytes:
    """Give a file of the same surface that trimesh reads as it is meant.

    Concave polygons become triangles, indices that count backwards become plain ones, and faces of
    fewer than three corners go, which have no area.

    Raises `MeshError` with the reason alone, if a face names no vertex (vertices are counted from 1);
    `ValueError` where a number is none.
    """
    check_lines(data)
    check_parts(len(set(_MATERIAL.findall(data))), "materials")
    data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n").replace(b"\\\n", b" ")
    data = _AFTER_BLANKS.sub(rb"\1 ", data)
    faces = list(_FACE.finditer(data))
    rows = [(face[1] or b"").split() for face in faces]
    if any(token.startswith(b"-") or b"/-" in token for row in rows for token in row):
        rows = _counted_from_the_first(data, [face.start() for face in faces], rows)
    words = [token.partition(b"/")[0] for row in rows for token in row]
    corners = np.fromiter(map(int, words), np.int64, len(words))
    check_corners(corners, len(_VERTEX.findall(data)), first=1)
    counts = np.array([len(row) for row in rows], dtype=np.int64)
    cut = cuts(_points(data), corners - 1, counts) if counts.max(initial=0) > 3 else {}
    pieces, end = [], 0
    for place, (face, row) in enumerate(zip(faces, rows, strict=True)):
        whole = [range(len(row))] if len(row) >= 3 else []
        lines = [b" ".join([b"f", *(row[k] for k in piece)]) for piece in cut.get(place, whole)]
        pieces += [data[end : face.start()], b"\n".join(lines)]
        end = face.end()
    return b"".join([*pieces, data[end:]])


def _counted_from_the_first(
    data: bytes, starts: list[int], rows: list[list[bytes]]
) -> list[list[bytes]]:
    """Make plain the negative indices of faces, which count from where their face starts."""
    above = np.column_stack(
        [
            np.searchsorted([one.start() for one in re.finditer(kind, data, re.MULTILINE)], starts)
            for kind in _KINDS
        ]
    )
    return [
        [_plain(token, counts) for token in row]
        for row, counts in zip(rows, above.tolist(), strict=True)
    ]


def _plain(token: bytes, counts: list[int]) -> bytes:
    return b"/".join(
        b"%d" % (count + 1 + int(number)) if number.startswith(b"-") else number
        for number, count in zip(token.split(b"/"), counts, strict=False)
    )


def _points(data: bytes) -> FloatArray:
    rows = [vertex.split()[:3] for vertex in _VERTEX.findall(data)]
    short = next((row for row in rows if len(row) < 3), None)
    if short is not None:
        raise MeshError(f"a vertex has {len(short)} coordinates; 3 are needed")
    numbers = (float(word) for row in rows for word in row)
    return np.fromiter(numbers, np.float64, 3 * len(rows)).reshape(-1, 3)
