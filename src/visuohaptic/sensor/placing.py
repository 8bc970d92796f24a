"""Bringing the sensor to the object: its way in, its size, and how the object stands under it."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visuohaptic.raycasting import RayCaster
from visuohaptic.scene import Mode
from visuohaptic.sensor.adaptive_size import (
    admissible_sizes,
    approach_distances,
    free_half_sizes,
    unobstructed_half_sizes,
)
from visuohaptic.sensor.imprints import Poses, cast_heights
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.planner import EffectRecord


@dataclass(frozen=True)
class Placement:
    """How n sensors came to stand on the object.

    Attributes
    ----------
    heights : numpy.ndarray
        Shape (n, r, r), float64, object radii: the surface above the tangent plane.
    sizes : numpy.ndarray
        Shape (n,), float64, object radii: edge of each square.
    blocked : numpy.ndarray
        Shape (n,), bool: the way in is obstructed.
    record : EffectRecord
        What became of the adaptive size; deciding is part of its seconds.
    """

    heights: NDArray[np.float64]
    sizes: NDArray[np.float64]
    blocked: NDArray[np.bool_]
    record: EffectRecord


def place(caster: RayCaster, poses: Poses, parameters: SensorParameters, mode: Mode) -> Placement:
    """Bring sensors to the object, as large as it lets them be.

    The largest square is cast from beyond the object, so that whatever stands in the
    corridor of approach is met. Where the centre's own way is
    obstructed, the square is cast from within the sensor's clearance instead. Where nothing penetrates
    that cast is the imprint; else the largest admissible square follows in closed form and is cast.

    Parameters
    ----------
    caster : RayCaster
        The object.
    poses : Poses
        n sensors.
    parameters : SensorParameters
        The sensor's measures.
    mode : {"auto", "always", "never"}
        When the size adapts.

    Returns
    -------
    Placement
        Independent of what else is in the batch.
    """
    tolerance, resolution = parameters.penetration_tolerance, parameters.resolution
    way_out = approach_distances(caster, poses, tolerance)
    blocked = np.isfinite(way_out)
    under_obstacle = np.minimum(parameters.clearance, 0.5 * (tolerance + way_out))
    lifts = np.where(blocked, under_obstacle, caster.reach)
    sizes = np.full(len(poses), parameters.largest_size)
    heights = cast_heights(caster, poses, sizes, lifts, resolution)
    if mode == "never":
        return Placement(heights, sizes, blocked, _record(mode, len(poses), 0, 0, 0.0))

    started = time.perf_counter()
    free = np.minimum(
        free_half_sizes(caster, poses, tolerance),
        unobstructed_half_sizes(heights, sizes, tolerance),
    )
    shrinking = free < 0.5 * parameters.largest_size
    resized = shrinking if mode == "auto" else np.full(len(poses), fill_value=True)
    pending = np.flatnonzero(resized)
    while len(pending):
        sizes[pending] = admissible_sizes(
            free[pending], parameters.smallest_size, parameters.largest_size
        )
        cast = cast_heights(caster, poses[pending], sizes[pending], lifts[pending], resolution)
        heights[pending] = cast
        free[pending] = unobstructed_half_sizes(cast, sizes[pending], tolerance)
        # Finer sensing points can find what the wider ones fell beside.
        again = (2 * free[pending] < sizes[pending]) & (sizes[pending] > parameters.smallest_size)
        pending = pending[again]
    tall = (heights > parameters.clearance).any(axis=(1, 2))
    seconds = time.perf_counter() - started
    record = _record(mode, len(poses), int(shrinking.sum()), int(resized.sum()), seconds)
    return Placement(heights, sizes, blocked | tall, record)


def _record(mode: Mode, touches: int, called_for: int, runs: int, seconds: float) -> EffectRecord:
    reason = "the object stands above the tangent plane within the largest square"
    if mode == "never":
        reason = "the square stays at its largest"
    return EffectRecord("adaptive_size", mode, reason, touches, called_for, runs, seconds)
