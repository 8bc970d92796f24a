"""Surfaces that a caller holds in memory: a trimesh mesh or scene, or arrays."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visuohaptic.base.arrays import IntArray
from visuohaptic.base.errors import MeshError
from visuohaptic.geometry.surface import Surface
from visuohaptic.geometry.texture import REPEAT
from visuohaptic.meshes.parts import Paint, Part, join_parts


def surface_of_arrays(vertices: ArrayLike, faces: ArrayLike, name: str) -> Surface:
    """Give a grey surface of vertices (v, 3), in any frame and unit, and faces (f, 3).

    Raises `MeshError` if a shape or type is another; whether faces name vertices is checked when it
    is prepared.
    """
    corners = _check_columns(faces, "faces", name)
    if not np.issubdtype(corners.dtype, np.integer):
        raise MeshError(f"{name} has faces of {corners.dtype}; integers are needed.")
    return _joined([Part(_check_columns(vertices, "vertices", name), corners)], name)


def surface_of_trimesh(mesh: Any, name: str) -> Surface:
    """Return the surface of a ``trimesh.Trimesh``, or of all parts of a ``trimesh.Scene``.

    Materials and vertex colours become one colour per face; images stay images. Raises `MeshError`
    if there are no faces, or an image can't be read.
    """
    # Parts that don't fit each other may fail in any way; the scene is what is wrong.
    try:
        parts = list(parts_of_trimesh(mesh))
    except Exception as error:
        raise MeshError(f"{name} can't be read as one surface: {reason_of(error)}.") from error
    return _joined(parts, name)


def parts_of_trimesh(mesh: Any) -> Iterator[Part]:
    """Return the parts of a ``trimesh.Trimesh`` or ``trimesh.Scene``, each where the scene puts it.

    glTF's base colour multiplies an image as light, an MTL's `Kd` as stored, unless it is black, as
    some programs write it beside an image.
    """
    if not hasattr(mesh, "geometry"):
        if hasattr(mesh, "faces"):
            yield _part(mesh, mesh.vertices, mesh.faces)
        return
    for node in mesh.graph.nodes_geometry:
        transform, geometry = mesh.graph[node]
        shape = mesh.geometry[geometry]
        if hasattr(shape, "faces"):
            # Images are not copied with it, which `Scene.dump` would do for each part.
            moved = shape.copy(include_visual=False)
            moved.apply_transform(transform)
            yield _part(shape, moved.vertices, moved.faces)


def reason_of(error: Exception) -> str:
    """Give what went wrong in a library, on one line without a stop."""
    return " ".join(str(error).split())[:200].rstrip(".!") or "it is broken or truncated"


def _joined(parts: list[Part], name: str) -> Surface:
    if not any(len(part.faces) for part in parts):
        raise MeshError(f"{name} has no faces; a surface of triangles or polygons is needed.")
    try:
        return join_parts(parts)
    # Colours or images that don't fit the faces may fail in any way.
    except Exception as error:
        raise MeshError(f"{name} can't be read as one surface: {reason_of(error)}.") from error


def _part(mesh: Any, vertices: NDArray[Any], faces: NDArray[Any]) -> Part:
    """Return the part of a mesh with moved vertices, and faces that may be turned over."""
    # trimesh's arrays track changes, which costs time and is of no use here.
    vertices, faces = np.asarray(vertices), np.asarray(faces)
    return Part(vertices, faces, _face_colours(mesh.visual, faces), _paint(mesh, faces))


def _face_colours(visual: Any, faces: IntArray) -> NDArray[np.uint8] | None:
    """Return the colours (f, 3), sRGB, of the material, or the mean of the corners; None without."""
    if visual.kind == "texture":
        colour = np.asarray(visual.material.main_color)[:3].astype(np.uint8)
        return np.tile(colour, (len(faces), 1))
    if visual.kind == "vertex":
        corners = np.asarray(visual.vertex_colors)[faces][..., :3]
        return np.rint(corners.mean(axis=1)).astype(np.uint8)
    if visual.kind == "face":
        return np.asarray(visual.face_colors)[:, :3].astype(np.uint8)
    return None


def _paint(mesh: Any, faces: IntArray) -> Paint | None:
    if mesh.visual.kind != "texture":
        return None
    material, places = mesh.visual.material, mesh.visual.uv
    image = getattr(material, "image", None) or getattr(material, "baseColorTexture", None)
    if image is None or np.shape(places) != (len(mesh.vertices), 2):
        return None
    corners = np.asarray(places, dtype=np.float64)[faces]
    wraps = getattr(material, "wraps", (REPEAT, REPEAT))
    base = getattr(material, "baseColorFactor", None)
    if base is not None:
        return Paint(image, corners, wraps, _triple(np.asarray(base) / 255.0), linear=True)
    # trimesh gives a diffuse colour to a material that has none: what the file says is beside it.
    diffuse: Any = getattr(material, "kwargs", {}).get("kd")
    if np.shape(diffuse) != (3,) or not np.any(diffuse):
        return Paint(image, corners, wraps)
    return Paint(image, corners, wraps, _triple(diffuse))


def _triple(values: Any) -> tuple[float, float, float]:
    red, green, blue = np.clip(np.nan_to_num(np.asarray(values, dtype=np.float64)[:3]), 0, 1)
    return float(red), float(green), float(blue)


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
