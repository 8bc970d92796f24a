"""Placing sensors on the object: the approach, the size, and the heights under the square."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import BoolArray, FloatArray
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.scene.parameters import Mode
from visuohaptic.scene.records import EffectRecord
from visuohaptic.sensor.adaptive_size import (
    admissible_sizes,
    approach_distances,
    box_heights,
    free_half_sizes,
    unobstructed_half_sizes,
)
from visuohaptic.sensor.imprints import Poses, cast_heights
from visuohaptic.sensor.parameters import SensorParameters

PENETRATION_TOLERANCE = 0.002
"""Allowed height of the object above the sensor's plane, object radii: 2 % of the default depth range. Our choice."""

CLEARANCE = 0.1
"""Height of the sensor's body, object radii. Our choice. Under an obstacle farther out, sensors start at this height."""


@dataclass(frozen=True)
class Placed:
    """Sensors that are placed on the object; lengths are in object radii.

    Attributes
    ----------
    poses : Poses
        Frames of the n sensors.
    heights : ndarray of shape (n, r, r)
        Heights of the surface above the tangent plane.
    sizes : ndarray of shape (n,)
        Edges of the squares.
    blocked : ndarray of shape (n,), bool
        Whether the approach is obstructed.
    record : EffectRecord
        Record of the adaptive size.
    """

    poses: Poses
    heights: FloatArray
    sizes: FloatArray
    blocked: BoolArray
    record: EffectRecord


def place_batch(
    caster: RayCaster, poses: Poses, parameters: SensorParameters, mode: Mode
) -> Placed:
    """Place sensors on the object, each as large as the object allows and independent of the others.

    Rays start outside the object, or within `CLEARANCE` if an obstacle is on the way of the sensor's centre. A touch
    needs an adaptive size if the object's bounding box reaches above its tangent plane. Then rays in the plane bound
    the square before it is cast. Surfaces that penetrate without crossing the plane, such as overhangs, shrink the
    square afterwards.

    Parameters
    ----------
    caster : RayCaster
        The object's surface, prepared for rays.
    poses : Poses
        Frames of the sensors.
    parameters : SensorParameters
        Resolution and sizes.
    mode : {"auto", "always", "never"}
        When the size adapts.

    Returns
    -------
    Placed
        The placed sensors.
    """
    tolerance, resolution = PENETRATION_TOLERANCE, parameters.resolution
    obstacles = approach_distances(caster, poses, tolerance)
    obstructed = np.isfinite(obstacles)
    under_obstacle = np.minimum(CLEARANCE, 0.5 * (tolerance + obstacles))
    lifts = np.where(obstructed, under_obstacle, caster.reach)
    sizes = np.full(len(poses), parameters.largest_size)

    started = time.process_time()
    # Half the tolerance is far above rounding, so the effect changes no bit of touches that don't need it.
    needing = box_heights(caster, poses) > 0.5 * tolerance
    adapting = needing if mode == "auto" else np.full(len(poses), mode == "always")
    rows = np.flatnonzero(adapting)
    sizes[rows] = admissible_sizes(
        free_half_sizes(caster, poses[rows], tolerance),
        parameters.smallest_size,
        parameters.largest_size,
    )
    sizing = time.process_time() - started

    heights = cast_heights(caster, poses, sizes, lifts, resolution)
    started = time.process_time()
    _shrink_further(caster, poses, parameters, lifts, rows, sizes, heights)
    sizing += time.process_time() - started

    tall = (heights > CLEARANCE).any(axis=(1, 2))
    record = EffectRecord(
        "adaptive_size",
        mode,
        "where the object's bounding box reaches above the tangent plane",
        len(poses),
        int(needing.sum()),
        len(rows),
        sizing,
    )
    return Placed(poses, heights, sizes, obstructed | tall, record)


def _shrink_further(
    caster: RayCaster,
    poses: Poses,
    parameters: SensorParameters,
    lifts: FloatArray,
    rows: NDArray[np.intp],
    sizes: FloatArray,
    heights: FloatArray,
) -> None:
    """Shrink the squares at `rows` until no sensing point is penetrated; changes `sizes` and `heights`."""
    tolerance, resolution = PENETRATION_TOLERANCE, parameters.resolution
    while len(rows):
        free = unobstructed_half_sizes(heights[rows], sizes[rows], tolerance)
        smaller = admissible_sizes(free, parameters.smallest_size, parameters.largest_size)
        # Each pass removes at least a ring of sensing points, so the loop ends at the smallest allowed square.
        shrinks = smaller < sizes[rows]
        rows = rows[shrinks]
        sizes[rows] = smaller[shrinks]
        heights[rows] = cast_heights(caster, poses[rows], sizes[rows], lifts[rows], resolution)
