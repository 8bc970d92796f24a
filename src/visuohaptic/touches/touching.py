"""Touching an object with the sensor at every probing location."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import pyarrow as pa

from visuohaptic.base.arrays import IntArray
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.subject import Subject
from visuohaptic.scene.effect_log import effect_table
from visuohaptic.scene.parameters import Mode, Scene
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.placing import Placed
from visuohaptic.sensor.random_fields import RandomFields
from visuohaptic.sensor.touching import Touches, feel, place_sensors
from visuohaptic.tables.phases import (
    EFFECTS,
    FIXATIONS,
    NORMAL_NAMES,
    POINT_NAMES,
    TANGENT_NAMES,
    TOUCHES,
    key_of,
)
from visuohaptic.tables.schema import build_table, matrix
from visuohaptic.touches.choosing import Wanted, choose_places


def touch_locations(
    caster: RayCaster, fixations: pa.Table, sensor: SensorParameters, scene: Scene, seed: int
) -> Touches:
    """Touch an object at n rows of `tables.FIXATIONS`; each touch depends on its own row alone."""
    placed = place_at(caster, fixations, sensor, scene.effects.adaptive_size)
    return feel(placed, sensor, scene, random_fields(fixations, seed))


def place_at(
    caster: RayCaster, fixations: pa.Table, sensor: SensorParameters, mode: Mode
) -> Iterator[Placed]:
    """Place sensors at rows of `tables.FIXATIONS`, batch by batch; `mode` says when their size adapts."""
    points, normals = matrix(fixations, POINT_NAMES), matrix(fixations, NORMAL_NAMES)
    faces = fixations.column("face").to_numpy()
    return place_sensors(caster, points, normals, sensor, mode, faces)


def random_fields(fixations: pa.Table, seed: int) -> RandomFields:
    """Give the random numbers of touches at rows of `tables.FIXATIONS`."""
    names = ["chance" if name == "strategy" else name for name in FIXATIONS.keys]
    keys = [fixations.column(name).to_pylist() for name in names]
    return RandomFields(seed, list(zip(*keys, strict=True)))


class Touched(NamedTuple):
    """The tables of the second phase."""

    touches: pa.Table
    effects: pa.Table


def acquire_touches(
    subject: Subject,
    fixations: pa.Table,
    sensor: SensorParameters,
    scene: Scene,
    seed: int,
    wanted: Wanted,
) -> Touched:
    """Touch an object at those of its probing locations that `choose_places` gives."""
    places, ranks = choose_places(subject.caster, fixations, sensor, wanted)
    return touch_tables(subject.caster, places, sensor, scene, seed, ranks)


def touch_tables(
    caster: RayCaster,
    fixations: pa.Table,
    sensor: SensorParameters,
    scene: Scene,
    seed: int,
    ranks: IntArray | None = None,
) -> Touched:
    """Touch an object at its probing locations, if there are any, as `touch_locations` does.

    Gives n rows of `tables.TOUCHES`, in the order of `fixations`, and of `tables.EFFECTS` one for each
    effect. `ranks`, shape (n,), are their places among the view's; without them these are as column
    ``touch`` says.
    """
    if not fixations.num_rows:
        return Touched(TOUCHES.arrow.empty_table(), EFFECTS.arrow.empty_table())
    felt = touch_locations(caster, fixations, sensor, scene, seed)
    first = fixations.slice(0, 1).to_pylist()[0]
    log = effect_table(key_of(first), first["viewpoint"], scene.preset, felt.effects)
    numbers = fixations.column("touch").to_numpy() if ranks is None else ranks
    return Touched(_touch_table(fixations, felt, numbers), log)


def _touch_table(fixations: pa.Table, felt: Touches, ranks: IntArray) -> pa.Table:
    columns: dict[str, object] = {
        name: fixations.column(name) for name in (*TOUCHES.keys, *POINT_NAMES)
    }
    columns |= dict(zip(NORMAL_NAMES, felt.normals.T, strict=True))
    columns |= dict(zip(TANGENT_NAMES, felt.tangents.T, strict=True))
    columns |= {
        "image": felt.images,
        "sensor_size": felt.size,
        "contact_state": felt.contact_state.tolist(),
        "penetration": felt.penetration,
        "rank": ranks,
    }
    return build_table(TOUCHES, columns)
