"""PLY files: polygons, strips, colours, and images by faces or vertices."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import MeshError
from visuohaptic.geometry.ply_header import LONGEST, check_ply_size, read_ply_header
from visuohaptic.meshes.colours import as_bytes, mean_of_corners
from visuohaptic.meshes.companions import Companions
from visuohaptic.meshes.limits import check_lines, check_parts
from visuohaptic.meshes.parts import GREY, Paint, Part
from visuohaptic.meshes.ply_columns import Lists, Table
from visuohaptic.meshes.ply_tables import decoded, read_tables
from visuohaptic.meshes.polygons import check_corners, named_triangles, triangulate
from visuohaptic.meshes.text_numbers import plain_lines

_CORNERS = ("vertex_indices", "vertex_index")
_PLACES = "texcoord"  # of a face: u and v of each corner
_PLACES_OF_VERTICES = (("texture_u", "texture_v"), ("u", "v"), ("s", "t"))
_COLOURS = (
    ("red", "green", "blue"),
    ("diffuse_red", "diffuse_green", "diffuse_blue"),
    ("r", "g", "b"),
)
_STRIPS = "tristrips"
_NAMES_OF_COLOURS = tuple(chain(*_COLOURS))
_COLUMNS = {
    "vertex": ("x", "y", "z", *chain(*_PLACES_OF_VERTICES), *_NAMES_OF_COLOURS),
    "face": ("texnumber", "material_index", *_NAMES_OF_COLOURS),
    "material": _NAMES_OF_COLOURS,
    _STRIPS: (),
}
_IMAGE = re.compile(r"comment\s+TextureFile\s+(.*\S)", re.IGNORECASE)
_MOST_BLANK_LINES = 100_000


def read_ply(data: bytes, companions: Companions) -> list[Part]:
    """Read a PLY file: one part, or one per image that its header names.

    Raises `MeshError`, with the reason only, if it holds less than its header promises or a face
    names no vertex; `ValueError` or ``plyfile.PlyParseError`` if it can't be read.
    """
    header = read_ply_header(data[:LONGEST])
    if header.ascii and b"\r" in data:
        data = plain_lines(data)
        header = read_ply_header(data[:LONGEST])
    check_ply_size(header, len(data))
    if header.ascii:
        check_lines(data)
        lines = data.count(b"\n", header.length)
        if lines > header.rows + _MOST_BLANK_LINES:
            raise MeshError(f"its header claims {header.rows} rows, and {lines} lines follow")
    images = _Images(data[: header.length], companions)
    tables = read_tables(data, header, _COLUMNS)
    # The surface takes the memory of the file.
    del data
    if "vertex" not in tables:
        return []
    columns = tables["vertex"].columns
    if not set("xyz") <= set(columns):
        raise MeshError("its vertices have no numbers x, y and z")
    points = np.stack([columns.pop(name) for name in "xyz"], axis=1)
    return [*_faces(tables, points, images), *_strips(tables, points, images)]


class _Images:
    """The images that a header names, which are opened once coordinates on them are there."""

    def __init__(self, header: bytes, companions: Companions) -> None:
        lines = decoded(header).splitlines()
        self.names = [found[1] for line in lines if (found := _IMAGE.fullmatch(line.strip()))]
        self._companions = companions
        check_parts(len(self.names), "images")

    def paints(
        self,
        places: FloatArray | None,
        numbers: NDArray[np.integer],
        pieces: NDArray[np.int32],
    ) -> Iterator[tuple[NDArray[np.bool_] | slice, Paint | None]]:
        """Return the triangles of each image, and the image on them.

        `numbers` (p,) are the image's number per polygon, `pieces` (p,) the number of its triangles.
        """
        if not self.names:
            yield slice(None), None
            return
        if places is None:
            self._companions.notes.append("names an image and has no coordinates on it")
            yield slice(None), None
            return
        opened = [self._companions.image(name) for name in self.names]
        of_triangles = np.repeat(numbers, pieces)
        for number in np.unique(of_triangles):
            shown = of_triangles == number
            image = opened[number] if 0 <= number < len(opened) else None
            yield shown, None if image is None else Paint(image, places[shown])


def _faces(tables: dict[str, Table], points: NDArray[Any], images: _Images) -> Iterator[Part]:
    face = tables.get("face")
    name = None if face is None else _name_of_corners(face)
    if face is None or name is None:
        return
    # The numbers of corners are not needed beside the triangles.
    polygons = face.lists.pop(name)
    corners = _whole(polygons.values)
    check_corners(corners, len(points))
    numbers: NDArray[np.integer] = np.broadcast_to(np.int32(0), face.rows)
    if "texnumber" in face.columns:
        numbers = np.nan_to_num(face.columns["texnumber"], nan=-1).astype(np.int64)
    places: FloatArray | None
    if _PLACES in face.lists:
        triangles, pieces = triangulate(points, corners, polygons.counts)
        whole = face.lists[_PLACES].counts == 2 * polygons.counts
        numbers = np.where(whole, numbers, -1)
        places = _places_of_faces(face.lists[_PLACES], polygons.counts, whole, triangles, pieces)
        named = corners[triangles].astype(np.int64, copy=False)
    else:
        named, pieces = named_triangles(points, corners, polygons.counts)
        places = _places(tables["vertex"], named)
    del polygons, corners
    colours = _face_colours(tables, pieces, named)
    for shown, paint in images.paints(places, numbers, pieces):
        yield Part(points, named[shown], None if colours is None else colours[shown], paint)


def _places_of_faces(
    places: Lists,
    counts: NDArray[np.int32],
    whole: NDArray[np.bool_],
    triangles: IntArray,
    pieces: NDArray[np.int32],
) -> FloatArray:
    """Return coordinates (t, 3, 2) of corners; any numbers where a polygon is not `whole`."""
    owners = np.repeat(np.arange(len(counts)), pieces)
    firsts = np.cumsum(places.counts, dtype=np.int64) - places.counts
    first = np.where(whole, firsts, 0)[owners]
    within = triangles - (np.cumsum(counts, dtype=np.int64) - counts)[owners, None]
    across = np.where(whole[owners, None], first[:, None] + 2 * within, 0)
    values = np.append(places.values, [0.0, 0.0])
    return np.stack([values[across], values[across + 1]], axis=-1)


def _strips(tables: dict[str, Table], points: NDArray[Any], images: _Images) -> Iterator[Part]:
    """Return the triangles of strips: lists of vertices, parted by -1, that every three in a row span."""
    if _STRIPS not in tables:
        return
    name = _name_of_corners(tables[_STRIPS])
    if name is None:
        return
    strips, vertex = tables[_STRIPS].lists[name], tables["vertex"]
    # A strip ends with its row, too.
    rows = np.insert(_whole(strips.values).astype(np.int64), np.cumsum(strips.counts), -1)
    three = np.lib.stride_tricks.sliding_window_view(rows, 3) if len(rows) > 2 else rows[:0]
    three = three.reshape(-1, 3)
    starts = np.maximum.accumulate(np.where(rows == -1, np.arange(len(rows)) + 1, 0))
    starts = np.concatenate([[0], starts])[: len(three)]
    odd = (np.arange(len(three)) - starts) % 2 == 1
    triangles = np.where(odd[:, None], three[:, [1, 0, 2]], three)
    # A vertex that is named twice turns a strip around a corner.
    kept = (triangles >= 0).all(axis=1) & (np.diff(np.sort(triangles, axis=1), axis=1) > 0).all(
        axis=1
    )
    named = triangles[kept]
    check_corners(rows[rows != -1], len(points))
    colours = mean_of_corners(_colours(vertex), named)
    of_first = np.zeros(len(named), dtype=np.int32)
    for shown, paint in images.paints(_places(vertex, named), of_first, of_first + 1):
        yield Part(points, named[shown], None if colours is None else colours[shown], paint)


def _name_of_corners(element: Table) -> str | None:
    lists = list(element.lists)
    return next((one for one in lists if len(lists) == 1 or one in _CORNERS), None)


def _whole(corners: NDArray[Any]) -> NDArray[np.integer]:
    if corners.dtype.kind != "f":
        return corners
    wrong = corners[~(np.abs(corners) < 2**53) | (np.floor(corners) != corners)]
    if len(wrong):
        raise MeshError(f"a face names vertex {wrong[0]:g}; whole numbers are needed")
    return corners.astype(np.int64)


def _places(vertex: Table, named: IntArray) -> FloatArray | None:
    for names in _PLACES_OF_VERTICES:
        if set(names) <= set(vertex.columns):
            places = np.column_stack([vertex.columns[name] for name in names]).astype(np.float64)
            return places[named]
    return None


def _face_colours(
    tables: dict[str, Table], pieces: NDArray[np.int32], named: IntArray
) -> NDArray[np.uint8] | None:
    """Return the colours of triangles: of their vertices, else of their polygon, else of its material."""
    of_vertices = _colours(tables["vertex"])
    if of_vertices is not None:
        return mean_of_corners(of_vertices, named)
    face = tables["face"]
    of_faces = _colours(face)
    if of_faces is not None:
        return np.repeat(of_faces, pieces, axis=0)
    materials = _colours(tables["material"]) if "material" in tables else None
    if materials is None or "material_index" not in face.columns:
        return None
    number = np.repeat(face.columns["material_index"].astype(np.int64), pieces)
    known = (number >= 0) & (number < len(materials))
    return np.where(known[:, None], materials[np.where(known, number, 0)], np.array(GREY, np.uint8))


def _colours(element: Table) -> NDArray[np.uint8] | None:
    """Return the colours of an element's rows; None where it has none."""
    for names in _COLOURS:
        if set(names) <= set(element.columns) and element.rows:
            return as_bytes(np.column_stack([element.columns[name] for name in names]))
    return None
