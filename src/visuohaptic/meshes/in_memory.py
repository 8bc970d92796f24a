"""Meshes that a caller holds in memory: of trimesh, of Open3D, or two arrays."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visuohaptic.base.arrays import IntArray
from visuohaptic.base.errors import MeshError
from visuohaptic.geometry.texture import REPEAT
from visuohaptic.meshes.colours import as_bytes, mean_of_corners
from visuohaptic.meshes.parts import GREY, Paint, Part

_ALLOWED = (
    "a path, a trimesh.Trimesh or Scene, an Open3D TriangleMesh, (vertices, faces) or an open binary "
    "file is needed"
)


def parts_in_memory(mesh: Any) -> list[Part]:
    """Return the parts of a mesh or scene of trimesh, a triangle mesh of Open3D, or two arrays.

    Raises `MeshError`, with the reason only, if it is of another type, or an array of another shape.
    """
    if isinstance(mesh, tuple) and len(mesh) == 2:
        return [_part_of_arrays(*mesh)]
    if hasattr(mesh, "geometry") or (hasattr(mesh, "faces") and hasattr(mesh, "visual")):
        return list(parts_of_trimesh(mesh))
    if hasattr(mesh, "triangles") and hasattr(mesh, "vertices"):
        return list(_parts_of_open3d(mesh))
    if hasattr(mesh, "triangle") and hasattr(mesh, "vertex") and hasattr(mesh, "to_legacy"):
        return list(_parts_of_open3d(mesh.to_legacy()))
    raise MeshError(f"it is of type {type(mesh).__name__}; {_ALLOWED}")


def parts_of_trimesh(mesh: Any) -> Iterator[Part]:
    """Return the parts of a ``trimesh.Trimesh`` or ``trimesh.Scene``, each where the scene puts it.

    glTF's base colour multiplies an image as light, an MTL's `Kd` as stored, unless it is black, as
    some programs write it beside an image.
    """
    if not hasattr(mesh, "geometry"):
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


def _part_of_arrays(vertices: ArrayLike, faces: ArrayLike) -> Part:
    corners = _columns(faces, "faces")
    if not np.issubdtype(corners.dtype, np.integer):
        raise MeshError(f"it has faces of {corners.dtype}; integers are needed")
    return Part(_columns(vertices, "vertices"), corners)


def _columns(values: ArrayLike, what: str) -> NDArray[Any]:
    try:
        array = np.asarray(values)
    except ValueError:
        raise MeshError(f"it has {what} of unequal lengths; three each are needed") from None
    if array.dtype.kind not in "iuf":
        raise MeshError(f"it has {what} of {array.dtype}; numbers are needed")
    if array.ndim != 2 or array.shape[1] != 3:
        raise MeshError(f"it has {what} of shape {array.shape}; (n, 3) is needed")
    return array


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
        return mean_of_corners(np.asarray(visual.vertex_colors)[:, :3], faces)
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


def _parts_of_open3d(mesh: Any) -> Iterator[Part]:
    """Return the parts of a legacy ``open3d.geometry.TriangleMesh``: one per image, or only one."""
    from PIL.Image import fromarray

    vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.triangles, dtype=np.int64)
    colours = np.tile(np.array(GREY, np.uint8), (len(faces), 1))
    if mesh.has_vertex_colors():
        colours = mean_of_corners(as_bytes(np.asarray(mesh.vertex_colors)), faces)
    corners = np.asarray(mesh.triangle_uvs).reshape(-1, 3, 2)
    numbers = np.asarray(mesh.triangle_material_ids, dtype=np.int64)
    if len(corners) != len(faces) or not mesh.textures:
        yield Part(vertices, faces, colours)
        return
    if len(numbers) != len(faces):
        numbers = np.zeros(len(faces), dtype=np.int64)
    for number in np.unique(numbers):
        shown = numbers == number
        image = np.asarray(mesh.textures[number]) if 0 <= number < len(mesh.textures) else None
        # Open3D keeps the lowest row of an image first.
        paint = (
            Paint(fromarray(np.ascontiguousarray(image[::-1])), corners[shown])
            if image is not None and image.size
            else None
        )
        yield Part(vertices, faces[shown], colours[shown], paint)
