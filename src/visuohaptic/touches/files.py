"""From probing locations to the touch table."""

from __future__ import annotations

from pathlib import Path

from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import read_surface
from visuohaptic.scene.effect_log import effect_table
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.tables.phases import EFFECTS, FIXATIONS, TOUCHES
from visuohaptic.tables.schema import read_table, write_table
from visuohaptic.touches.touching import touch_locations, touch_table


def make_touches(
    mesh: str | Path,
    fixations: str | Path,
    touches: str | Path,
    effects: str | Path,
    sensor: SensorParameters,
    scene: Scene,
    seed: int,
) -> None:
    """Make the touch table and the effect log of an object from its probing locations."""
    table = read_table(FIXATIONS, fixations)
    if not table.num_rows:
        write_table(TOUCHES, TOUCHES.arrow.empty_table(), touches)
        write_table(EFFECTS, EFFECTS.arrow.empty_table(), effects)
        return
    felt = touch_locations(RayCaster(read_surface(mesh)), table, sensor, scene, seed)
    first = table.slice(0, 1).to_pylist()[0]
    key = f"{first['class']}/{first['object']}"
    log = effect_table(key, first["viewpoint"], scene.preset, felt.effects)
    write_table(TOUCHES, touch_table(table, felt), touches)
    write_table(EFFECTS, log, effects)
