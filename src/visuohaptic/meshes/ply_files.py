"""PLY files, checked to be whole and their polygons cut, for trimesh's reader."""

from __future__ import annotations

import io
import re
import tempfile
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visuohaptic.errors import MeshError
from visuohaptic.geometry.arrays import Integers
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
    from plyfile import PlyElement

    header = read_ply_header(data[:LONGEST])
    lists = _face_lists(data[: header.length])
    name = next((one for one in lists if len(lists) == 1 or one in _CORNERS), None)
    if name is None or (header.ascii and _text_holds_triangles(data, header.length)):
        return data
    ply = _read(data, lists, text=header.ascii)
    if "vertex" not in ply:
        return data
    face = ply["face"].data
    counts, corners = _polygons(face[name])
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


def _read(data: bytes, lists: list[str], *, text: bool) -> Any:
    from plyfile import PlyData, PlyElementParseError

    for count in () if text else (3, 4):
        known = {name: 2 * count if name == _TEXTURE else count for name in lists}
        with suppress(PlyElementParseError), tempfile.TemporaryFile() as file:
            # What lies in a file is read as one array, and lists of other lengths are refused.
            file.write(data)
            file.seek(0)
            return PlyData.read(file, known_list_len={"face": known})
    try:
        return PlyData.read(io.BytesIO(data))
    except PlyElementParseError as error:
        if error.row is None or "early end" not in error.message:
            raise
        raise MeshError(
            f"it is truncated: its header promises {error.element.count} rows of "
            f"{error.element.name!r}, and {error.row} are there whole"
        ) from error


def _polygons(lists: NDArray[Any]) -> tuple[Integers, Integers]:
    """Give how many corners each polygon has, and the corners of all."""
    if lists.ndim == 2:
        return np.full(len(lists), lists.shape[1], np.int64), lists.astype(np.int64).ravel()
    counts = np.array([len(one) for one in lists], dtype=np.int64)
    return counts, np.concatenate([np.empty(0, np.int64), *lists]).astype(np.int64)


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
    face: NDArray[Any], name: str, places: Integers, triangles: Integers
) -> NDArray[Any]:
    """Give a row of the faces' table for each triangle: its polygon's row but for what its corners have."""
    names = face.dtype.names or ()
    rows = np.empty(len(places), dtype=[_column(face, one, name) for one in names])
    for one in names:
        if one == name:
            rows[one] = _picked(face[one], places, triangles)
        elif one == _TEXTURE:
            uv = [np.reshape(values, (-1, 2)) for values in face[one]]
            rows[one] = _picked(uv, places, triangles).reshape(-1, 6)
        else:
            rows[one] = face[one][places]
    return rows


def _column(face: NDArray[Any], column: str, corners: str) -> tuple[Any, ...]:
    if column == corners:
        return column, "<i4", (3,)
    if column == _TEXTURE:
        return column, "<f4", (6,)
    return column, face.dtype[column]


def _picked(values: Any, places: Integers, triangles: Integers) -> NDArray[Any]:
    return np.array([values[place][row] for place, row in zip(places, triangles, strict=True)])
