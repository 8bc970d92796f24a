"""Touches at rows of `tables.FIXATIONS`, as rows of `tables.TOUCHES`."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import pyarrow as pa

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.geometry.layouts import Layout
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.scene.parameters import Mode, Scene
from visuohaptic.scene.records import EffectRecord
from visuohaptic.sensor.frames import row_axes
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.placing import Placed
from visuohaptic.sensor.random_fields import RandomFields
from visuohaptic.sensor.sensing import Touches, place_sensors, sense
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
    """Touch an object at n rows of `tables.FIXATIONS`; each touch depends only on its own row."""
    placed = place_sensors_at(caster, fixations, sensor, scene.effects.adaptive_size)
    return sense(placed, sensor, scene, random_fields(fixations, seed))


def place_sensors_at(
    caster: RayCaster, fixations: pa.Table, sensor: SensorParameters, mode: Mode
) -> Iterator[Placed]:
    """Place sensors at rows of `tables.FIXATIONS`, and yield them in batches; `mode` is that of `adaptive_size`."""
    points, normals = matrix(fixations, POINT_NAMES), matrix(fixations, NORMAL_NAMES)
    faces = fixations.column("face").to_numpy()
    return place_sensors(caster, points, normals, sensor, mode, faces)


def random_fields(fixations: pa.Table, seed: int) -> RandomFields:
    """Return the random numbers of touches at rows of `tables.FIXATIONS`.

    The keys are the keys of the rows, with column ``random_stream`` in place of ``strategy``.
    """
    names = ["random_stream" if name == "strategy" else name for name in FIXATIONS.keys]
    keys = [fixations.column(name).to_pylist() for name in names]
    return RandomFields(seed, list(zip(*keys, strict=True)))


class Part(NamedTuple):
    """Touches, rows of `tables.TOUCHES`, and one record per effect; without touches no records."""

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
    """Touch an object at n rows of `tables.FIXATIONS` and return the touches in the same order; n may be 0.

    `ranks` (n,) become column ``rank``: the index of each location among all locations of its view. By default they
    are column ``touch`` of `fixations`.
    """
    if not fixations.num_rows:
        return Part(TOUCHES.arrow.empty_table(), ())
    felt = touch_locations(caster, fixations, sensor, scene, seed)
    if ranks is None:
        ranks = fixations.column("touch").to_numpy()
    return Part(touch_table(fixations, felt, ranks), felt.effects)


def touch_outlines(touches: pa.Table, layout: Layout) -> FloatArray:
    """Compute the outlines (n, k, 3) of the pads, object frame, from rows of `tables.TOUCHES`: 4 corners of a square."""
    points, columns = matrix(touches, POINT_NAMES), matrix(touches, TANGENT_NAMES)
    half = 0.5 * touches.column("sensor_size").to_numpy()[:, None]
    across, down = half * columns, half * row_axes(matrix(touches, NORMAL_NAMES), columns)
    return np.stack([points + a * across + b * down for a, b in layout.corners], axis=1)


def touch_table(fixations: pa.Table, felt: Touches, ranks: IntArray) -> pa.Table:
    """Return n touches at n rows of `tables.FIXATIONS` as rows of `tables.TOUCHES`; `ranks` as for `touch_part`."""
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
