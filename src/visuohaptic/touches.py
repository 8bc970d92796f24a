"""The hand's part: the sensor is set down at every probing location of an object."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pyarrow as pa

from visuohaptic.raycasting import RayCaster
from visuohaptic.scene import Scene
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.planner import EffectRecord
from visuohaptic.sensor.random_fields import RandomFields
from visuohaptic.sensor.touching import Touches, touch
from visuohaptic.surface import read_surface
from visuohaptic.tables import (
    EFFECTS,
    FIXATIONS,
    TOUCHES,
    build_table,
    matrix,
    read_table,
    write_table,
)

_POINT = ("x", "y", "z")
_NORMAL = ("normal_x", "normal_y", "normal_z")
_TANGENT = ("tangent_x", "tangent_y", "tangent_z")


def make_touches(
    mesh: str | Path,
    fixations: str | Path,
    touches: str | Path,
    effects: str | Path,
    sensor: SensorParameters,
    scene: Scene,
    seed: int,
) -> None:
    """Make the touch table of an object's probing locations, and the books of the effects.

    Parameters
    ----------
    mesh : path
        The object's surface.
    fixations : path
        Its probing locations.
    touches, effects : path
        The Parquet files to write.
    sensor : SensorParameters
        Section `sensor`.
    scene : Scene
        Section `scene`.
    seed : int
        The experiment's seed.
    """
    table = read_table(FIXATIONS, fixations)
    keys = [table.column(name).to_pylist() for name in FIXATIONS.keys]
    felt = touch(
        RayCaster(read_surface(mesh)),
        matrix(table, _POINT),
        matrix(table, _NORMAL),
        sensor,
        scene,
        RandomFields(seed, list(zip(*keys, strict=True))),
        table.column("face").to_numpy(),
    )
    write_table(TOUCHES, _touch_table(table, felt), touches)
    write_table(EFFECTS, _effect_table(table, scene, felt.effects), effects)


def _touch_table(fixations: pa.Table, felt: Touches) -> pa.Table:
    columns: dict[str, object] = {name: fixations.column(name) for name in (*TOUCHES.keys, *_POINT)}
    columns |= dict(zip(_NORMAL, felt.normals.T, strict=True))
    columns |= dict(zip(_TANGENT, felt.tangents.T, strict=True))
    columns |= {
        "image": felt.images,
        "sensor_size": felt.size,
        "contact_state": felt.contact_state.tolist(),
        "penetration": felt.penetration,
    }
    return build_table(TOUCHES, columns)


def _effect_table(fixations: pa.Table, scene: Scene, records: Sequence[EffectRecord]) -> pa.Table:
    first = fixations.slice(0, 1).to_pylist()[0]
    names = ("effect", "mode", "reason", "touches", "called_for", "runs", "seconds")
    columns: dict[str, object] = {
        name: [getattr(record, name) for record in records] for name in names
    }
    columns |= {
        "class": first["class"],
        "object": first["object"],
        "first_viewpoint": first["viewpoint"],
        "scene": scene.preset,
    }
    return build_table(EFFECTS, columns)
