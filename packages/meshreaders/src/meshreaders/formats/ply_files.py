"""Read PLY files: polygons, triangle strips, colours, and images on faces or vertices."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshreaders.base.arrays import FloatArray, IntArray
from meshreaders.base.errors import MeshError
from meshreaders.base.ply_header import LONGEST, check_ply_size, read_ply_header
from meshreaders.colours import as_bytes, mean_of_corners
from meshreaders.companions import Companions
from meshreaders.formats.limits import check_lines, check_parts
from meshreaders.formats.ply_columns import Lists, Table
from meshreaders.formats.ply_tables import decoded, read_tables
from meshreaders.formats.text_numbers import plain_lines
from meshreaders.parts import GREY, Paint, Part
from meshreaders.polygons import check_corners, triangulate, triangulate_points

_CORNERS = ("vertex_indices", "vertex_index")
_FACE_COORDINATES = "texcoord"  # property of a face: u and v of each corner
_VERTEX_COORDINATES = (("texture_u", "texture_v"), ("u", "v"), ("s", "t"))
_COLOURS = (
    ("red", "green", "blue"),
    ("diffuse_red", "diffuse_green", "diffuse_blue"),
    ("r", "g", "b"),
)
_STRIPS = "tristrips"
_COLOUR_NAMES = tuple(chain(*_COLOURS))
_COLUMNS = {
    "vertex": ("x", "y", "z", *chain(*_VERTEX_COORDINATES), *_COLOUR_NAMES),
    "face": ("texnumber", "material_index", *_COLOUR_NAMES),
    "material": _COLOUR_NAMES,
    _STRIPS: (),
}
_IMAGE = re.compile(r"comment\s+TextureFile\s+(.*\S)", re.IGNORECASE)
_MOST_BLANK_LINES = 100_000


def read_ply(data: bytes, companions: Companions) -> list[Part]:
    """Read a PLY file as one part, or as one part per image in its header.

    Raises `MeshError` with the reason if rows are missing or a face names a missing vertex, and `ValueError` or
    ``plyfile.PlyParseError`` if the file can't be read.
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
    # Free the file: the surface needs its memory.
    del data
    if "vertex" not in tables:
        return []
    columns = tables["vertex"].columns
    if not set("xyz") <= set(columns):
        raise MeshError("its vertices have no numbers x, y and z")
    points = np.stack([columns.pop(name) for name in "xyz"], axis=1)
    return [*_faces(tables, points, images), *_strips(tables, points, images)]


class _Images:
    """The images that a header names; they are opened only if the file has image coordinates."""

    def __init__(self, header: bytes, companions: Companions) -> None:
        lines = decoded(header).splitlines()
        self.names = [match[1] for line in lines if (match := _IMAGE.fullmatch(line.strip()))]
        self._companions = companions
        check_parts(len(self.names), "images")

    def paints(
        self,
        coordinates: FloatArray | None,
        image_indices: NDArray[np.integer],
        pieces: NDArray[np.int32],
    ) -> Iterator[tuple[NDArray[np.bool_] | slice, Paint | None]]:
        """Yield the triangles of each image, and the image with its coordinates; None without image.

        `coordinates` have the shape (t, 3, 2). Polygon i has the image `image_indices[i]` and `pieces[i]` triangles.
        """
        if not self.names:
            yield slice(None), None
            return
        if coordinates is None:
            self._companions.notes.append("names an image and has no image coordinates")
            yield slice(None), None
            return
        opened = [self._companions.image(name) for name in self.names]
        of_triangles = np.repeat(image_indices, pieces)
        for index in np.unique(of_triangles):
            with_image = of_triangles == index
            image = opened[index] if 0 <= index < len(opened) else None
            yield with_image, None if image is None else Paint(image, coordinates[with_image])


def _faces(tables: dict[str, Table], points: NDArray[Any], images: _Images) -> Iterator[Part]:
    face = tables.get("face")
    name = None if face is None else _name_of_corners(face)
    if face is None or name is None:
        return
    # `pop` frees the corners of polygons, which the triangles replace.
    polygons = face.lists.pop(name)
    corners = _integers(polygons.values)
    check_corners(corners, len(points))
    image_indices: NDArray[np.integer] = np.broadcast_to(np.int32(0), face.rows)
    if "texnumber" in face.columns:
        image_indices = np.nan_to_num(face.columns["texnumber"], nan=-1).astype(np.int64)
    coordinates: FloatArray | None
    if _FACE_COORDINATES in face.lists:
        triangles, pieces = triangulate(points, corners, polygons.counts)
        complete = face.lists[_FACE_COORDINATES].counts == 2 * polygons.counts
        image_indices = np.where(complete, image_indices, -1)
        coordinates = _face_coordinates(
            face.lists[_FACE_COORDINATES], polygons.counts, complete, triangles, pieces
        )
        faces = corners[triangles].astype(np.int64, copy=False)
    else:
        faces, pieces = triangulate_points(points, corners, polygons.counts)
        coordinates = _vertex_coordinates(tables["vertex"], faces)
    del polygons, corners
    colours = _face_colours(tables, pieces, faces)
    for with_image, paint in images.paints(coordinates, image_indices, pieces):
        yield Part(
            points, faces[with_image], None if colours is None else colours[with_image], paint
        )


