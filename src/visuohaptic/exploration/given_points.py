"""Touches at points that the caller chose, without an eye."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visuohaptic.errors import ParameterError
from visuohaptic.exploration.seen_points import explore
from visuohaptic.geometry.orientation import orient_outwards
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.subject import Subject
from visuohaptic.geometry.surface import Surface
from visuohaptic.one_phase import Tables
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.pipeline import everywhere

STRATEGY = "given"

FARTHEST = 0.1
"""A point may be so far off the surface, object radii; farther ones are in another frame."""


def touch_points(
    key: str,
    surface: Surface,
    at: ArrayLike,
    normals: ArrayLike | None,
    parameters: ExperimentParameters,
) -> tuple[Tables, dict[str, float]]:
    """Touch an object at given points, as `TouchableObject.touch` describes them.

    Gives all tables of an exploration, that of the views empty, and the seconds of touching and
    describing. Raises `ParameterError` if points or normals are none, or a point is too far off the
    surface.
    """
    from visuohaptic.fixations.locations import location_table
    from visuohaptic.fixations.places import ProbingLocations

    subject = Subject(key, lambda: RayCaster(surface))
    points, faces = _nearest(subject.caster, _rows(at, "at"))
    if normals is None:
        outwards = orient_outwards(subject.caster, points, surface.face_normals[faces])
    else:
        outwards = _unit(_rows(normals, "normals"), len(points))
        # The caller's normals are the sensor's own, whatever the touched face says.
        sensor = parameters.sensor.model_copy(update={"normal": "given"})
        parameters = parameters.model_copy(update={"sensor": sensor})
    places = ProbingLocations(points, outwards, faces)
    fixations = location_table(key, 0, STRATEGY, places)
    return explore([subject], everywhere(parameters, fixations), {"fixations": fixations})


def _rows(values: ArrayLike, name: str) -> NDArray[np.float64]:
    try:
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise ParameterError(f"{name} holds no numbers; an array (n, 3) is needed.") from None
    if array.ndim != 2 or array.shape[1] != 3 or not len(array):
        raise ParameterError(f"{name} has the shape {array.shape}; (n, 3) is needed.")
    broken = np.flatnonzero(~np.isfinite(array).all(axis=1))
    if len(broken):
        raise ParameterError(f"{name} has NaN or infinite numbers, the first in row {broken[0]}.")
    return array


def _nearest(
    caster: RayCaster, points: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    nearest, faces = caster.nearest(points)
    distances = np.linalg.norm(points - nearest, axis=1)
    off = np.flatnonzero(distances > FARTHEST)
    if len(off):
        raise ParameterError(
            f"point {off[0]} of at is {distances[off[0]]:.2g} object radii off the surface; at most "
            f"{FARTHEST} is allowed, in the object frame, in which `surface.vertices` are."
        )
    return nearest, faces


def _unit(normals: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    if len(normals) != count:
        raise ParameterError(f"There are {len(normals)} normals for {count} points.")
    lengths = np.linalg.norm(normals, axis=1)
    lost = np.flatnonzero(~(lengths > 0) | np.isinf(lengths))
    if len(lost):
        raise ParameterError(f"normal {lost[0]} has no direction; it is {normals[lost[0]]}.")
    return normals / lengths[:, None]
