"""Which places of an object the sensor can reach."""

from __future__ import annotations

import numpy as np

from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.sensor.adaptive_size import approach_distances, box_heights
from visuohaptic.sensor.imprints import Poses, cast_heights
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.placing import PENETRATION_TOLERANCE
from visuohaptic.sensor.touching import batches, stand


def reachable(
    caster: RayCaster,
    points: FloatArray,
    normals: FloatArray,
    parameters: SensorParameters,
    faces: IntArray | None = None,
) -> BoolArray:
    """Find which of n places the sensor can reach, each independent of the others.

    A place is in reach if the sensor at its smallest size, on its way along the outward normal and
    turned about it as the touch is, meets nothing before its centre touches. What stands no higher
    above the tangent plane than the penetration tolerance is not met. Where the size adapts, a touch
    is ``blocked`` or ``at_minimum`` at places out of reach alone.
    """
    poses = stand(caster, points, normals, parameters, faces)
    parts = [_reachable_part(caster, poses[rows], parameters) for rows in batches(len(poses))]
    return np.concatenate(parts)


def _reachable_part(caster: RayCaster, poses: Poses, parameters: SensorParameters) -> BoolArray:
    tolerance = PENETRATION_TOLERANCE
    # What nothing of the object can stand above needs no rays; as in `place`, half is no rounding.
    free = box_heights(caster, poses) <= 0.5 * tolerance
    rest = np.flatnonzero(~free)
    rest = rest[np.isinf(approach_distances(caster, poses[rest], tolerance))]
    heights = cast_heights(
        caster,
        poses[rest],
        np.full(len(rest), parameters.smallest_size),
        np.full(len(rest), caster.reach),
        parameters.resolution,
    )
    free[rest] = (heights <= tolerance).all(axis=(1, 2))
    return free
