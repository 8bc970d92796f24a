"""Placing sensors on the object: obstacles of the approach, the size of the pad, and the heights under it."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import BoolArray, FloatArray
from visuohaptic.base.bounded_loops import turns
from visuohaptic.geometry.layouts import Layout
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

HALVINGS = 6
"""Steps of the search for the size of a pad that is not flat. Our choice: 1/64 of the difference that the pad shrank."""


@dataclass(frozen=True)
class Placed:
    """Sensors that are placed on the object; lengths are in object radii.

    Attributes
    ----------
    poses : Poses
        Frames of the n sensors.
    highest : ndarray of shape (n,)
        Largest height of the surface above the points that the approach checks, along the normal, for the pad at the
        touched point. Under an obstacle the surface below the obstacle counts.
    heights : ndarray of shape (n, *layout.shape)
        Heights of the surface above the taxels, against their directions: negative for a gap, minus infinity without a
        hit. A flat pad is at the touched point, every other pad where it rests.
    gaps : ndarray of shape (n, *layout.shape)
        Distances from the taxels of the resting pad to the surface, along their directions.
    sizes : ndarray of shape (n,)
        Widths of the pads.
    blocked : ndarray of shape (n,), bool
        Whether an obstacle is above the centre, or `highest` exceeds `CLEARANCE`.
    record : EffectRecord
        Record of effect ``adaptive_size``.
    """

    poses: Poses
    highest: FloatArray
    heights: FloatArray
    gaps: FloatArray
    sizes: FloatArray
    blocked: BoolArray
    record: EffectRecord


def place_batch(
    caster: RayCaster, poses: Poses, parameters: SensorParameters, mode: Mode
) -> Placed:
    """Place sensors on the object and measure the surface under them; each placement depends only on its own pose.

    A pad whose size adapts is as large as the object allows, from `parameters.smallest_size` to
    `parameters.largest_size`: no height above its points exceeds `PENETRATION_TOLERANCE`. The smallest pad is
    taken even if the object penetrates it. A pad whose size does not adapt has the largest size.

    An adaptive size has two steps. First, for flat pads, rays parallel to the tangent plane find walls, even walls without
    thickness. Then the measured heights find surfaces above these rays, such as overhangs.

    A pad that is not flat bends more at a smaller size, so that the second step shrinks the pad too far. Its size is then
    searched between the last size that penetrates and the admissible size, in `HALVINGS` steps.

    The pad moves along its axis until its first point meets the surface, at most down to the probed point. The points are
    the taxels, and in pads that are not flat also points between neighbouring taxels (`Layout.approach`).

    Heights are measured by rays from outside the object. If an obstacle is above the sensor's centre, the rays start
    below this obstacle, at most `CLEARANCE` above the tangent plane.

    Parameters
    ----------
    caster : RayCaster
        The object's surface, prepared for rays.
    poses : Poses
        Frames of the sensors.
    parameters : SensorParameters
        Layout, and the smallest and largest size.
    mode : {"auto", "always", "never"}
        When the size adapts: ``auto`` only where the object's bounding box reaches above the tangent plane. Sizes
        and heights are the same as with ``always``.

    Returns
    -------
    Placed
        The poses, heights and sizes of the sensors, whether they are blocked, and the record of the effect.
    """
    tolerance, layout = PENETRATION_TOLERANCE, parameters.taxels
    obstacles = approach_distances(caster, poses, tolerance)
    obstructed = np.isfinite(obstacles)
    under_obstacle = np.minimum(CLEARANCE, 0.5 * (tolerance + obstacles))
    lifts = np.where(obstructed, under_obstacle, caster.reach)
    sizes = np.full(len(poses), parameters.largest_size)

    started = time.process_time()
    # The limit is half the tolerance: below it no surface exceeds the tolerance, even after rounding. So `auto`
    # gives the same bits as `always`.
    lowest = 0.5 * parameters.largest_size * layout.lowest
    needing = box_heights(caster, poses) > 0.5 * tolerance + lowest
    adapting = needing if mode == "auto" else np.full(len(poses), mode == "always")
    rows = np.flatnonzero(adapting)
    sizes[rows] = admissible_sizes(
        free_half_sizes(caster, poses[rows], tolerance, layout),
        parameters.smallest_size,
        parameters.largest_size,
    )
    sizing = time.process_time() - started

    above = cast_heights(caster, poses, sizes, lifts, layout.approach)
    started = time.process_time()
    tried = sizes.copy()
    _shrink_by_heights(caster, poses, parameters, lifts, rows, sizes, above)
    if not layout.is_flat:
        rows = np.flatnonzero((sizes < tried) & _is_admissible(above))
        _grow_back(caster, poses, layout, lifts, rows, tried, sizes, above)
    sizing += time.process_time() - started

    highest = above.reshape(-1, len(layout.approach)).max(axis=1)
    # A rigid pad rests where its first point meets the surface, at least as high as the probed point.
    resting = np.clip(highest, 0.0, CLEARANCE)
    if layout.is_flat:
        # The rays of the approach are those of the taxels.
        heights = above
        gaps = resting.reshape(-1, *[1] * len(layout.shape)) - heights
    else:
        raised = replace(poses, points=poses.points + resting[:, None] * poses.normals)
        # The approach keeps the taxels out of the object, so that rays start within the sensor's body.
        heights = cast_heights(caster, raised, sizes, np.minimum(lifts, CLEARANCE), layout)
        gaps = -heights
    record = EffectRecord(
        "adaptive_size",
        mode,
        "where the object's bounding box reaches above the tangent plane",
        len(poses),
        int(needing.sum()),
        int(adapting.sum()),
        sizing,
    )
    return Placed(poses, highest, heights, gaps, sizes, obstructed | (highest > CLEARANCE), record)


def _shrink_by_heights(
    caster: RayCaster,
    poses: Poses,
    parameters: SensorParameters,
    lifts: FloatArray,
    rows: NDArray[np.intp],
    sizes: FloatArray,
    above: FloatArray,
) -> None:
    """Shrink pads `rows` in place until no height `above` exceeds the tolerance, or to the smallest size."""
    tolerance, points = PENETRATION_TOLERANCE, parameters.taxels.approach
    # A pass shrinks a pad to the norm of one of its points, and all norms are below 1: the outermost sensing points of
    # a square are half a cell inside its edges. The last pass finds that no pad shrinks.
    ratio = parameters.largest_size / parameters.smallest_size
    passes = math.ceil(math.log(ratio) / -math.log(points.norms.max())) + 2
    for _ in turns(passes, "the shrinking of pads"):
        if not len(rows):
            return
        free = unobstructed_half_sizes(above[rows], sizes[rows], tolerance, points)
        smaller = admissible_sizes(free, parameters.smallest_size, parameters.largest_size)
        shrinks = smaller < sizes[rows]
        rows = rows[shrinks]
        sizes[rows] = smaller[shrinks]
        above[rows] = cast_heights(caster, poses[rows], sizes[rows], lifts[rows], points)


def _grow_back(
    caster: RayCaster,
    poses: Poses,
    layout: Layout,
    lifts: FloatArray,
    rows: NDArray[np.intp],
    tried: FloatArray,
    sizes: FloatArray,
    above: FloatArray,
) -> None:
    """Grow admissible pads `rows` in place towards their sizes `tried`, which are not admissible, by halving."""
    upper = tried[rows]
    for _ in range(HALVINGS):
        middle = 0.5 * (sizes[rows] + upper)
        heights = cast_heights(caster, poses[rows], middle, lifts[rows], layout.approach)
        fits = _is_admissible(heights)
        sizes[rows[fits]], above[rows[fits]] = middle[fits], heights[fits]
        upper = np.where(fits, upper, middle)


def _is_admissible(heights: FloatArray) -> BoolArray:
    """Return whether no height of each pad, (n, …), exceeds the tolerance."""
    fits: BoolArray = np.all(heights <= PENETRATION_TOLERANCE, axis=tuple(range(1, heights.ndim)))
    return fits
