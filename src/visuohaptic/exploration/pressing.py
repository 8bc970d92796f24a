"""A tactile array at any pose on a mesh: one call, many poses, no experiment."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visuohaptic.errors import MeshError, ParameterError
from visuohaptic.geometry.surface import Surface
from visuohaptic.sensor.parameters import Orientation

if TYPE_CHECKING:
    from trimesh import Trimesh

    Mesh: TypeAlias = Trimesh | tuple[ArrayLike, ArrayLike]


@dataclass(frozen=True)
class Pressed:
    """What n sensors feel.

    Attributes
    ----------
    images : numpy.ndarray
        Shape (n, r, r), float32: 1 where the surface is at the sensor's plane or above it, 0 where it
        is `depth` or more below.
    heights : numpy.ndarray
        Shape (n, r, r), float64, in the mesh's unit: the surface above the sensor's plane, negative
        below it, minus infinity where there is none.
    """

    images: NDArray[np.float32]
    heights: NDArray[np.float64]


def press(
    mesh: Mesh,
    points: ArrayLike,
    normals: ArrayLike,
    size: ArrayLike,
    resolution: int = 32,
    depth: float | None = None,
    above: float | None = None,
    orientation: Orientation = "upright",
) -> Pressed:
    """Press square sensors on a mesh, all in one batch.

    Lengths and positions are those of the mesh; nothing is turned, moved or scaled.

    Parameters
    ----------
    mesh : trimesh.Trimesh or (vertices, faces)
        The object; arrays of the shapes (v, 3) and (f, 3).
    points : array_like
        Shape (n, 3): centres of the sensors' planes, on the surface or anywhere else.
    normals : array_like
        Shape (n, 3): away from the object; any length but 0.
    size : array_like
        Edge of the squares: a number, or shape (n,).
    resolution : int
        Sensing points r along an edge.
    depth : float, optional
        How deep below its plane a sensor feels; a third of the largest size by default.
    above : float, optional
        How far above the plane the sensors come from; what is higher is not met. The largest size by
        default.
    orientation : {"upright", "transported"}
        How squares are turned about their normals.

    Returns
    -------
    Pressed
        Rows count downwards and columns to the right, seen from outside.

    Raises
    ------
    MeshError
        If the mesh has nothing to touch.
    ParameterError
        If a pose or a measure is not allowed.
    """
    from visuohaptic.geometry.raycasting import RayCaster
    from visuohaptic.sensor.imprints import cast_heights, stand_on

    where, outward = _rows(points, "points"), _rows(normals, "normals")
    if len(where) != len(outward):
        raise ParameterError(
            f"There are {len(where)} points and {len(outward)} normals; as many of both are needed."
        )
    lengths = np.linalg.norm(outward, axis=1, keepdims=True)
    if not lengths.all():
        raise ParameterError(
            f"Normal {int(np.argmin(lengths))} has the length 0; a direction is needed."
        )
    sizes = _positive(np.broadcast_to(np.asarray(size, dtype=np.float64), (len(where),)), "size")
    if resolution < 2:
        raise ParameterError(f"resolution is {resolution}; 2 or more is allowed.")
    largest = float(sizes.max(initial=0.0)) or 1.0
    deep = float(_positive(np.array(largest / 3 if depth is None else depth), "depth"))
    high = float(_positive(np.array(largest if above is None else above), "above"))
    surface, centre, radius = _unit_surface(mesh)
    poses = stand_on((where - centre) / radius, outward / lengths, orientation)
    lifts = np.full(len(where), high / radius)
    heights = cast_heights(RayCaster(surface), poses, sizes / radius, lifts, resolution) * radius
    return Pressed(np.clip(1 + heights / deep, 0, 1).astype(np.float32), heights)


def _unit_surface(mesh: Mesh) -> tuple[Surface, NDArray[np.float64], float]:
    """Give the mesh within the unit ball, where rays are exact enough, its centre and radius."""
    from dataclasses import replace

    from visuohaptic.meshes.in_memory import surface_of_arrays, surface_of_trimesh

    if isinstance(mesh, tuple):
        surface = surface_of_arrays(mesh[0], mesh[1], "mesh")
    elif hasattr(mesh, "faces"):
        surface = surface_of_trimesh(mesh, "mesh")
    else:
        raise MeshError(
            f"The mesh is of type {type(mesh).__name__}; a trimesh.Trimesh or (vertices, faces) is needed."
        )
    vertices, faces = surface.vertices, surface.faces
    if not len(faces) or not np.isfinite(vertices).all():
        raise MeshError(
            "The mesh has no faces, or vertices that are not finite; a surface is needed."
        )
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise MeshError(f"The mesh has {len(vertices)} vertices and faces that name others.")
    centre = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    radius = float(np.linalg.norm(vertices - centre, axis=1).max())
    if not radius > 0:
        raise MeshError("All vertices of the mesh are one point; there is nothing to touch.")
    return replace(surface, vertices=(vertices - centre) / radius), centre, radius


def _rows(values: ArrayLike, name: str) -> NDArray[np.float64]:
    found = np.asarray(values, dtype=np.float64)
    if found.ndim != 2 or found.shape[1] != 3 or not np.isfinite(found).all():
        raise ParameterError(f"{name} has the shape {found.shape}; (n, 3), all finite, is needed.")
    return found


def _positive(values: NDArray[np.float64], name: str) -> NDArray[np.float64]:
    if not (np.isfinite(values) & (values > 0)).all():
        raise ParameterError(
            f"{name} holds {values.min():g}; positive, finite lengths are allowed."
        )
    return values
