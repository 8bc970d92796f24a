"""A model made ready for the eye and the hand: upright, clean, centred, of unit size."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from visuohaptic.errors import MeshError
from visuohaptic.geometry.surface import Surface, read_surface
from visuohaptic.meshes.catalogue import Model
from visuohaptic.meshes.parameters import MeshParameters

UP_AXES = {"y": np.eye(3), "z": np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])}


def prepare_object(model: Model, path: str | Path, parameters: MeshParameters) -> Surface:
    """Read an object's model, packed or a user's own file, and make it ready as `normalise` does.

    Raises `MeshError`, which names the file, if it can't be read or has nothing to touch.
    """
    if str(path).endswith(".ply.gz"):
        surface = read_surface(path, parameters.largest_megabytes)
        rotation = np.eye(3) if model.rotation is None else np.reshape(model.rotation, (3, 3))
    else:
        from visuohaptic.meshes.model_files import read_model

        surface = read_model(path, parameters.largest_megabytes)
        rotation = UP_AXES[parameters.own_up_axis]
    return normalise(surface, str(path), rotation, model.dimensions, parameters.merge_tolerance)


def prepare_surface(surface: Surface, name: str, parameters: MeshParameters) -> Surface:
    """Make ready a surface in memory, as `prepare_object` does a user's own file."""
    up = UP_AXES[parameters.own_up_axis]
    return normalise(surface, name, up, merge_tolerance=parameters.merge_tolerance)


def normalise(
    surface: Surface,
    name: str,
    rotation: NDArray[np.float64] | None = None,
    dimensions: tuple[float, float, float] | None = None,
    merge_tolerance: float = 1e-6,
) -> Surface:
    """Turn, stretch, clean, centre and scale a surface.

    The centre is the surface's centroid, weighted by area: it turns with the
    object and does not move when triangles are subdivided. The vertex farthest
    from it gets distance 1.

    No face without area is left: those go that have none in the file, whose vertices
    merge, or that have none when vertices are rounded. Thin ones with some area stay.

    Parameters
    ----------
    surface : Surface
        In any frame and unit.
    name : str
        What to call it in an error.
    rotation : numpy.ndarray, optional
        Shape (3, 3); turns the model so that y is up.
    dimensions : tuple of float, optional
        Extents along x, y and z to stretch to, after the rotation. An extent
        of zero stays zero.
    merge_tolerance : float
        Vertices nearer than this become one, in units of the result.

    Returns
    -------
    Surface
        In the object frame. Vertices are numbers that float32 holds exactly, so
        that a float64 oracle and the float32 caster see the same surface.

    Raises
    ------
    MeshError
        If a vertex is NaN or infinite, a face names no vertex, or there is no area.
    """
    _check_finite(surface, name)
    vertices = _centred_box(surface.vertices[np.unique(surface.faces)], surface.vertices, name)
    if rotation is not None:
        vertices = np.einsum("nd,kd->nk", vertices, rotation)
    if dimensions is not None:
        vertices = _stretch(vertices, surface.faces, np.asarray(dimensions))
    scaled = replace(surface, vertices=_unit_size(vertices, surface.faces, name))
    cleaned = clean(scaled, merge_tolerance)
    single = _unit_size(cleaned.vertices, cleaned.faces, name).astype(np.float32)
    rounded = replace(cleaned, vertices=single.astype(np.float64))
    ready = _kept(rounded, rounded.face_areas > 0)
    if not len(ready.faces):
        raise MeshError(f"{name} has no area; a surface with at least one triangle is needed.")
    return ready


def clean(surface: Surface, merge_tolerance: float) -> Surface:
    """Merge coincident vertices and drop faces without area and repeated faces.

    Vertices whose coordinates round to the same multiple of `merge_tolerance` become one; with 0,
    equal ones only. Faces keep their order; of repeated ones (in either winding) the first stays.
    """
    grid = np.rint(surface.vertices / merge_tolerance) if merge_tolerance > 0 else surface.vertices
    _, first, inverse = np.unique(grid, axis=0, return_index=True, return_inverse=True)
    faces = first[inverse.reshape(-1)][surface.faces]
    corners = np.sort(faces, axis=1)
    whole = (corners[:, 0] != corners[:, 1]) & (corners[:, 1] != corners[:, 2])
    _, kept = np.unique(corners, axis=0, return_index=True)
    keep = np.zeros(len(faces), dtype=bool)
    keep[kept] = True
    merged = replace(surface, faces=faces)
    keep &= whole & (merged.face_areas > 0)
    return _kept(merged, keep)


def _kept(surface: Surface, keep: NDArray[np.bool_]) -> Surface:
    """Leave out the other faces, and the vertices that only they name."""
    used, renumbered = np.unique(surface.faces[keep], return_inverse=True)
    return Surface(
        surface.vertices[used],
        renumbered.reshape(-1, 3).astype(np.int64),
        surface.face_colours[keep],
        None if surface.texture is None else surface.texture.take(keep),
    )


def _check_finite(surface: Surface, name: str) -> None:
    if not len(surface.faces):
        raise MeshError(f"{name} has no faces; a surface of triangles or polygons is needed.")
    if surface.faces.min() < 0 or surface.faces.max() >= len(surface.vertices):
        raise MeshError(
            f"{name} has a face that names vertex {surface.faces.max()}; "
            f"0 to {len(surface.vertices) - 1} are there."
        )
    broken = np.flatnonzero(~np.isfinite(surface.vertices).all(axis=1))
    if len(broken):
        raise MeshError(
            f"{name} has {len(broken)} NaN or infinite vertices, the first is number {broken[0]}; "
            "finite coordinates are needed."
        )


def _centred_box(
    used: NDArray[np.float64], vertices: NDArray[np.float64], name: str
) -> NDArray[np.float64]:
    low, high = used.min(axis=0), used.max(axis=0)
    # Halves first: the extent of a mesh near the largest float64 would overflow.
    centre, half_extent = 0.5 * low + 0.5 * high, (0.5 * high - 0.5 * low).max()
    if not half_extent > 0:
        raise MeshError(f"{name} has no area; all its vertices are at one point.")
    return np.clip((vertices - centre) / half_extent, -1.0, 1.0)


def _stretch(
    vertices: NDArray[np.float64], faces: NDArray[np.int64], dimensions: NDArray[np.float64]
) -> NDArray[np.float64]:
    extent = np.ptp(vertices[np.unique(faces)], axis=0)
    factor = np.divide(dimensions, extent, out=np.ones(3), where=extent > 0)
    return vertices * factor


def _unit_size(
    vertices: NDArray[np.float64], faces: NDArray[np.int64], name: str
) -> NDArray[np.float64]:
    triangles = vertices[faces]
    crosses = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    areas = np.linalg.norm(crosses, axis=1)
    if not areas.sum() > 0:
        raise MeshError(f"{name} has no area; a surface with at least one triangle is needed.")
    centred = vertices - np.average(triangles.mean(axis=1), axis=0, weights=areas)
    return centred / np.linalg.norm(centred[np.unique(faces)], axis=1).max()