def _face_coordinates(
    coordinates: Lists,
    counts: NDArray[np.int32],
    complete: NDArray[np.bool_],
    triangles: IntArray,
    pieces: NDArray[np.int32],
) -> FloatArray:
    """Return image coordinates (t, 3, 2) of triangles; arbitrary numbers for polygons that are not `complete`."""
    owners = np.repeat(np.arange(len(counts)), pieces)
    firsts = np.cumsum(coordinates.counts, dtype=np.int64) - coordinates.counts
    first = np.where(complete, firsts, 0)[owners]
    within = triangles - (np.cumsum(counts, dtype=np.int64) - counts)[owners, None]
    across = np.where(complete[owners, None], first[:, None] + 2 * within, 0)
    values = np.append(coordinates.values, [0.0, 0.0])
    return np.stack([values[across], values[across + 1]], axis=-1)


def _strips(tables: dict[str, Table], points: NDArray[Any], images: _Images) -> Iterator[Part]:
    """Yield the triangles of strips: lists of vertices, separated by -1; each three successive vertices are a triangle."""
    if _STRIPS not in tables:
        return
    name = _name_of_corners(tables[_STRIPS])
    if name is None:
        return
    strips, vertex = tables[_STRIPS].lists[name], tables["vertex"]
    # The end of a row also ends a strip.
    corners = np.insert(_integers(strips.values).astype(np.int64), np.cumsum(strips.counts), -1)
    windows = (
        np.lib.stride_tricks.sliding_window_view(corners, 3) if len(corners) > 2 else corners[:0]
    )
    windows = windows.reshape(-1, 3)
    starts = np.maximum.accumulate(np.where(corners == -1, np.arange(len(corners)) + 1, 0))
    starts = np.concatenate([[0], starts])[: len(windows)]
    is_flipped = (np.arange(len(windows)) - starts) % 2 == 1
    triangles = np.where(is_flipped[:, None], windows[:, [1, 0, 2]], windows)
    # Repeated vertices only join parts of a strip; they are no triangles.
    within_strip = (triangles >= 0).all(axis=1)
    distinct = (np.diff(np.sort(triangles, axis=1), axis=1) > 0).all(axis=1)
    faces = triangles[within_strip & distinct]
    check_corners(corners[corners != -1], len(points))
    colours = mean_of_corners(_colours(vertex), faces)
    first_image = np.zeros(len(faces), dtype=np.int32)
    for with_image, paint in images.paints(
        _vertex_coordinates(vertex, faces), first_image, first_image + 1
    ):
        yield Part(
            points, faces[with_image], None if colours is None else colours[with_image], paint
        )


def _name_of_corners(element: Table) -> str | None:
    lists = list(element.lists)
    return next((name for name in lists if len(lists) == 1 or name in _CORNERS), None)


def _integers(corners: NDArray[Any]) -> NDArray[np.integer]:
    if corners.dtype.kind != "f":
        return corners
    wrong = corners[~(np.abs(corners) < 2**53) | (np.floor(corners) != corners)]
    if len(wrong):
        raise MeshError(f"a face names vertex {wrong[0]:g}; whole numbers are needed")
    return corners.astype(np.int64)


def _vertex_coordinates(vertex: Table, triangles: IntArray) -> FloatArray | None:
    for names in _VERTEX_COORDINATES:
        if set(names) <= set(vertex.columns):
            coordinates = np.column_stack([vertex.columns[name] for name in names]).astype(
                np.float64
            )
            return coordinates[triangles]
    return None


def _face_colours(
    tables: dict[str, Table], pieces: NDArray[np.int32], triangles: IntArray
) -> NDArray[np.uint8] | None:
    """Return the colours (t, 3) of triangles: mean of vertices, else of the polygon, else of its material; None without."""
    of_vertices = _colours(tables["vertex"])
    if of_vertices is not None:
        return mean_of_corners(of_vertices, triangles)
    face = tables["face"]
    of_faces = _colours(face)
    if of_faces is not None:
        return np.repeat(of_faces, pieces, axis=0)
    materials = _colours(tables["material"]) if "material" in tables else None
    if materials is None or "material_index" not in face.columns:
        return None
    number = np.repeat(face.columns["material_index"].astype(np.int64), pieces)
    is_known = (number >= 0) & (number < len(materials))
    return np.where(
        is_known[:, None], materials[np.where(is_known, number, 0)], np.array(GREY, np.uint8)
    )


def _colours(element: Table) -> NDArray[np.uint8] | None:
    """Return the colours (r, 3) of the rows of an element; None without colours."""
    for names in _COLOURS:
        if set(names) <= set(element.columns) and element.rows:
            return as_bytes(np.column_stack([element.columns[name] for name in names]))
    return None
