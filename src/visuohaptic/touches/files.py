"""From probing locations to the touch table."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pyarrow as pa

from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import read_surface
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.tables.phases import EFFECTS, FIXATIONS, TOUCHES, by_object
from visuohaptic.tables.schema import read_table, write_table
from visuohaptic.touches.choosing import Wanted
from visuohaptic.touches.touching import acquire_touches


def make_touches(
    meshes: Mapping[str, str | Path],
    fixations: str | Path,
    touches: str | Path,
    effects: str | Path,
    sensor: SensorParameters,
    scene: Scene,
    seed: int,
    wanted: Wanted,
) -> None:
    """Make the touch table and the effect log of some objects, by `class/name`, from their probing locations."""
    felt, logs = [TOUCHES.arrow.empty_table()], [EFFECTS.arrow.empty_table()]
    for key, located in by_object(read_table(FIXATIONS, fixations)):
        caster = RayCaster(read_surface(meshes[key]))
        touched, log = acquire_touches(caster, located, sensor, scene, seed, wanted)
        felt.append(touched)
        logs.append(log)
    write_table(TOUCHES, pa.concat_tables(felt), touches)
    write_table(EFFECTS, pa.concat_tables(logs), effects)
