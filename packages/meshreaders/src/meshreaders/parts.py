"""Parts of a model, as the readers of all formats return them, and their join to one mesh."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshreaders.base.arrays import FloatArray, IntArray
from meshreaders.base.errors import MeshError
from meshreaders.base.mesh import Mesh
from meshreaders.polygons import check_corners
from meshreaders.textures import Paint, add_textures

__all__ = ["GREY", "Paint", "Part", "join_parts"]

GREY = (160, 160, 160)
"""Colour (sRGB) of a face without colour."""


@dataclass(frozen=True)
class Part:
    """Triangles of a model that share an image, or have no image.

    Attributes
    ----------
    vertices : numpy.ndarray
        Shape (v, 3), any numeric type, in the frame of the file; transforms of a scene are applied.
    faces : numpy.ndarray
        Shape (f, 3), any integer type: rows of `vertices`.
    colours : numpy.ndarray or None
        Shape (f, 3), uint8, sRGB; None without colours.
    paint : Paint or None
        Image on all faces. The mean colours of the image then replace `colours`.
    """

    vertices: NDArray[Any]
    faces: NDArray[Any]
    colours: NDArray[np.uint8] | None = None
    paint: Paint | None = None


def join_parts(parts: Sequence[Part]) -> Mesh:
    """Join parts into one mesh, part after part, without unused vertices.

    Raises `MeshError` with the reason if there are no faces, an array has another shape, a face names a missing
    vertex, or an image can't be read.
    """
    non_empty = [_without_unused(part) for part in parts if len(part.faces)]
    # Free each part when it is joined: parts may be large.
    del parts
    if not non_empty:
        raise MeshError("it has no faces; triangles or polygons are needed")
    paints, colours = [part.paint for part in non_empty], [part.colours for part in non_empty]
    vertices_of_parts, faces_of_parts = (
        [part.vertices for part in non_empty],
        [part.faces for part in non_empty],
    )
    del non_empty
    counts, starts = [*map(len, faces_of_parts)], np.cumsum([0, *map(len, vertices_of_parts[:-1])])
    vertices = _joined_vertices(vertices_of_parts)
    faces = _joined_faces(faces_of_parts, starts)
    face_colours, texture = add_textures(paints, counts, _joined_colours(colours, counts))
    return Mesh(vertices, faces, face_colours, texture)


def _joined_vertices(parts: list[NDArray[Any]]) -> FloatArray:
    """Return the vertices (v, 3) of all parts; `parts` is emptied, to free memory."""
    if len(parts) == 1:
        return np.asarray(parts.pop(), dtype=np.float64)
    joined, end = np.empty((sum(map(len, parts)), 3)), 0
    parts.reverse()
    while parts:
        part = parts.pop()
        joined[end : end + len(part)] = part
        end += len(part)
    return joined


def _joined_faces(parts: list[NDArray[Any]], starts: IntArray) -> IntArray:
    """Return the faces (f, 3) of all parts, with `starts` added; `parts` is emptied, to free memory."""
    if len(parts) == 1:
        return np.asarray(parts.pop(), dtype=np.int64)
    joined, end = np.empty((sum(map(len, parts)), 3), dtype=np.int64), 0
    parts.reverse()
    for start in starts:
        part = parts.pop()
        rows = joined[end : end + len(part)]
        rows[:] = part
        rows += start
        end += len(part)
    return joined


def _without_unused(part: Part) -> Part:
    vertices, faces = np.asarray(part.vertices), np.asarray(part.faces)
    for name, array in (("vertices", vertices), ("faces", faces)):
        if array.ndim != 2 or array.shape[1] != 3:
            raise MeshError(f"{name} have the shape {array.shape}; (n, 3) is needed")
    # An index that is too high would name a vertex of the next part.
    check_corners(faces, len(vertices))
    used = np.zeros(len(vertices), dtype=bool)
    used[faces] = True
    if not used.all():
        faces = (np.cumsum(used, dtype=np.int32) - 1)[faces]
        vertices = vertices[used]
    return Part(vertices, faces, part.colours, part.paint)


def _joined_colours(
    parts: Sequence[NDArray[np.uint8] | None], counts: Sequence[int]
) -> NDArray[np.uint8]:
    joined, end = np.empty((sum(counts), 3), dtype=np.uint8), 0
    for colours, count in zip(parts, counts, strict=True):
        joined[end : end + count] = GREY if colours is None else colours
        end += count
    return joined
