"""Touching an object with the sensor at every probing location."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import pyarrow as pa

from visuohaptic.base.arrays import IntArray
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.scene.parameters import Mode, Scene
from visuohaptic.scene.records import EffectRecord
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.placing import Placed
from visuohaptic.sensor.random_fields import RandomFields
from visuohaptic.sensor.touching import Touches, feel, place_sensors
from visuohaptic.tables.phases import (
    FIXATIONS,
    NORMAL_NAMES,
    POINT_NAMES,
    TANGENT_NAMES,
    TOUCHES,
)
from visuohaptic.tables.schema import build_table, matrix


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


class Part(NamedTuple):
    """Touches, rows of `tables.TOUCHES`, and the record of each effect; no records if there are no touches."""

    touches: pa.Table
    effects: tuple[EffectRecord, ...]


def touch_part(
    caster: RayCaster,
    fixations: pa.Table,
    sensor: SensorParameters,
    scene: Scene,
    seed: int,
    ranks: IntArray | None = None,
) -> Part:
    """Touch an object at n rows of `tables.FIXATIONS`, if there are any, as `touch_locations` does.

    The touches are in the order of `fixations`. `ranks`, shape (n,), are their places among the view's;
    without them these are as column ``touch`` says.
    """
    if not fixations.num_rows:
        return Part(TOUCHES.arrow.empty_table(), ())
    felt = touch_locations(caster, fixations, sensor, scene, seed)
    numbers = fixations.column("touch").to_numpy() if ranks is None else ranks
    return Part(touch_table(fixations, felt, numbers), felt.effects)


def touch_table(fixations: pa.Table, felt: Touches, ranks: IntArray) -> pa.Table:
    """Give touches at n rows of `tables.FIXATIONS`, whose places among the view's are `ranks` (n,): `tables.TOUCHES`."""
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
