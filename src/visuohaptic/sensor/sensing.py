"""Touches of an object at many locations: geometry, then the effects that the scene needs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.scene.parameters import Mode, Scene
from visuohaptic.scene.records import EffectRecord, merge_records
from visuohaptic.sensor.effect_pipeline import TouchBatch
from visuohaptic.sensor.effects import simulate
from visuohaptic.sensor.frames import touched_normals
from visuohaptic.sensor.imprints import Poses, make_poses, smooth_normals
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.placing import CLEARANCE, PENETRATION_TOLERANCE, Placed, place_batch
from visuohaptic.sensor.random_fields import RandomFields

TOUCHES_AT_A_TIME = 256
"""Touches per batch, which bounds the memory of intermediate arrays."""

# A thousandth of the default depth range, far above rounding. Our choice.
FLATNESS = 1e-4
"""Least relief, object radii, that `per_imprint` stretches to [0, 1], so that a flat contact stays flat."""


@dataclass(frozen=True)
class Touches:
    """Results of n touches; r is the sensor's resolution, lengths are in object radii.

    Attributes
    ----------
    images : ndarray of shape (n, r, r), float32
        Imprints, 0 to 1. 1 is contact with the sensor's plane (with a cover: full scale), 0 is out of the depth range
        (no pressure). With `per_imprint` the nearest point of each imprint is 1 and the farthest 0.
    size : ndarray of shape (n,)
        Edges of the squares.
    contact_state : ndarray of shape (n,), str
        Values of `tables.CONTACT_STATES`.
    penetration : ndarray of shape (n,)
        Height of the object above the tangent plane within the square.
    normals, tangents : ndarray of shape (n, 3)
        The sensor's outward unit normal and its +column axis, object frame.
    gaps : ndarray of shape (n, r, r)
        Distance down to the object from the sensor's plane, which rests on the highest point within the square.
        Infinite without a hit, negative only for parts above the clearance.
    effects : tuple of EffectRecord
        One record per effect.
    """

    images: NDArray[np.float32]
    size: FloatArray
    contact_state: NDArray[np.str_]
    penetration: FloatArray
    normals: FloatArray
    tangents: FloatArray
    gaps: FloatArray
    effects: tuple[EffectRecord, ...]


def touch(
    caster: RayCaster,
    points: FloatArray,
    normals: FloatArray,
    parameters: SensorParameters,
    scene: Scene,
    fields: RandomFields | None = None,
    faces: IntArray | None = None,
) -> Touches:
    """Touch an object at n locations; each touch is independent of the others, bit for bit.

    Parameters
    ----------
    caster : RayCaster
        The object's surface, prepared for rays.
    points, normals : ndarray of shape (n, 3)
        Probing locations and outward unit normals, object frame.
    parameters : SensorParameters
        The sensor.
    scene : Scene
        The simulated effects.
    fields : RandomFields, optional
        Source of random numbers, for scenes with scattered gains, dead cells or noise.
    faces : ndarray of shape (n,), int64, optional
        Faces under the locations. If `parameters.normal` is ``face``, the sensor takes their normals; without `faces`
        it takes `normals`.

    Returns
    -------
    Touches
        The touches.

    Raises
    ------
    ParameterError
        If an effect needs random numbers and `fields` is missing.
    """
    mode = scene.effects.adaptive_size
    placed = place_sensors(caster, points, normals, parameters, mode, faces)
    return sense(placed, parameters, scene, fields)


def place_sensors(
    caster: RayCaster,
    points: FloatArray,
    normals: FloatArray,
    parameters: SensorParameters,
    mode: Mode,
    faces: IntArray | None = None,
) -> Iterator[Placed]:
    """Place sensors and yield them in batches; `mode` is that of `adaptive_size`, the rest as for `touch`."""
    poses = sensor_poses(caster, points, normals, parameters, faces)
    for rows in batches(len(points)):
        yield place_batch(caster, poses[rows], parameters, mode)


def sense(
    placed: Iterable[Placed],
    parameters: SensorParameters,
    scene: Scene,
    fields: RandomFields | None = None,
) -> Touches:
    """Compute the touches of placed sensors; the scene needs the `adaptive_size` mode of the placement."""
    parts, start = [], 0
    for batch in placed:
        rows = np.arange(start, start + len(batch.poses))
        batch_fields = None if fields is None else fields.select(rows)
        parts.append(_sense_batch(batch, parameters, scene, batch_fields))
        start += len(rows)
    return join_touches(parts)


def sensor_poses(
    caster: RayCaster,
    points: FloatArray,
    normals: FloatArray,
    parameters: SensorParameters,
    faces: IntArray | None = None,
) -> Poses:
    """Return the poses of n sensors with the normal and orientation of the parameters; arguments as for `touch`."""
    if parameters.normal == "face" and faces is not None:
        normals = touched_normals(caster, normals, faces)
    poses = make_poses(points, normals, parameters.orientation)
    if parameters.normal != "smoothed":
        return poses
    size = parameters.largest_size
    smooth = [smooth_normals(caster, poses[rows], size, CLEARANCE) for rows in batches(len(poses))]
    return make_poses(points, np.concatenate(smooth), parameters.orientation)


def batches(count: int) -> list[NDArray[np.intp]]:
    """Divide the indices of `count` touches into batches of `TOUCHES_AT_A_TIME`."""
    return np.split(np.arange(count), range(TOUCHES_AT_A_TIME, count, TOUCHES_AT_A_TIME))


def join_touches(parts: Sequence[Touches]) -> Touches:
    """Concatenate batches of touches in the same scene and sum their records; at least one batch is needed."""
    arrays = {
        field.name: np.concatenate([getattr(part, field.name) for part in parts])
        for field in fields(Touches)
        if field.name != "effects"
    }
    return Touches(**arrays, effects=merge_records([part.effects for part in parts]))


def contact_states(
    heights: FloatArray, sizes: FloatArray, blocked: BoolArray, parameters: SensorParameters
) -> NDArray[np.str_]:
    """Return the state (n,) of each touch, a value of `tables.CONTACT_STATES`: the first of these that holds.

    - ``blocked``: another part of the object obstructs the approach.
    - ``at_minimum``: the object penetrates the smallest square.
    - ``partial``: within the square a part of the object is missing, or more than the depth range below the tangent
      plane.
    - ``shrunk``: the square is smaller than the largest square.
    - ``full``: the largest square.

    `heights` (n, r, r), above the tangent plane, and `sizes` (n,) are in object radii.
    """
    penetrating = (heights > PENETRATION_TOLERANCE).any(axis=(1, 2))
    partial = (heights < -parameters.depth_range).any(axis=(1, 2))
    return np.select(
        [blocked, penetrating, partial, sizes < parameters.largest_size],
        ["blocked", "at_minimum", "partial", "shrunk"],
        default="full",
    )


def _sense_batch(
    placed: Placed, parameters: SensorParameters, scene: Scene, fields: RandomFields | None
) -> Touches:
    states = contact_states(placed.heights, placed.sizes, placed.blocked, parameters)
    highest = placed.heights.max(axis=(1, 2))
    # A rigid plane rests on the highest point within the square, which is at least as high as the probed point.
    resting = np.clip(highest, 0.0, CLEARANCE)
    gaps = resting[:, None, None] - placed.heights
    contact = 1.0 - np.clip(gaps / parameters.depth_range, 0.0, 1.0)
    batch = TouchBatch(
        scene,
        scene.object_radius_m * np.maximum(gaps, 0.0),
        scene.object_radius_m * placed.sizes / parameters.resolution,
        fields,
    )
    readings, records = simulate(batch, contact)
    if parameters.normalisation == "per_imprint":
        readings = stretch(readings, FLATNESS / parameters.depth_range)
    return Touches(
        readings.astype(np.float32),
        placed.sizes,
        states,
        np.maximum(highest, 0.0),
        placed.poses.normals,
        placed.poses.columns,
        gaps,
        (placed.record, *records),
    )


def stretch(readings: FloatArray, least_span: float) -> FloatArray:
    """Stretch each image (n, r, r) to [0, 1]; images with a smaller span than `least_span` are stretched less."""
    peak = readings.max(axis=(1, 2), keepdims=True)
    span = np.maximum(peak - readings.min(axis=(1, 2), keepdims=True), least_span)
    return np.where(peak > 0, np.clip(1.0 - (peak - readings) / span, 0.0, 1.0), 0.0)
