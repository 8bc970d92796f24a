"""Touches at points that the caller chose, without an eye."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from visuohaptic.errors import ParameterError
from visuohaptic.exploration.checking import point_rows, unit_rows
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

    Gives all tables of an exploration, that of the views empty, and each phase's seconds. Raises
    `ParameterError` if points or normals are none, or a point is too far off the surface.
    """
    from visuohaptic.fixations.locations import location_table
    from visuohaptic.fixations.places import ProbingLocations

    subject = Subject(key, lambda: RayCaster(surface))
    points = point_rows(at, "at")
    if not len(points):
        raise ParameterError("at has no points; at least one is needed.")
    places, faces = subject.caster.nearest(points)
    distances = np.linalg.norm(points - places, axis=1)
    off = np.flatnonzero(distances > FARTHEST)
    if len(off):
        raise ParameterError(
            f"point {off[0]} of at is {distances[off[0]]:.2g} object radii off the surface; at most "
            f"{FARTHEST} is allowed, in the object frame, in which `surface.vertices` are."
        )
    if normals is None:
        outwards = orient_outwards(subject.caster, places, surface.face_normals[faces])
    else:
        outwards = unit_rows(normals, "normals", len(points))
        # The caller's normals are the sensor's own, whatever the touched face says.
        sensor = parameters.sensor.model_copy(update={"normal": "given"})
        parameters = parameters.model_copy(update={"sensor": sensor})
    fixations = location_table(key, 0, STRATEGY, ProbingLocations(places, outwards, faces))
    return explore([subject], everywhere(parameters, fixations), {"fixations": fixations})
