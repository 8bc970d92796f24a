"""A model made ready for the eye and the hand: upright, clean, centred, of unit size."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import MeshError
from visuohaptic.geometry.surface import Surface, as_stored
from visuohaptic.geometry.turning import take_faces
from visuohaptic.geometry.vectors import product
from visuohaptic.meshes.catalogue import Model
from visuohaptic.meshes.model_files import PACKED, Source, name_of, read_mesh
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.meshes.up_axis import leans_on_y, steadiest_axis

MERGE_TOLERANCE = 1e-6
"""Vertices nearer than this, in object radii, become one: some ten steps of float32 at the unit sphere."""

UP_AXES = {
    "x": np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]),
    "y": np.eye(3),
    "z": np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]),
}
"""The rotation, (3, 3), that turns each axis to y."""


def prepare_object(model: Model, source: Source, parameters: MeshParameters) -> Surface:
    """Read an object's model and make it ready as `normalise` does.

    Raises `MeshError`, which names the source, if it can't be read or has nothing to touch.
    """
    return place_object(model, source, parameters)[0]


def place_object(
    model: Model, source: Source, parameters: MeshParameters, file_type: str | None = None
) -> tuple[Surface, FloatArray]:
    """Do the same, and return the matrix (4, 4) of `place`; `source` and `file_type` are those of `read_mesh`."""
    surface = read_mesh(source, file_type, parameters.largest_megabytes)
    name = name_of(source)
    if name.endswith(PACKED):
        rotation = np.eye(3) if model.rotation is None else np.reshape(model.rotation, (3, 3))
    else:
        rotation, notes = _upright(surface, name, parameters)
        surface = replace(surface, notes=(*surface.notes, *notes))
    return place(surface, name, rotation, model.dimensions)


def _upright(
    surface: Surface, name: str, parameters: MeshParameters
) -> tuple[FloatArray, list[str]]:
    """Return the rotation (3, 3) that turns an own model's axis that points up to y, and what to say of it."""
    axis: str = parameters.own_up_axis
    _check_finite(surface, name)
    if axis == "auto":
        return UP_AXES[steadiest_axis(surface, {axis: UP_AXES[axis] for axis in "yz"})], []
    if axis != "file":
        return UP_AXES[axis], []
    if surface.up_axis is not None:
        return UP_AXES[surface.up_axis], []
    if leans_on_y(surface, UP_AXES["z"]):
        note = f"{name} is taken as y-up, and would stand more steadily with z up"
        return UP_AXES["y"], [f"{note}; if so, say --up z (meshes.own_up_axis)."]
    return UP_AXES["y"], []


def normalise(
    surface: Surface,
    name: str,
    rotation: FloatArray | None = None,
    dimensions: tuple[float, float, float] | None = None,
    merge_tolerance: float = MERGE_TOLERANCE,
) -> Surface:
    """Turn, stretch, clean, centre and scale a surface of any frame and unit into the object frame.

    A rotation (3, 3) turns the model so that y is up. `dimensions` are the extents along x, y and z
    to stretch to after that; an extent of zero stays zero. The centre is the surface's centroid, and
    the vertex farthest from it gets distance 1. Vertices nearer than the merge tolerance, in units of
    the result, become one. No face without area is left. Vertices are numbers that float32 holds
    exactly, so that a float64 oracle and the float32 caster see the same surface.

    Raises `MeshError` if a vertex is NaN or infinite, a face names no vertex, or there is no area.
    """
    return place(surface, name, rotation, dimensions, merge_tolerance)[0]


