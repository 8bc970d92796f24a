"""Parts of a model, as the readers of its formats return them, and the one surface of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import MeshError
from visuohaptic.geometry.surface import Surface
from visuohaptic.meshes.polygons import check_corners
from visuohaptic.meshes.textures import Paint, add_textures

__all__ = ["GREY", "Paint", "Part", "join_parts"]

GREY = (160, 160, 160)
"""Colour, sRGB, of a face that has none."""


@dataclass(frozen=True)
class Part:
    """Triangles of a model with one image or none.

    Attributes
    ----------
    vertices : numpy.ndarray
        Shape (v, 3), numbers of any type, in the file's frame; the transforms of a scene are applied.
    faces : numpy.ndarray
        Shape (f, 3), integers of any type: rows of `vertices`.
    colours : numpy.ndarray or None
        Shape (f, 3), uint8, sRGB; None where the file names no colour.
    paint : Paint or None
        An image on all faces; their colour is then its mean.
    """

    vertices: NDArray[Any]
    faces: NDArray[Any]
    colours: NDArray[np.uint8] | None = None
    paint: Paint | None = None


def join_parts(parts: Sequence[Part]) -> Surface:
    """Join parts into one surface, part after part, without the vertices that no face names.

    Raises `MeshError`, with the reason only, if there are no faces, an array has another shape, a
    face names no vertex, or an image can't be read.
    """
    shown = [_without_unnamed(part) for part in parts if len(part.faces)]
    # Parts may be large, and the surface takes the memory of each one that is joined.
    del parts
    if not shown:
        raise MeshError("it has no faces; triangles or polygons are needed")
    paints, colours = [part.paint for part in shown], [part.colours for part in shown]
    of_parts, faces_of_parts = [part.vertices for part in shown], [part.faces for part in shown]
    del shown
    counts, starts = [*map(len, faces_of_parts)], np.cumsum([0, *map(len, of_parts[:-1])])
    vertices = _joined_vertices(of_parts)
    faces = _joined_faces(faces_of_parts, starts)
    face_colours, texture = add_textures(paints, counts, _joined_colours(colours, counts))
    return Surface(vertices, faces, face_colours, texture)


def _joined_vertices(parts: list[NDArray[Any]]) -> FloatArray:
    """Return vertices (v, 3) of parts, which are taken out of the list one after another."""
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
    """Return faces (f, 3) of parts, whose vertices begin at `starts`; parts are taken out of the list."""
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


def _without_unnamed(part: Part) -> Part:
    vertices, faces = np.asarray(part.vertices), np.asarray(part.faces)
    for what, array in (("vertices", vertices), ("faces", faces)):
        if array.ndim != 2 or array.shape[1] != 3:
            raise MeshError(f"{what} have the shape {array.shape}; (n, 3) is needed")
    # An index too high would name a vertex of the next part.
    check_corners(faces, len(vertices))
    named = np.zeros(len(vertices), dtype=bool)
    named[faces] = True
    if not named.all():
        faces = (np.cumsum(named, dtype=np.int32) - 1)[faces]
        vertices = vertices[named]
    return Part(vertices, faces, part.colours, part.paint)


def _joined_colours(
    parts: Sequence[NDArray[np.uint8] | None], counts: Sequence[int]
) -> NDArray[np.uint8]:
    joined, end = np.empty((sum(counts), 3), dtype=np.uint8), 0
    for colours, count in zip(parts, counts, strict=True):
        joined[end : end + count] = GREY if colours is None else colours
        end += count
    return joined
