"""Touches of an object at many locations: geometry, then the effects that the scene needs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import FloatArray, IntArray
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
    """Results of n touches; lengths are in object radii.

    Attributes
    ----------
    images : ndarray of shape (n, *layout.shape), float32
        Imprints, 0 to 1: images (n, r, r) of the square, (n, taxels) of other layouts. 1 is contact with the pad (with a cover: full scale), 0 is out of the depth range
        (no pressure). With `per_imprint` the nearest point of each imprint is 1 and the farthest 0.
    size : ndarray of shape (n,)
        Widths of the pads: edges of the squares.
    contact_state : ndarray of shape (n,), str
        Values of `tables.CONTACT_STATES`.
    penetration : ndarray of shape (n,)
        Largest height of the object above the pad at the touched point, along the normal.
    normals, tangents : ndarray of shape (n, 3)
        The sensor's outward unit normal and its +column axis, object frame.
    gaps : ndarray of shape (n, *layout.shape)
        Distance from each taxel of the resting pad to the object, along the taxel's direction. Infinite without a hit.
        Negative for parts above the clearance, and in other pads than the square for parts between the checked points.
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


def contact_states(placed: Placed, parameters: SensorParameters) -> NDArray[np.str_]:
    """Return the state (n,) of each touch, a value of `tables.CONTACT_STATES`: the first of these that holds.

    - ``blocked``: another part of the object obstructs the approach.
    - ``at_minimum``: the object penetrates the smallest pad.
    - ``partial``: before a taxel a part of the object is missing, or lies farther than the depth range; for a flat pad
      below the tangent plane.
    - ``shrunk``: the pad is smaller than the largest pad.
    - ``full``: the largest pad.
    """
    penetrating = placed.highest > PENETRATION_TOLERANCE
    partial = (placed.heights < -parameters.depth_range).any(axis=_taxel_axes(placed.heights))
    return np.select(
        [placed.blocked, penetrating, partial, placed.sizes < parameters.largest_size],
        ["blocked", "at_minimum", "partial", "shrunk"],
        default="full",
    )


def _taxel_axes(values: FloatArray) -> tuple[int, ...]:
    return tuple(range(1, values.ndim))


def _sense_batch(
    placed: Placed, parameters: SensorParameters, scene: Scene, fields: RandomFields | None
) -> Touches:
    states = contact_states(placed, parameters)
    gaps = placed.gaps
    contact = 1.0 - np.clip(gaps / parameters.depth_range, 0.0, 1.0)
    batch = TouchBatch(
        scene,
        scene.object_radius_m * np.maximum(gaps, 0.0),
        scene.object_radius_m * placed.sizes / parameters.taxels.counts[1],
        fields,
    )
    readings, records = simulate(batch, contact)
    if parameters.normalisation == "per_imprint":
        readings = stretch(readings, FLATNESS / parameters.depth_range)
    return Touches(
        readings.astype(np.float32),
        placed.sizes,
        states,
        np.maximum(placed.highest, 0.0),
        placed.poses.normals,
        placed.poses.columns,
        gaps,
        (placed.record, *records),
    )


def stretch(readings: FloatArray, least_span: float) -> FloatArray:
    """Stretch each imprint (n, …) to [0, 1]; imprints with a smaller span than `least_span` are stretched less."""
    axes = _taxel_axes(readings)
    peak = readings.max(axis=axes, keepdims=True)
    span = np.maximum(peak - readings.min(axis=axes, keepdims=True), least_span)
    return np.where(peak > 0, np.clip(1.0 - (peak - readings) / span, 0.0, 1.0), 0.0)
