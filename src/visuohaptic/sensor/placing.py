"""Placing the sensor on the object: the approach, the size, and the heights under the square."""

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
"""How far the object may stand above the sensor's plane, object radii: 2 % of the default depth range. Our choice."""

CLEARANCE = 0.1
"""Height of the sensor's body, object radii; our choice. Where the approach is blocked farther out, the sensor is set down from this height."""


@dataclass(frozen=True)
class Placed:
    """How n sensors of some poses are placed on the object.

    `heights` (n, r, r) are those of the surface above the tangent plane and `sizes` (n,) the
    squares' edges, object radii; `blocked` (n,) says where the approach is obstructed. The seconds
    of the adaptive size's record include the decision.
    """

    poses: Poses
    heights: FloatArray
    sizes: FloatArray
    blocked: BoolArray
    record: EffectRecord


def place(caster: RayCaster, poses: Poses, parameters: SensorParameters, mode: Mode) -> Placed:
    """Place sensors on the object, each as large as the object allows, whatever else is in the batch.

    Rays start outside the object; if the centre's own approach is obstructed, within the sensor's
    clearance instead. A touch needs an adaptive size if the object's bounding box reaches above its
    tangent plane. Then the surface's crossings of that plane bound the square in closed form before
    it is cast; what still penetrates (an overhang crosses no plane) bounds it again.
    """
    tolerance, resolution = PENETRATION_TOLERANCE, parameters.resolution
    way_out = approach_distances(caster, poses, tolerance)
    obstructed = np.isfinite(way_out)
    under_obstacle = np.minimum(CLEARANCE, 0.5 * (tolerance + way_out))
    lifts = np.where(obstructed, under_obstacle, caster.reach)
    sizes = np.full(len(poses), parameters.largest_size)

    started = time.process_time()
    # Half the tolerance is far above rounding, so touches that don't need it change by no bit.
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
    """Shrink the squares of some rows, in place, until no sensing point is penetrated."""
    tolerance, resolution = PENETRATION_TOLERANCE, parameters.resolution
    while len(rows):
        free = unobstructed_half_sizes(heights[rows], sizes[rows], tolerance)
        smaller = admissible_sizes(free, parameters.smallest_size, parameters.largest_size)
        # A pass takes away a ring of sensing points at least, until the square is the smallest allowed.
        penetrated = smaller < sizes[rows]
        rows = rows[penetrated]
        sizes[rows] = smaller[penetrated]
        heights[rows] = cast_heights(caster, poses[rows], sizes[rows], lifts[rows], resolution)
