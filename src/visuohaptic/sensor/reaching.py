"""The sensor's reach: locations of an object that the smallest sensor can touch."""

from __future__ import annotations

import numpy as np

from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.sensor.adaptive_size import approach_distances, box_heights
from visuohaptic.sensor.imprints import Poses, cast_heights
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.placing import PENETRATION_TOLERANCE
from visuohaptic.sensor.touching import batches, sensor_poses


def reachable(
    caster: RayCaster,
    points: FloatArray,
    normals: FloatArray,
    parameters: SensorParameters,
    faces: IntArray | None = None,
) -> BoolArray:
    """Return whether the sensor can reach each location, independent of the others.

    A location is in reach if the smallest sensor can approach along the outward normal without an obstacle before
    its centre touches. The object may stand above the tangent plane by the penetration tolerance. If the size adapts,
    only touches out of reach are ``blocked`` or ``at_minimum``.

    Parameters
    ----------
    caster : RayCaster
        The object's surface, prepared for rays.
    points, normals : ndarray of shape (n, 3)
        Locations and outward unit normals, object frame.
    parameters : SensorParameters
        The sensor.
    faces : ndarray of shape (n,), int64, optional
        Faces under the locations, as for `touching.touch`.

    Returns
    -------
    ndarray of shape (n,), bool
        True in reach.
    """
    poses = sensor_poses(caster, points, normals, parameters, faces)
    parts = [_reachable_part(caster, poses[rows], parameters) for rows in batches(len(poses))]
    return np.concatenate(parts)


def _reachable_part(caster: RayCaster, poses: Poses, parameters: SensorParameters) -> BoolArray:
    tolerance = PENETRATION_TOLERANCE
    # Tangent planes above the object's bounding box need no rays. Half the tolerance, as in `place_batch`.
    in_reach = box_heights(caster, poses) <= 0.5 * tolerance
    unsure = np.flatnonzero(~in_reach)
    unsure = unsure[np.isinf(approach_distances(caster, poses[unsure], tolerance))]
    heights = cast_heights(
        caster,
        poses[unsure],
        np.full(len(unsure), parameters.smallest_size),
        np.full(len(unsure), caster.reach),
        parameters.resolution,
    )
    in_reach[unsure] = (heights <= tolerance).all(axis=(1, 2))
    return in_reach
