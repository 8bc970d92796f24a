"""Parts of a model, as the readers of its formats return them, and the one surface of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

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
        Shape (v, 3), float, in the file's frame; the transforms of a scene are applied.
    faces : numpy.ndarray
        Shape (f, 3), integers: rows of `vertices`.
    colours : numpy.ndarray or None
        Shape (f, 3), uint8, sRGB; None where the file names no colour.
    paint : Paint or None
        An image on all faces; their colour is then its mean.
    """

    vertices: FloatArray
    faces: IntArray
    colours: NDArray[np.uint8] | None = None
    paint: Paint | None = None


def join_parts(parts: Sequence[Part]) -> Surface:
    """Join parts into one surface, part after part, without the vertices that no face names.

    Raises `MeshError`, with the reason only, if there are no faces, an array has another shape, a
    face names no vertex, or an image can't be read.
    """
    waiting = [part for part in parts if len(part.faces)][::-1]
    # Parts may be views of the file's content, which is freed with the last one.
    del parts
    shown = []
    while waiting:
        shown.append(_without_unnamed(waiting.pop()))
    if not shown:
        raise MeshError("it has no faces; triangles or polygons are needed")
    starts = np.cumsum([0, *(len(part.vertices) for part in shown[:-1])])
    colours, texture = add_textures(
        [part.paint for part in shown],
        [len(part.faces) for part in shown],
        np.concatenate([_colours(part) for part in shown]),
    )
    if len(shown) == 1:
        return Surface(shown[0].vertices, shown[0].faces, colours, texture)
    return Surface(
        np.concatenate([part.vertices for part in shown]),
        np.concatenate([part.faces + start for part, start in zip(shown, starts, strict=True)]),
        colours,
        texture,
    )


def _without_unnamed(part: Part) -> Part:
    vertices = np.asarray(part.vertices, dtype=np.float64)
    faces = np.asarray(part.faces, dtype=np.int64)
    for what, array in (("vertices", vertices), ("faces", faces)):
        if array.ndim != 2 or array.shape[1] != 3:
            raise MeshError(f"{what} have the shape {array.shape}; (n, 3) is needed")
    # An index too high would name a vertex of the next part.
    check_corners(faces, len(vertices))
    named = np.zeros(len(vertices), dtype=bool)
    named[faces] = True
    if not named.all():
        faces = (np.cumsum(named) - 1)[faces]
        vertices = vertices[named]
    return Part(vertices, faces, part.colours, part.paint)


def _colours(part: Part) -> NDArray[np.uint8]:
    if part.colours is None:
        return np.tile(np.array(GREY, dtype=np.uint8), (len(part.faces), 1))
    return part.colours
