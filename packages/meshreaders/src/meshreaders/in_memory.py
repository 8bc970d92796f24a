"""Convert meshes in memory (trimesh, Open3D, PyVista, or two arrays) to parts."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshreaders.base.arrays import IntArray
from meshreaders.base.errors import MeshError
from meshreaders.base.mesh import Mesh
from meshreaders.base.srgb import encode_bytes
from meshreaders.base.texture import REPEAT
from meshreaders.colours import as_bytes, mean_of_corners
from meshreaders.parts import GREY, Paint, Part
from meshreaders.polygons import check_corners, triangulate_points

_ALLOWED = (
    "a path, a trimesh.Trimesh or Scene, an Open3D TriangleMesh, a pyvista.PolyData, (vertices, faces) "
    "or an open binary file is needed"
)


def parts_in_memory(mesh: Any) -> list[Part]:
    """Return the parts of a mesh or scene of trimesh, a triangle mesh of Open3D, a `PolyData` of PyVista, or two arrays.

    Raises `MeshError` with the reason if `mesh` has another type, or an array another shape.
    """
    if isinstance(mesh, Mesh):
        raise MeshError(f"it is of type Mesh, which has no parts; {_ALLOWED}")
    if isinstance(mesh, tuple) and len(mesh) == 2:
        return [_part_of_arrays(*mesh)]
    if hasattr(mesh, "geometry") or (hasattr(mesh, "faces") and hasattr(mesh, "visual")):
        return list(parts_of_trimesh(mesh))
    if hasattr(mesh, "triangles") and hasattr(mesh, "vertices"):
        return list(_parts_of_open3d(mesh))
    if hasattr(mesh, "triangle") and hasattr(mesh, "vertex") and hasattr(mesh, "to_legacy"):
        return list(_parts_of_open3d(mesh.to_legacy()))
    if hasattr(mesh, "points") and hasattr(mesh, "strips"):
        return [_part_of_pyvista(mesh)]
    raise MeshError(f"it is of type {type(mesh).__name__}; {_ALLOWED}")


def parts_of_trimesh(mesh: Any) -> Iterator[Part]:
    """Yield the parts of a ``trimesh.Trimesh`` or ``trimesh.Scene``, with the transforms of the scene.

    A glTF base colour multiplies the image in linear light. `Kd` of an MTL file multiplies the stored sRGB numbers.
    A black `Kd` is ignored, because some programs write it beside an image.
    """
    if not hasattr(mesh, "geometry"):
        yield _part(mesh, mesh.vertices, mesh.faces)
        return
    for node in mesh.graph.nodes_geometry:
        transform, geometry = mesh.graph[node]
        shape = mesh.geometry[geometry]
        if hasattr(shape, "faces"):
            # `Scene.dump` would copy the images of each part.
            transformed = shape.copy(include_visual=False)
            transformed.apply_transform(transform)
            yield _part(shape, transformed.vertices, transformed.faces)


def _part_of_arrays(vertices: ArrayLike, faces: ArrayLike) -> Part:
    corners = _columns(faces, "faces")
    if not np.issubdtype(corners.dtype, np.integer):
        raise MeshError(f"it has faces of {corners.dtype}; integers are needed")
    return Part(_columns(vertices, "vertices"), corners)


def _columns(values: ArrayLike, name: str) -> NDArray[Any]:
    if isinstance(values, np.ma.MaskedArray) and np.ma.is_masked(values):
        raise MeshError(
            f"it has {name} with masked values; fill or leave them out first, because masks are not read"
        )
    try:
        array = np.asarray(values)
    except ValueError:
        raise MeshError(f"it has {name} of unequal lengths; three each are needed") from None
    if array.dtype.kind not in "iuf":
        raise MeshError(f"it has {name} of {array.dtype}; numbers are needed")
    if array.ndim != 2 or array.shape[1] != 3:
        raise MeshError(f"it has {name} of shape {array.shape}; (n, 3) is needed")
    return array


def _part(mesh: Any, vertices: NDArray[Any], faces: NDArray[Any]) -> Part:
    """Return the part of a mesh, with the given vertices and faces."""
    # Arrays of trimesh track changes, which costs time.
    vertices, faces = np.asarray(vertices), np.asarray(faces)
    return Part(vertices, faces, _face_colours(mesh, faces), _paint(mesh, faces))


def _face_colours(mesh: Any, faces: IntArray) -> NDArray[np.uint8] | None:
    """Return the colours (f, 3), sRGB, of material, faces, or corners (mean); None without colours."""
    visual = mesh.visual
    if visual.kind == "texture":
        return np.tile(_material_colour(visual.material), (len(faces), 1))
    if visual.kind == "vertex" and _is_of_gltf(mesh):
        # trimesh keeps the vertex colours of a glTF as the file has them: linear light.
        light = np.asarray(visual.vertex_colors)[:, :3] / 255.0
        return encode_bytes(light[faces].mean(axis=1))
    if visual.kind == "vertex":
        return mean_of_corners(np.asarray(visual.vertex_colors)[:, :3], faces)
    if visual.kind == "face":
        return np.asarray(visual.face_colors)[:, :3].astype(np.uint8)
    return None


def _is_of_gltf(mesh: Any) -> bool:
    """Return whether trimesh loaded a mesh from a glTF file."""
    return getattr(getattr(mesh, "source", None), "file_type", None) in {"gltf", "glb"}


def _material_colour(material: Any) -> NDArray[np.uint8]:
    """Return the colour (3,), sRGB, of a material of trimesh; a base colour of glTF is linear light, white by default."""
    if not hasattr(material, "baseColorFactor"):
        return np.asarray(material.main_color)[:3].astype(np.uint8)
    factor = material.baseColorFactor
    return encode_bytes(np.ones(3) if factor is None else np.asarray(factor)[:3] / 255.0)


def _paint(mesh: Any, faces: IntArray) -> Paint | None:
    if mesh.visual.kind != "texture":
        return None
    material, coordinates = mesh.visual.material, mesh.visual.uv
    image = getattr(material, "image", None) or getattr(material, "baseColorTexture", None)
    if image is None or np.shape(coordinates) != (len(mesh.vertices), 2):
        return None
    corners = np.asarray(coordinates, dtype=np.float64)[faces]
    wraps = getattr(material, "wraps", (REPEAT, REPEAT))
    base = getattr(material, "baseColorFactor", None)
    if base is not None:
        return Paint(image, corners, wraps, _triple(np.asarray(base) / 255.0), linear=True)
    # trimesh sets a default diffuse colour; `kwargs` has the colour of the file.
    diffuse: Any = getattr(material, "kwargs", {}).get("kd")
    if np.shape(diffuse) != (3,) or not np.any(diffuse):
        return Paint(image, corners, wraps)
    return Paint(image, corners, wraps, _triple(diffuse))


def _triple(values: Any) -> tuple[float, float, float]:
    red, green, blue = np.clip(np.nan_to_num(np.asarray(values, dtype=np.float64)[:3]), 0, 1)
    return float(red), float(green), float(blue)


def _parts_of_open3d(mesh: Any) -> Iterator[Part]:
    """Yield the parts of a legacy ``open3d.geometry.TriangleMesh``: one part per image, or a single part."""
    from PIL.Image import fromarray

    vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.triangles, dtype=np.int64)
    colours = np.tile(np.array(GREY, np.uint8), (len(faces), 1))
    if mesh.has_vertex_colors():
        colours = mean_of_corners(as_bytes(np.asarray(mesh.vertex_colors)), faces)
    corners = np.asarray(mesh.triangle_uvs).reshape(-1, 3, 2)
    image_indices = np.asarray(mesh.triangle_material_ids, dtype=np.int64)
    if len(corners) != len(faces) or not mesh.textures:
        yield Part(vertices, faces, colours)
        return
    if len(image_indices) != len(faces):
        image_indices = np.zeros(len(faces), dtype=np.int64)
    for index in np.unique(image_indices):
        chosen = image_indices == index
        image = np.asarray(mesh.textures[index]) if 0 <= index < len(mesh.textures) else None
        # Open3D keeps the lowest row of an image first.
        paint = (
            Paint(fromarray(np.ascontiguousarray(image[::-1])), corners[chosen])
            if image is not None and image.size
            else None
        )
        yield Part(vertices, faces[chosen], colours[chosen], paint)


def _part_of_pyvista(mesh: Any) -> Part:
    """Return the polygons of a ``pyvista.PolyData``, with its colours of cells, or else of points."""
    if len(mesh.strips):
        raise MeshError("it has triangle strips; `mesh.triangulate()` turns them into triangles")
    points = np.asarray(mesh.points)
    corners, counts = _runs(np.asarray(mesh.faces, dtype=np.int64))
    check_corners(corners, len(points))
    faces, pieces = triangulate_points(points, corners, counts)
    colours = _colours_of(mesh.cell_data)
    if colours is None:
        return Part(points, faces, mean_of_corners(_colours_of(mesh.point_data), faces))
    # Single points and lines are cells too, and come before the polygons.
    return Part(points, faces, np.repeat(colours[len(colours) - len(counts) :], pieces, axis=0))


def _runs(padded: IntArray) -> tuple[IntArray, IntArray]:
    """Return the corners (c,) and their number per polygon (p,) from an array of VTK: number, corners, number, corners, ...."""
    if len(padded) % 4 == 0 and (padded[::4] == 3).all():
        return padded.reshape(-1, 4)[:, 1:].reshape(-1), padded[::4]
    starts, start = [], 0
    while start < len(padded):
        starts.append(start)
        start += 1 + int(padded[start])
    is_corner = np.ones(len(padded), dtype=bool)
    is_corner[starts] = False
    return padded[is_corner], padded[starts]


def _colours_of(data: Any) -> NDArray[np.uint8] | None:
    """Return the colours (n, 3) of points or cells: the active array, else the first, of three or four bytes each."""
    names = dict.fromkeys([data.active_scalars_name, *data.keys()])
    arrays = (np.asarray(data[name]) for name in names if name is not None)
    return next(
        (
            array[:, :3]
            for array in arrays
            if array.dtype == np.uint8 and array.ndim == 2 and array.shape[1] in (3, 4)
        ),
        None,
    )
