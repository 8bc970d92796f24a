"""Touching an object at many places: geometry, then the effects that the scene needs."""

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
from visuohaptic.sensor.imprints import Poses, smooth_normals, stand_on
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.placing import CLEARANCE, PENETRATION_TOLERANCE, Placed, place
from visuohaptic.sensor.random_fields import RandomFields

# Bounds the memory: intermediate arrays live for so many touches at a time.
TOUCHES_AT_A_TIME = 256
# Relief, object radii, below which `per_imprint` stretches no further, so that a flat contact stays flat: a thousandth
# of the default depth range, far above rounding. Our choice.
FLATNESS = 1e-4


@dataclass(frozen=True)
class Touches:
    """What n touches gave; r is the sensor's resolution, lengths are in object radii.

    `images` (n, r, r) are in [0, 1]: 1 is contact with the sensor's plane (with a cover: full scale), 0
    out of the depth range (no pressure); `per_imprint` makes the nearest point of each 1 and its
    farthest 0. `size` (n,) are the squares' edges, `contact_state` (n,) is of `tables.CONTACT_STATES`,
    and `penetration` (n,) how high the object still stands above the tangent plane within the square.
    `normals` and `tangents` (n, 3) are the sensor's outward normal and its +column axis. `gaps`
    (n, r, r) are from the sensor's plane, resting on the highest point within the square, down to the
    object: infinite where nothing is met, negative only for what stands above the clearance.
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
    """Touch an object at n places, each independent of what else is in the batch, bit for bit.

    Probing locations and their outward unit normals are (n, 3), object frame. Without `fields`
    `ParameterError` is raised where the scene has scattered gains, dead cells or noise. `faces` (n,)
    lie under the locations, for the normal `face`; without them the given normals are taken.
    """
    mode = scene.effects.adaptive_size
    return feel(
        place_sensors(caster, points, normals, parameters, mode, faces), parameters, scene, fields
    )


def place_sensors(
    caster: RayCaster,
    points: FloatArray,
    normals: FloatArray,
    parameters: SensorParameters,
    mode: Mode,
    faces: IntArray | None = None,
) -> Iterator[Placed]:
    """Place sensors as `touch` does, batch by batch; of the scene only the mode of the adaptive size counts."""
    poses = stand(caster, points, normals, parameters, faces)
    for rows in batches(len(points)):
        yield place(caster, poses[rows], parameters, mode)


def feel(
    placed: Iterable[Placed],
    parameters: SensorParameters,
    scene: Scene,
    fields: RandomFields | None = None,
) -> Touches:
    """Give what placed sensors feel in a scene whose mode of the adaptive size they were placed by."""
    parts, start = [], 0
    for one in placed:
        rows = np.arange(start, start + len(one.poses))
        own = None if fields is None else fields.select(rows)
        parts.append(_feel_batch(one, parameters, scene, own))
        start += len(rows)
    return join_touches(parts)


def stand(
    caster: RayCaster,
    points: FloatArray,
    normals: FloatArray,
    parameters: SensorParameters,
    faces: IntArray | None = None,
) -> Poses:
    """Place n sensors on an object as `touch` does, with the normal that the parameters ask for."""
    if parameters.normal == "face" and faces is not None:
        normals = touched_normals(caster, normals, faces)
    poses = stand_on(points, normals, parameters.orientation)
    if parameters.normal != "smoothed":
        return poses
    size = parameters.largest_size
    smooth = [smooth_normals(caster, poses[rows], size, CLEARANCE) for rows in batches(len(poses))]
    return stand_on(points, np.concatenate(smooth), parameters.orientation)


def batches(count: int) -> list[NDArray[np.intp]]:
    """Divide touches, by their numbers, into parts that fit into memory."""
    return np.split(np.arange(count), range(TOUCHES_AT_A_TIME, count, TOUCHES_AT_A_TIME))


def join_touches(parts: Sequence[Touches]) -> Touches:
    """Join the touches of at least one batch in one scene, and add up their effect records."""
    arrays = {
        field.name: np.concatenate([getattr(part, field.name) for part in parts])
        for field in fields(Touches)
        if field.name != "effects"
    }
    return Touches(**arrays, effects=merge_records([part.effects for part in parts]))


def contact_states(
    heights: FloatArray, sizes: FloatArray, blocked: BoolArray, parameters: SensorParameters
) -> NDArray[np.str_]:
    """Name the state (n,) of each touch, of `tables.CONTACT_STATES`: the first of these that holds.

    ``blocked``: something else of the object is in the way of the approaching sensor.
    ``at_minimum``: the object still penetrates, and the sensor may shrink no further. ``partial``:
    part of the sensor meets nothing within its depth range. ``shrunk``: smaller than the largest
    square. ``full``: the largest square. Heights (n, r, r), above the tangent plane, and sizes (n,)
    are in object radii.
    """
    penetrating = (heights > PENETRATION_TOLERANCE).any(axis=(1, 2))
    partial = (heights < -parameters.depth_range).any(axis=(1, 2))
    return np.select(
        [blocked, penetrating, partial, sizes < parameters.largest_size],
        ["blocked", "at_minimum", "partial", "shrunk"],
        default="full",
    )


def _feel_batch(
    placed: Placed, parameters: SensorParameters, scene: Scene, fields: RandomFields | None
) -> Touches:
    states = contact_states(placed.heights, placed.sizes, placed.blocked, parameters)
    highest = placed.heights.max(axis=(1, 2))
    # A rigid plane goes no deeper than the first thing it meets: the probed point itself, or
    # what stands higher within the square.
    resting = np.clip(highest, 0.0, CLEARANCE)
    gaps = resting[:, None, None] - placed.heights
    contact = 1.0 - np.clip(gaps / parameters.depth_range, 0.0, 1.0)
    batch = TouchBatch(
        scene,
        scene.object_radius_m * np.maximum(gaps, 0.0),
        scene.object_radius_m * placed.sizes / parameters.resolution,
        fields,
    )
    signal, records = simulate(batch, contact)
    if parameters.normalisation == "per_imprint":
        signal = stretch(signal, FLATNESS / parameters.depth_range)
    return Touches(
        signal.astype(np.float32),
        placed.sizes,
        states,
        np.maximum(highest, 0.0),
        placed.poses.normals,
        placed.poses.columns,
        gaps,
        (placed.record, *records),
    )


def stretch(signal: FloatArray, least_span: float) -> FloatArray:
    """Stretch each image (n, r, r) to [0, 1], one of a smaller span than the least only as far as that allows."""
    peak = signal.max(axis=(1, 2), keepdims=True)
    span = np.maximum(peak - signal.min(axis=(1, 2), keepdims=True), least_span)
    return np.where(peak > 0, np.clip(1.0 - (peak - signal) / span, 0.0, 1.0), 0.0)
