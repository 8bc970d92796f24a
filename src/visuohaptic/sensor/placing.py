"""Placing sensors on the object: obstacles of the approach, the size of the square, and the heights under it."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import BoolArray, FloatArray
from visuohaptic.base.bounded_loops import turns
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
"""Largest height of the object above the tangent plane, object radii, that is no penetration.

2 % of the default depth range. Our choice.
"""

CLEARANCE = 0.1
"""Height of the sensor's body above its plane, object radii. Our choice.

Under an obstacle, rays start at most this high above the tangent plane. Surfaces within the square that stand higher
block the touch.
"""


@dataclass(frozen=True)
class Placed:
    """Sensors that are placed on the object; lengths are in object radii.

    Attributes
    ----------
    poses : Poses
        Frames of the n sensors.
    heights : ndarray of shape (n, r, r)
        Heights of the surface above the tangent plane, negative below it, minus infinity without a hit. Under an
        obstacle the surface below the obstacle counts.
    sizes : ndarray of shape (n,)
        Edges of the squares.
    blocked : ndarray of shape (n,), bool
        Whether an obstacle is above the centre, or the surface within the square is higher than `CLEARANCE`.
    record : EffectRecord
        Record of effect ``adaptive_size``.
    """

    poses: Poses
    heights: FloatArray
    sizes: FloatArray
    blocked: BoolArray
    record: EffectRecord


def place_batch(
    caster: RayCaster, poses: Poses, parameters: SensorParameters, mode: Mode
) -> Placed:
    """Place sensors on the object and measure the surface under them; each placement depends only on its own pose.

    A square whose size adapts is as large as the object allows, from `parameters.smallest_size` to
    `parameters.largest_size`: no height within the square exceeds `PENETRATION_TOLERANCE`. The smallest square is
    taken even if the object penetrates it. A square whose size does not adapt has the largest size.

    An adaptive size has two steps. First, rays parallel to the tangent plane find walls, even walls without thickness.
    Then the measured heights find surfaces above these rays, such as overhangs.

    Heights are measured by rays from outside the object. If an obstacle is above the sensor's centre, the rays start
    below this obstacle, at most `CLEARANCE` above the tangent plane.

    Parameters
    ----------
    caster : RayCaster
        The object's surface, prepared for rays.
    poses : Poses
        Frames of the sensors.
    parameters : SensorParameters
        Resolution, and the smallest and largest size.
    mode : {"auto", "always", "never"}
        When the size adapts: ``auto`` only where the object's bounding box reaches above the tangent plane. Sizes
        and heights are the same as with ``always``.

    Returns
    -------
    Placed
        The poses, heights and sizes of the sensors, whether they are blocked, and the record of the effect.
    """
    tolerance, resolution = PENETRATION_TOLERANCE, parameters.resolution
    obstacles = approach_distances(caster, poses, tolerance)
    obstructed = np.isfinite(obstacles)
    under_obstacle = np.minimum(CLEARANCE, 0.5 * (tolerance + obstacles))
    lifts = np.where(obstructed, under_obstacle, caster.reach)
    sizes = np.full(len(poses), parameters.largest_size)

    started = time.process_time()
    # The limit is half the tolerance: below it no surface exceeds the tolerance, even after rounding. So `auto`
    # gives the same bits as `always`.
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
    _shrink_by_heights(caster, poses, parameters, lifts, rows, sizes, heights)
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


def _shrink_by_heights(
    caster: RayCaster,
    poses: Poses,
    parameters: SensorParameters,
    lifts: FloatArray,
    rows: NDArray[np.intp],
    sizes: FloatArray,
    heights: FloatArray,
) -> None:
    """Shrink squares `rows` in place until no height exceeds the tolerance, or to the smallest size."""
    tolerance, resolution = PENETRATION_TOLERANCE, parameters.resolution
    # The outermost sensing points are half a cell inside the edges, so a pass shrinks a square at least by the factor
    # 1 - 1 / resolution. The last pass finds that no square shrinks.
    ratio = parameters.largest_size / parameters.smallest_size
    passes = math.ceil(math.log(ratio) / -math.log1p(-1 / resolution)) + 2
    for _ in turns(passes, "the shrinking of squares"):
        if not len(rows):
            return
        free = unobstructed_half_sizes(heights[rows], sizes[rows], tolerance)
        smaller = admissible_sizes(free, parameters.smallest_size, parameters.largest_size)
        shrinks = smaller < sizes[rows]
        rows = rows[shrinks]
        sizes[rows] = smaller[shrinks]
        heights[rows] = cast_heights(caster, poses[rows], sizes[rows], lifts[rows], resolution)
