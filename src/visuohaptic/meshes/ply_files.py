"""PLY files, checked to be whole and their polygons cut, for trimesh's reader."""

from __future__ import annotations

import io
import tempfile
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray
from plyfile import PlyData, PlyElement, PlyElementParseError, PlyListProperty

from visuohaptic.base.arrays import IntArray
from visuohaptic.base.errors import MeshError
from visuohaptic.geometry.ply_header import LONGEST, check_ply_size, read_ply_header
from visuohaptic.meshes.limits import check_lines
from visuohaptic.meshes.polygons import check_corners, cuts, fan

_CORNERS = ("vertex_indices", "vertex_index")
_TEXTURE = "texcoord"  # of a face: u and v of each corner
_MOST_BLANK_LINES = 100_000


def checked_ply(data: bytes) -> bytes:
    """Give the file, or one whose polygons are triangles where trimesh would cut them wrongly.

    Raises `MeshError` with the reason alone, if it holds less than its header promises or a face
    names no vertex; `ValueError` or ``plyfile.PlyParseError`` if it can't be read.
    """
    header = read_ply_header(data[:LONGEST])
    check_ply_size(header, len(data))
    if header.ascii:
        check_lines(data)
        lines = data.count(b"\n", header.length)
        if lines > header.rows + _MOST_BLANK_LINES:
            raise MeshError(f"its header claims {header.rows} rows, and {lines} lines follow")
    ply = _read(data, text=header.ascii)
    if "vertex" not in ply or "face" not in ply:
        return data
    lists = [one.name for one in ply["face"].properties if isinstance(one, PlyListProperty)]
    name = next((one for one in lists if len(lists) == 1 or one in _CORNERS), None)
    if name is None:
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
    triangles = [cut.get(place, fan(count)) for place, count in enumerate(counts.tolist())]
    ply.elements = [
        PlyElement.describe(_triangle_rows(face, name, triangles), "face")
        if element.name == "face"
        else element
        for element in ply.elements
    ]
    ply.text, ply.byte_order = False, "<"
    written = io.BytesIO()
    ply.write(written)
    return written.getvalue()


def _read(data: bytes, *, text: bool) -> Any:
    if not text:
        known = dict.fromkeys(_CORNERS, 3) | {_TEXTURE: 6}
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


def _triangle_rows(face: NDArray[Any], name: str, triangles: list[IntArray]) -> NDArray[Any]:
    """Give a row of the faces' table for each triangle: its polygon's row but for what its corners have."""
    places = np.repeat(np.arange(len(face)), [len(one) for one in triangles])
    picked = list(zip(places.tolist(), np.concatenate(triangles), strict=True))
    columns: dict[str, NDArray[Any]] = {}
    for one in face.dtype.names or ():
        values = face[one]
        if one == name:
            columns[one] = np.array([values[place][corners] for place, corners in picked])
        elif one == _TEXTURE:
            uv = [np.reshape(row, (-1, 2)) for row in values]
            columns[one] = np.array([uv[place][corners].ravel() for place, corners in picked])
        else:
            columns[one] = values[places]
    rows = np.empty(
        len(places), [(one, values.dtype, values.shape[1:]) for one, values in columns.items()]
    )
    for one, values in columns.items():
        rows[one] = values
    return rows
