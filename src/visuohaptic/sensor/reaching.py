"""The sensor's reach: locations of an object that the smallest pad can touch."""

from __future__ import annotations

import numpy as np

from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.sensor.adaptive_size import approach_distances, box_heights
from visuohaptic.sensor.imprints import Poses, cast_heights
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.placing import PENETRATION_TOLERANCE
from visuohaptic.sensor.sensing import batches, sensor_poses


def reachable(
    caster: RayCaster,
    points: FloatArray,
    normals: FloatArray,
    parameters: SensorParameters,
    faces: IntArray | None = None,
) -> BoolArray:
    """Return whether the sensor can reach each location, shape (n,); each result depends only on its own location.

    The smallest pad comes from outside the object, straight along the sensor's normal, until its centre meets the
    location. The location is in reach if no part of the object is higher above a point of the pad than
    `PENETRATION_TOLERANCE`. Rays at the centre and at the points of `Layout.approach` find such parts.

    If mode `adaptive_size` is ``auto`` or ``always``, touches in reach are never ``blocked`` or ``at_minimum``.

    The parameters are as in `sensing.touch`. The sensor has the normal of `parameters.normal`, and always the size
    `parameters.smallest_size`.
    """
    poses = sensor_poses(caster, points, normals, parameters, faces)
    parts = [_reachable_batch(caster, poses[rows], parameters) for rows in batches(len(poses))]
    return np.concatenate(parts)


def _reachable_batch(caster: RayCaster, poses: Poses, parameters: SensorParameters) -> BoolArray:
    tolerance = PENETRATION_TOLERANCE
    # No rays are needed if the bounding box stays below the tangent plane. The limit is that of `place_batch`.
    points = parameters.taxels.approach
    lowest = 0.5 * parameters.smallest_size * points.lowest
    in_reach = box_heights(caster, poses) <= 0.5 * tolerance + lowest
    unsure = np.flatnonzero(~in_reach)
    unsure = unsure[np.isinf(approach_distances(caster, poses[unsure], tolerance))]
    heights = cast_heights(
        caster,
        poses[unsure],
        np.full(len(unsure), parameters.smallest_size),
        np.full(len(unsure), caster.reach),
        points,
    )
    in_reach[unsure] = (heights.reshape(-1, len(points)) <= tolerance).all(axis=1)
    return in_reach
