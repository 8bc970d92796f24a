"""PLY files, checked to be whole and their polygons cut, for trimesh's reader."""

from __future__ import annotations

import io
import re
import tempfile
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visuohaptic.errors import MeshError
from visuohaptic.geometry.ply_header import LONGEST, read_ply_header
from visuohaptic.meshes.polygons import check_corners, cuts, fan

_CORNERS = ("vertex_indices", "vertex_index")
_TEXTURE = "texcoord"  # of a face: u and v of each corner
_ELEMENT = re.compile(rb"^element\s+(\w+)\s+(\d+)", re.MULTILINE)
_FACE_LISTS = re.compile(rb"^element\s+face\b.*\n((?:(?!element)[^\n]*\n)*)", re.MULTILINE)
_LIST = re.compile(rb"^property\s+list\s+\w+\s+\w+\s+(\w+)", re.MULTILINE)


def checked_ply(data: bytes) -> bytes:
    """Give the file, or one whose polygons are triangles where trimesh would cut them wrongly.

    Raises `MeshError` with the reason alone, if it holds less than its header promises or a face
    names no vertex; ``plyfile.PlyParseError`` if it can't be read.
    """
    from plyfile import PlyData, PlyElement, PlyElementParseError

    length = read_ply_header(data[:LONGEST]).length
    lists = _face_lists(data[:length])
    if not lists or _holds_triangles(data, length, lists):
        return data
    try:
        ply = PlyData.read(io.BytesIO(data))
    except PlyElementParseError as error:
        if error.row is None or "early end" not in error.message:
            raise
        raise MeshError(
            f"it is truncated: its header promises {error.element.count} rows of "
            f"{error.element.name!r}, and {error.row} are there whole"
        ) from error
    name = next((name for name in _CORNERS if name in lists), None)
    if name is None or "vertex" not in ply:
        return data
    face = ply["face"].data
    counts = np.array([len(one) for one in face[name]], dtype=np.int64)
    corners = np.concatenate([np.empty(0, np.int64), *face[name]]).astype(np.int64)
    points = np.column_stack([ply["vertex"][axis] for axis in "xyz"]).astype(np.float64)
    check_corners(corners, len(points))
    cut = cuts(points, corners, counts)
    # trimesh reads a binary file only where all its lists have one length.
    if not cut and (ply.text or len(np.unique(counts)) == 1):
        return data
    rows = [(place, cut.get(place, fan(count))) for place, count in enumerate(counts.tolist())]
    places = np.repeat([place for place, _ in rows], [len(triangles) for _, triangles in rows])
    triangles = np.concatenate([triangles for _, triangles in rows])
    ply.elements = [
        PlyElement.describe(_triangle_rows(face, name, places, triangles), "face")
        if element.name == "face"
        else element
        for element in ply.elements
    ]
    ply.text, ply.byte_order = False, "<"
    written = io.BytesIO()
    ply.write(written)
    return written.getvalue()


def _face_lists(header: bytes) -> list[str]:
    face = _FACE_LISTS.search(header)
    return [name.decode() for name in _LIST.findall(face[1])] if face else []


def _holds_triangles(data: bytes, length: int, lists: list[str]) -> bool:
    """Tell quickly whether the file is whole, and each face surely a triangle."""
    from plyfile import PlyData, PlyParseError

    if read_ply_header(data[:LONGEST]).ascii:
        return _text_holds_triangles(data, length)
    known = {name: 6 if name == _TEXTURE else 3 for name in lists}
    # What lies in a file is read as one array, and other lengths are refused.
    with tempfile.TemporaryFile() as file:
        file.write(data)
        file.seek(0)
        try:
            PlyData.read(file, known_list_len={"face": known})
        except (PlyParseError, ValueError):
            return False
    return True


def _text_holds_triangles(data: bytes, length: int) -> bool:
    header = data[:length]
    elements = [(name, int(count)) for name, count in _ELEMENT.findall(header)]
    names = [name for name, _ in elements]
    face = _FACE_LISTS.search(header)
    if names[:2] != [b"vertex", b"face"] or face is None or not _LIST.match(face[1]):
        return False
    vertices, faces = elements[0][1], elements[1][1]
    rows = data[length:].split(b"\n")[vertices : vertices + faces]
    words = [row.split(None, 4) for row in rows]
    return len(rows) == faces and all(len(row) >= 4 and row[0] == b"3" for row in words)


def _triangle_rows(
    face: NDArray[Any], name: str, places: NDArray[np.int64], triangles: NDArray[np.int64]
) -> NDArray[Any]:
    """Give a row of the faces' table for each triangle: its polygon's row but for what its corners have."""
    names = face.dtype.names or ()
    rows = np.empty(len(places), dtype=[_column(face, one) for one in names])
    for one in names:
        if one == name:
            rows[one] = _picked(face[one], places, triangles)
        elif one == _TEXTURE:
            uv = [np.reshape(values, (-1, 2)) for values in face[one]]
            rows[one] = _picked(uv, places, triangles).reshape(-1, 6)
        else:
            rows[one] = face[one][places]
    return rows


def _column(face: NDArray[Any], name: str) -> tuple[Any, ...]:
    if name in _CORNERS:
        return name, "<i4", (3,)
    if name == _TEXTURE:
        return name, "<f4", (6,)
    return name, face.dtype[name]


def _picked(values: Any, places: NDArray[np.int64], triangles: NDArray[np.int64]) -> NDArray[Any]:
    return np.array([values[place][row] for place, row in zip(places, triangles, strict=True)])
