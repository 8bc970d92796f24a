"""Surfaces that a caller holds in memory: a trimesh mesh or scene, or arrays."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visuohaptic.base.errors import MeshError
from visuohaptic.geometry.surface import Surface
from visuohaptic.meshes.polygons import check_corners
from visuohaptic.meshes.textures import add_textures

GREY = (160, 160, 160)
"""Colour, sRGB, of a face that has none."""


def surface_of_arrays(vertices: ArrayLike, faces: ArrayLike, name: str) -> Surface:
    """Give a grey surface of vertices (v, 3), in any frame and unit, and faces (f, 3).

    Raises `MeshError` if a shape or type is another; whether faces name vertices is checked when it
    is prepared.
    """
    corners = _check_columns(faces, "faces", name)
    if not np.issubdtype(corners.dtype, np.integer):
        raise MeshError(f"{name} has faces of {corners.dtype}; integers are needed.")
    points = _check_columns(vertices, "vertices", name)
    colours = np.tile(np.array(GREY, dtype=np.uint8), (len(corners), 1))
    return Surface(points.astype(np.float64), corners.astype(np.int64), colours)


def surface_of_trimesh(mesh: Any, name: str) -> Surface:
    """Give the surface of a ``trimesh.Trimesh``, or of all parts of a ``trimesh.Scene``.

    Materials and vertex colours become a colour a face; images stay images. Raises `MeshError`
    if there are no faces, or an image can't be read.
    """
    # Parts that don't fit each other may fail in any way; the scene is what is wrong.
    try:
        parts = [part for part in _parts(mesh) if len(part.faces)]
        if parts:
            return _joined(parts)
    except Exception as error:
        raise MeshError(f"{name} can't be read as one surface: {reason_of(error)}.") from error
    raise MeshError(f"{name} has no faces; a surface of triangles or polygons is needed.")


def reason_of(error: Exception) -> str:
    """Give what went wrong in a library, on one line without a stop."""
    return " ".join(str(error).split())[:200].rstrip(".!") or "it is broken or truncated"


@dataclass(frozen=True)
class _Part:
    """A mesh where its scene puts it, with the colours and images of the one that it stands for."""

    vertices: NDArray[Any]
    faces: NDArray[Any]
    visual: Any


def _joined(parts: list[_Part]) -> Surface:
    for part in parts:
        if part.vertices.shape[1:] != (3,):
            raise MeshError(f"vertices have the shape {part.vertices.shape}; (n, 3) is needed")
        # An index too high would name a vertex of the next part.
        check_corners(np.ravel(part.faces), len(part.vertices))
    starts = np.cumsum([0, *(len(part.vertices) for part in parts[:-1])])
    colours = np.concatenate([face_colours(part) for part in parts])
    colours, texture = add_textures(parts, colours)
    return Surface(
        np.concatenate([np.asarray(part.vertices, dtype=np.float64) for part in parts]),
        np.concatenate(
            [
                np.asarray(part.faces, dtype=np.int64) + start
                for part, start in zip(parts, starts, strict=True)
            ]
        ),
        colours,
        texture,
    )


def _parts(mesh: Any) -> Iterator[_Part]:
    if not hasattr(mesh, "geometry"):
        if hasattr(mesh, "faces"):
            yield _Part(mesh.vertices, mesh.faces, mesh.visual)
        return
    for node in mesh.graph.nodes_geometry:
        transform, geometry = mesh.graph[node]
        part = mesh.geometry[geometry]
        if hasattr(part, "faces"):
            # Images are not copied with it, which `Scene.dump` would do for each part.
            moved = part.copy(include_visual=False)
            moved.apply_transform(transform)
            yield _Part(moved.vertices, moved.faces, part.visual)


def _check_columns(values: ArrayLike, what: str, name: str) -> NDArray[Any]:
    try:
        array = np.asarray(values)
    except ValueError:
        raise MeshError(f"{name} has {what} of unequal lengths; three each are needed.") from None
    if array.dtype.kind not in "iuf":
        raise MeshError(f"{name} has {what} of {array.dtype}; numbers are needed.")
    if array.ndim != 2 or array.shape[1] != 3:
        raise MeshError(f"{name} has {what} of shape {array.shape}; (n, 3) is needed.")
    return array


def face_colours(part: Any) -> NDArray[np.uint8]:
    """Give the colours (f, 3), uint8, sRGB, of a mesh's faces: of the material, or the corners' mean, or `GREY`."""
    visual, count = part.visual, len(part.faces)
    if visual.kind == "texture":
        return np.tile(np.asarray(visual.material.main_color)[:3].astype(np.uint8), (count, 1))
    if visual.kind == "vertex":
        corners = np.asarray(visual.vertex_colors)[part.faces][..., :3]
        return np.rint(corners.mean(axis=1)).astype(np.uint8)
    if visual.kind == "face":
        return np.asarray(visual.face_colors)[:, :3].astype(np.uint8)
    return np.tile(np.array(GREY, dtype=np.uint8), (count, 1))