def place(
    surface: Surface,
    name: str,
    rotation: FloatArray | None = None,
    dimensions: tuple[float, float, float] | None = None,
    merge_tolerance: float = MERGE_TOLERANCE,
) -> tuple[Surface, FloatArray]:
    """Do as `normalise` does, and give the matrix (4, 4) that takes points of the given frame there.

    It holds to the rounding of vertices, and is not finite where no number is its scale.
    """
    _check_finite(surface, name)
    used = surface.vertices[np.unique(surface.faces)]
    vertices, centre, half_extent = _centred_box(used, surface.vertices, name)
    way = _moved(-centre, half_extent)
    if rotation is not None:
        vertices = np.einsum("nd,kd->nk", vertices, rotation)
        turned = np.eye(4)
        turned[:3, :3] = rotation
        way = _joined(turned, way)
    if dimensions is not None:
        factor = _stretching(vertices, surface.faces, np.asarray(dimensions))
        vertices = vertices * factor
        way = _joined(np.diag([*factor, 1.0]), way)
    scaled, step = _unit_size(replace(surface, vertices=vertices), name)
    cleaned, last = _unit_size(clean(scaled, merge_tolerance), name)
    rounded = as_stored(cleaned)
    ready = take_faces(rounded, rounded.face_areas > 0)
    _check_area(ready, name)
    return ready, _joined(last, _joined(step, way))


def _moved(shift: FloatArray, length: float) -> FloatArray:
    """Give the matrix, (4, 4), that moves points and then divides them by a length."""
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        scale = np.float64(1.0) / length
        matrix = np.diag([scale, scale, scale, 1.0])
        matrix[:3, 3] = scale * shift
    return matrix


def _joined(then: FloatArray, first: FloatArray) -> FloatArray:
    with np.errstate(over="ignore", invalid="ignore"):
        return product(then, first)


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
    return take_faces(merged, keep)


def _check_finite(surface: Surface, name: str) -> None:
    if not len(surface.faces):
        raise MeshError(f"{name} has no faces; a surface of triangles or polygons is needed.")
    if surface.faces.min() < 0 or surface.faces.max() >= len(surface.vertices):
        raise MeshError(
            f"{name} has a face that names vertex {surface.faces.max()}; "
            f"0 to {len(surface.vertices) - 1} are there."
        )
    named = np.unique(surface.faces)
    broken = named[~np.isfinite(surface.vertices[named]).all(axis=1)]
    if len(broken):
        raise MeshError(
            f"{name} has {len(broken)} NaN or infinite vertices, the first is number {broken[0]}; "
            "finite coordinates are needed."
        )


def _centred_box(
    used: FloatArray, vertices: FloatArray, name: str
) -> tuple[FloatArray, FloatArray, float]:
    """Give vertices within the unit cube, what was taken from them, and by what they were divided."""
    low, high = used.min(axis=0), used.max(axis=0)
    # Halves first: the extent of a mesh near the largest float64 would overflow.
    centre, half_extent = 0.5 * low + 0.5 * high, (0.5 * high - 0.5 * low).max()
    if not half_extent > 0:
        raise MeshError(f"{name} has no area; all its vertices are at one point.")
    return np.clip((vertices - centre) / half_extent, -1.0, 1.0), centre, float(half_extent)


def _stretching(vertices: FloatArray, faces: IntArray, dimensions: FloatArray) -> FloatArray:
    """Give the factor of each axis, shape (3,)."""
    extent = np.ptp(vertices[np.unique(faces)], axis=0)
    return np.divide(dimensions, extent, out=np.ones(3), where=extent > 0)


def _unit_size(surface: Surface, name: str) -> tuple[Surface, FloatArray]:
    """Give a surface about its centroid within the unit ball, and the matrix (4, 4) of the way there."""
    _check_area(surface, name)
    centre = surface.centroid
    centred = surface.vertices - centre
    radius = np.linalg.norm(centred[np.unique(surface.faces)], axis=1).max()
    return replace(surface, vertices=centred / radius), _moved(-centre, float(radius))


def _check_area(surface: Surface, name: str) -> None:
    if not surface.face_areas.sum() > 0:
        raise MeshError(f"{name} has no area; a surface with at least one triangle is needed.")
