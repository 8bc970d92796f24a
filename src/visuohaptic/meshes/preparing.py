"""Prepare models for views and touches: upright, clean, centred, of unit size."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from meshreaders.reading import name_of
from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.base.errors import MeshError
from visuohaptic.geometry.surface import Surface, as_stored
from visuohaptic.geometry.turning import take_faces
from visuohaptic.geometry.vectors import product
from visuohaptic.meshes.catalogue import Model
from visuohaptic.meshes.model_files import PACKED, Source, read_mesh
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.meshes.up_axis import (
    are_perpendicular,
    leans_on_y,
    rotation_upright,
    steadiest_axis,
)

MERGE_TOLERANCE = 1e-6
"""Step (object radii) of the grid on which `clean` merges vertices: about ten float32 steps at distance 1."""

# Faces that are noted, because the object may be another than meant (`_doubts_about_size`).
_NEAR_RADII = 0.1  # object radii
_NEAR_AREA = (
    0.999  # share of the area within `_NEAR_RADII`, above which the faces outside are noted
)
_MANY_MERGED = 0.1  # share of the faces that vanish by merging, above which they are noted

# Between these coordinates, squares of areas neither overflow nor vanish.
_NEAR, _FAR = 1e-60, 1e60


class Prepared(NamedTuple):
    """A surface in the object frame, and how its source was brought there.

    Attributes
    ----------
    surface : Surface
        The centroid, weighted by area, is the origin, and the farthest vertex has distance 1, up to float32 rounding.
        Every face has an area, and every vertex a face. Vertices are float64 with values that float32 represents
        exactly, so that float64 checks and the float32 ray caster see the same surface.
    matrix : numpy.ndarray
        Shape (4, 4): `matrix @ (x, y, z, 1)` is a point of the source in the object frame. Vertices of `surface` differ
        from transformed vertices only by merging and float32 rounding. Entries are infinite or NaN if the scale
        overflows float64.
    """

    surface: Surface
    matrix: FloatArray


def prepare_object(
    model: Model,
    source: Source,
    parameters: MeshParameters,
    file_type: str | None = None,
    advice: str = "set meshes.own_up_axis to z",
) -> Prepared:
    """Read a mesh, turn it upright and normalise it into the object frame.

    Parameters
    ----------
    model : Model
        Only `rotation` and `dimensions` are used. `rotation` counts only if the source is the path of a packed
        surface, ``.ply.gz``, in which models of the catalogue are stored.
    source : path, open file or mesh in memory
        Argument of `read_mesh`.
    parameters : MeshParameters
        Only `largest_megabytes`, `own_up_axis` and `own_front_axis` are used. The axes turn every source but a packed
        surface.
    file_type : str, optional
        Argument of `read_mesh`.
    advice : str
        End of the note on a doubtful up axis.

    Returns
    -------
    Prepared
        As of `normalise`. Notes of the surface include a doubtful up axis.

    Raises
    ------
    MeshError
        If the source can't be read, has a vertex that is not finite, has no area, or has an up axis that is parallel
        to `own_front_axis`. The message begins with the name of the source.
    """
    surface = read_mesh(source, file_type, parameters.largest_megabytes)
    name = name_of(source)
    if name.endswith(PACKED):
        rotation = np.eye(3) if model.rotation is None else np.reshape(model.rotation, (3, 3))
    else:
        rotation, notes = _upright(surface, name, parameters, advice)
        surface = replace(surface, notes=(*surface.notes, *notes))
    prepared, matrix = normalise(surface, name, rotation, model.dimensions)
    if name.endswith(PACKED):
        # Users can't mend models of the catalogue, so doubts about their size are dropped.
        prepared = replace(prepared, notes=surface.notes)
    return Prepared(prepared, matrix)


def _upright(
    surface: Surface, name: str, parameters: MeshParameters, advice: str
) -> tuple[FloatArray, list[str]]:
    """Return the rotation (3, 3) to the up and front axes of `parameters`, and a note if the default y is doubtful."""
    front = parameters.own_front_axis
    _check_faces_and_vertices(surface, name)
    surface = _with_finite_areas(surface)
    up: str = parameters.own_up_axis
    notes = []
    if up == "auto":
        possible = [axis for axis in "yz" if front is None or are_perpendicular(axis, front)]
        up = steadiest_axis(surface, {axis: rotation_upright(axis) for axis in possible})
    elif up == "file" and surface.up_axis is not None:
        up = surface.up_axis
    elif up == "file":
        up = "y"
        if leans_on_y(surface, rotation_upright("z")):
            doubt = f"{name} is taken as y-up, and would stand more steadily with z up"
            notes = [f"{doubt}; if so, {advice}."]
    if front is not None and not are_perpendicular(up, front):
        raise MeshError(
            f"{name} has up axis {up}, and the front axis is {front}; perpendicular axes are needed."
        )
    return rotation_upright(up, front), notes


def _with_finite_areas(surface: Surface) -> Surface:
    """Scale a surface of extreme coordinates by a power of two, which rounds none, so that its areas are finite."""
    largest = np.abs(surface.vertices[np.unique(surface.faces)]).max()
    if _NEAR < largest < _FAR:
        return surface
    exponent = int(np.frexp(largest)[1])
    with np.errstate(over="ignore", invalid="ignore"):  # of vertices without a face
        return replace(surface, vertices=np.ldexp(surface.vertices, -exponent))


def normalise(
    surface: Surface,
    name: str,
    rotation: FloatArray | None = None,
    dimensions: tuple[float, float, float] | None = None,
    merge_tolerance: float = MERGE_TOLERANCE,
) -> Prepared:
    """Turn, stretch, clean, centre and scale a surface of any frame and unit into the object frame.

    Parameters
    ----------
    surface : Surface
        The surface, in any frame and unit.
    name : str
        Name of the surface, for errors.
    rotation : numpy.ndarray, optional
        Shape (3, 3): turns the surface so that y is up.
    dimensions : tuple of float, optional
        Extents along x, y and z to which the turned surface is stretched. Only their ratios count, because the radius
        becomes 1. An axis along which the surface is flat stays flat.
    merge_tolerance : float
        Argument of `clean`, in object radii.

    Returns
    -------
    Prepared
        Notes of the surface include faces that decide the size of the object though nearly all area is near the centre,
        and many faces that vanish by merging.

    Raises
    ------
    MeshError
        If there is no face, a vertex of a face is missing, NaN or infinite, or the surface has no area, also if all
        faces vanish by merging.
    """
    _check_faces_and_vertices(surface, name)
    used = surface.vertices[np.unique(surface.faces)]
    vertices, centre, half_extent = _centred_box(used, surface.vertices, name)
    matrix = _translate_and_divide(-centre, half_extent)
    if rotation is not None:
        vertices = np.einsum("nd,kd->nk", vertices, rotation)
        turn = np.eye(4)
        turn[:3, :3] = rotation
        matrix = _compose(turn, matrix)
    if dimensions is not None:
        factor = _scale_factors(vertices, surface.faces, np.asarray(dimensions))
        vertices = vertices * factor
        matrix = _compose(np.diag([*factor, 1.0]), matrix)
    scaled, first_matrix = _unit_size(replace(surface, vertices=vertices), name)
    merged = _merged(scaled, merge_tolerance)
    doubts = _doubts_about_size(scaled, merged, merge_tolerance, name)
    distinct = _without_repeated(merged)
    if doubts and not len(distinct.faces):
        raise MeshError(" ".join(doubts))
    cleaned, last_matrix = _unit_size(distinct, name)
    cleaned = replace(cleaned, notes=(*cleaned.notes, *doubts))
    rounded = as_stored(cleaned)
    result = take_faces(rounded, rounded.face_areas > 0)
    _check_area(result, name)
    return Prepared(result, _compose(last_matrix, _compose(first_matrix, matrix)))


def _translate_and_divide(shift: FloatArray, length: float) -> FloatArray:
    """Return the matrix (4, 4) of the transform ``(point + shift) / length``."""
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        scale = np.float64(1.0) / length
        matrix = np.diag([scale, scale, scale, 1.0])
        matrix[:3, 3] = scale * shift
    return matrix


def _compose(second: FloatArray, first: FloatArray) -> FloatArray:
    with np.errstate(over="ignore", invalid="ignore"):
        return product(second, first)


def clean(surface: Surface, merge_tolerance: float) -> Surface:
    """Merge vertices, then drop faces without area, repeated faces and unused vertices.

    `merge_tolerance` is the step of a grid, in the unit of the surface. Vertices with the same nearest grid point
    become the one with the smallest x, of equal x the smallest y, then z. Close vertices with different grid points
    stay apart. With step 0, only equal vertices are merged. Faces keep their order. Of faces with the same corners, in
    either orientation, the first is kept, with its colour and image.
    """
    return _without_repeated(_merged(surface, merge_tolerance))


def _merged(surface: Surface, merge_tolerance: float) -> Surface:
    """Return a surface whose faces name merged vertices; see `clean`."""
    order = np.lexsort(surface.vertices.T[::-1])
    points = surface.vertices[order]
    grid = np.rint(points / merge_tolerance) if merge_tolerance > 0 else points
    _, first, inverse = np.unique(grid, axis=0, return_index=True, return_inverse=True)
    merged_vertices = np.empty(len(order), dtype=np.int64)
    merged_vertices[order] = order[first[inverse.reshape(-1)]]
    return replace(surface, faces=merged_vertices[surface.faces])


def _without_repeated(merged: Surface) -> Surface:
    """Drop faces without area, repeated faces and unused vertices."""
    corners = np.sort(merged.faces, axis=1)
    _, first_of_equals = np.unique(corners, axis=0, return_index=True)
    is_kept = np.zeros(len(corners), dtype=bool)
    is_kept[first_of_equals] = True
    is_kept &= _has_three_corners(merged.faces) & (merged.face_areas > 0)
    return take_faces(merged, is_kept)


def _has_three_corners(faces: IntArray) -> BoolArray:
    """Return whether the corners of each face (f, 3) are three vertices."""
    first, second, third = faces.T
    return (first != second) & (second != third) & (third != first)


def _doubts_about_size(
    scaled: Surface, merged: Surface, merge_tolerance: float, name: str
) -> list[str]:
    """Return notes on a surface of radius 1, `scaled`, if stray faces may decide its size; `merged` has merged vertices."""
    doubts = []
    distances = np.linalg.norm(scaled.vertices, axis=1)
    is_far = (distances > _NEAR_RADII)[scaled.faces].any(axis=1)
    # Areas are computed for few objects, as they take time.
    if 2 * is_far.sum() < len(is_far):
        near_area = scaled.face_areas[~is_far].sum()
        if near_area > _NEAR_AREA * scaled.face_areas.sum():
            ratio = 1 / max(distances[scaled.faces[~is_far]].max(), np.finfo(float).tiny)
            doubts.append(
                f"{name} is {ratio:,.0f} times as large as the part with nearly all its area, because of "
                f"{is_far.sum()} of {len(is_far)} faces; delete stray faces."
            )
    has_vanished = ~_has_three_corners(merged.faces)
    if has_vanished.sum() > _MANY_MERGED * len(has_vanished):
        vanished = int((scaled.face_areas[has_vanished] > 0).sum())
        if vanished > _MANY_MERGED * len(has_vanished):
            doubts.append(
                f"{name} lost {vanished} of {len(has_vanished)} faces, which are smaller than {merge_tolerance:g} "
                "of its radius; load parts that are far apart one by one."
            )
    return doubts


def _check_faces_and_vertices(surface: Surface, name: str) -> None:
    """Raise `MeshError` without faces, or if a vertex of a face is missing or not finite."""
    if not len(surface.faces):
        raise MeshError(f"{name} has no faces; a surface of triangles or polygons is needed.")
    if surface.faces.min() < 0 or surface.faces.max() >= len(surface.vertices):
        raise MeshError(
            f"{name} has a face that names vertex {surface.faces.max()}; "
            f"0 to {len(surface.vertices) - 1} are there."
        )
    used = np.unique(surface.faces)
    broken = used[~np.isfinite(surface.vertices[used]).all(axis=1)]
    if len(broken):
        raise MeshError(
            f"{name} has {len(broken)} NaN or infinite vertices, the first has index {broken[0]}; "
            "finite coordinates are needed."
        )


def _centred_box(
    used: FloatArray, vertices: FloatArray, name: str
) -> tuple[FloatArray, FloatArray, float]:
    """Return `vertices` scaled so that `used` fits the cube from -1 to 1, the old centre, and the old half extent."""
    low, high = used.min(axis=0), used.max(axis=0)
    # Halves first: the extent of a mesh near the largest float64 would overflow.
    centre, half_extent = 0.5 * low + 0.5 * high, (0.5 * high - 0.5 * low).max()
    if not half_extent > 0:
        raise MeshError(f"{name} has no area; all its vertices are at one point.")
    # Unused vertices may be far outside, or NaN; they are dropped later.
    return np.clip((vertices - centre) / half_extent, -1.0, 1.0), centre, float(half_extent)


def _scale_factors(vertices: FloatArray, faces: IntArray, dimensions: FloatArray) -> FloatArray:
    """Return the factors (3,) that stretch the extents to `dimensions`; 1 along a flat axis."""
    extent = np.ptp(vertices[np.unique(faces)], axis=0)
    return np.divide(dimensions, extent, out=np.ones(3), where=extent > 0)


def _unit_size(surface: Surface, name: str) -> tuple[Surface, FloatArray]:
    """Return the surface with its centroid at the origin and radius 1, and the matrix (4, 4) of this transform."""
    _check_area(surface, name)
    centre = surface.centroid
    centred = surface.vertices - centre
    radius = np.linalg.norm(centred[np.unique(surface.faces)], axis=1).max()
    return replace(surface, vertices=centred / radius), _translate_and_divide(
        -centre, float(radius)
    )


def _check_area(surface: Surface, name: str) -> None:
    if not surface.face_areas.sum() > 0:
        raise MeshError(f"{name} has no area; a surface with at least one triangle is needed.")
