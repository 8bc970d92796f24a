"""PLY files, read by plyfile's tables: polygons, strips, colours, and images by faces or vertices."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from plyfile import PlyData, PlyElement, PlyListProperty

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import MeshError
from visuohaptic.geometry.ply_header import LONGEST, check_ply_size, read_ply_header
from visuohaptic.meshes.colours import as_bytes, mean_of_corners
from visuohaptic.meshes.companions import Companions
from visuohaptic.meshes.limits import check_lines, check_parts
from visuohaptic.meshes.parts import GREY, Paint, Part
from visuohaptic.meshes.ply_tables import decoded, read_tables
from visuohaptic.meshes.polygons import check_corners, triangulate
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
    tables = read_tables(data, header)
    if "vertex" not in tables:
        return []
    vertex = tables["vertex"]
    if not set("xyz") <= set(_scalars(vertex)):
        raise MeshError("its vertices have no numbers x, y and z")
    points = np.empty((len(vertex.data), 3))
    for axis, name in enumerate("xyz"):
        points[:, axis] = vertex[name]
    images = _Images(data[: header.length], companions)
    return [*_faces(tables, points, images), *_strips(vertex, tables, points, images)]


class _Images:
    """The images that a header names, which are opened once coordinates on them are there."""

    def __init__(self, header: bytes, companions: Companions) -> None:
        lines = decoded(header).splitlines()
        self.names = [found[1] for line in lines if (found := _IMAGE.fullmatch(line.strip()))]
        self._companions = companions
        check_parts(len(self.names), "images")

    def paints(
        self, places: FloatArray | None, numbers: IntArray
    ) -> Iterator[tuple[NDArray[np.bool_] | slice, Paint | None]]:
        """Return the faces of each image, and the image on them, by the image's number (f,) of each face."""
        if not self.names:
            yield slice(None), None
            return
        if places is None:
            self._companions.notes.append("names an image and has no coordinates on it")
            yield slice(None), None
            return
        opened = [self._companions.image(name) for name in self.names]
        for number in np.unique(numbers):
            shown = numbers == number
            image = opened[number] if 0 <= number < len(opened) else None
            yield shown, None if image is None else Paint(image, places[shown])


def _faces(tables: PlyData, points: FloatArray, images: _Images) -> Iterator[Part]:
    face = next((one for one in tables.elements if one.name == "face"), None)
    name = None if face is None else _name_of_corners(face)
    if face is None or name is None:
        return
    named, owners = _named_triangles(face.data[name], points)
    numbers = np.zeros(len(face.data), dtype=np.int64)
    if "texnumber" in face.data.dtype.names:
        numbers = np.nan_to_num(face.data["texnumber"], nan=-1).astype(np.int64)
    places = _places(tables["vertex"], named)
    if _PLACES in face.data.dtype.names:
        corners, counts = _lists(face.data[name])
        corners = _whole(corners)
        triangles, owners = triangulate(points, corners, counts)
        values, lengths = _lists(face.data[_PLACES])
        whole = lengths == 2 * counts
        numbers = np.where(whole, numbers, -1)
        first = np.where(whole, np.cumsum(lengths) - lengths, 0)[owners]
        within = triangles - (np.cumsum(counts) - counts)[owners, None]
        across = np.where(whole[owners, None], first[:, None] + 2 * within, 0)
        values = np.append(values, [0.0, 0.0])
        places = np.stack([values[across], values[across + 1]], axis=-1)
    colours = _face_colours(tables, owners, named)
    for shown, paint in images.paints(places, numbers[owners]):
        yield Part(points, named[shown], None if colours is None else colours[shown], paint)


def _named_triangles(rows: NDArray[Any], points: FloatArray) -> tuple[IntArray, IntArray | slice]:
    """Return triangles (t, 3) of rows of the points, and of each one its polygon or a slice of all."""
    if rows.dtype != object and rows.shape[1] == 3:
        # A view of the file takes no memory until the file's is free.
        named = _whole(rows)
        check_corners(named, len(points))
        return named, slice(None)
    corners, counts = _lists(rows)
    corners = _whole(corners)
    check_corners(corners, len(points))
    triangles, owners = triangulate(points, corners, counts)
    return corners[triangles], owners


def _strips(
    vertex: PlyElement, tables: PlyData, points: FloatArray, images: _Images
) -> Iterator[Part]:
    """Return the triangles of strips: lists of vertices, parted by -1, that every three in a row span."""
    if _STRIPS not in tables:
        return
    name = _name_of_corners(tables[_STRIPS])
    if name is None:
        return
    rows, _ = _lists(np.array([np.append(row, -1) for row in tables[_STRIPS].data[name]], object))
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
    named = triangles[kept].astype(np.int64)
    check_corners(rows[rows != -1], len(points))
    colours = mean_of_corners(_colours(vertex), named)
    for shown, paint in images.paints(_places(vertex, named), np.zeros(len(named), np.int64)):
        yield Part(points, named[shown], None if colours is None else colours[shown], paint)


def _name_of_corners(element: PlyElement) -> str | None:
    lists = [one.name for one in element.properties if isinstance(one, PlyListProperty)]
    return next((one for one in lists if len(lists) == 1 or one in _CORNERS), None)


def _whole(corners: NDArray[Any]) -> IntArray:
    if corners.dtype.kind != "f":
        return corners
    wrong = corners[~(np.abs(corners) < 2**53) | (np.floor(corners) != corners)]
    if len(wrong):
        raise MeshError(f"a face names vertex {wrong[0]:g}; whole numbers are needed")
    return corners.astype(np.int64)


def _scalars(element: PlyElement) -> list[str]:
    return [one.name for one in element.properties if not isinstance(one, PlyListProperty)]


def _lists(rows: NDArray[Any]) -> tuple[NDArray[Any], IntArray]:
    """Return the numbers of lists, row after row, and how many each row has."""
    if rows.dtype != object:
        return rows.ravel(), np.full(len(rows), rows.shape[1], dtype=np.int64)
    counts = np.fromiter(map(len, rows), np.int64, len(rows))
    return np.concatenate([np.empty(0, np.int64), *rows]), counts


def _places(vertex: PlyElement, named: IntArray) -> FloatArray | None:
    for names in _PLACES_OF_VERTICES:
        if set(names) <= set(_scalars(vertex)):
            places = np.column_stack([vertex[name] for name in names]).astype(np.float64)
            return places[named]
    return None


def _face_colours(
    tables: PlyData, owners: IntArray | slice, named: IntArray
) -> NDArray[np.uint8] | None:
    """Return the colours of triangles: of their vertices, else of their polygon, else of its material."""
    of_vertices = _colours(tables["vertex"])
    if of_vertices is not None:
        return mean_of_corners(of_vertices, named)
    face = tables["face"]
    of_faces = _colours(face)
    if of_faces is not None:
        return of_faces[owners]
    materials = _colours(tables["material"]) if "material" in tables else None
    if materials is None or "material_index" not in face.data.dtype.names:
        return None
    number = face["material_index"].astype(np.int64)[owners]
    known = (number >= 0) & (number < len(materials))
    return np.where(known[:, None], materials[np.where(known, number, 0)], np.array(GREY, np.uint8))


def _colours(element: PlyElement) -> NDArray[np.uint8] | None:
    """Return the colours of an element's rows; None where it has none."""
    for names in _COLOURS:
        if set(names) <= set(_scalars(element)) and len(element.data):
            return as_bytes(np.column_stack([element[name] for name in names]))
    return None
