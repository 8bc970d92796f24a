"""From probing locations to the touch table."""

from __future__ import annotations

from pathlib import Path

from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import read_surface
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.tables.phases import EFFECTS, FIXATIONS, TOUCHES
from visuohaptic.tables.schema import read_table, write_table
from visuohaptic.touches.choosing import Wanted
from visuohaptic.touches.touching import acquire_touches


def make_touches(
    mesh: str | Path,
    fixations: str | Path,
    touches: str | Path,
    effects: str | Path,
    sensor: SensorParameters,
    scene: Scene,
    seed: int,
    wanted: Wanted,
) -> None:
    """Make the touch table and the effect log of an object from its probing locations."""
    located = read_table(FIXATIONS, fixations)
    felt, log = TOUCHES.arrow.empty_table(), EFFECTS.arrow.empty_table()
    if located.num_rows:  # the mesh of an object that was left out has no faces to cast rays at
        caster = RayCaster(read_surface(mesh))
        felt, log = acquire_touches(caster, located, sensor, scene, seed, wanted)
    write_table(TOUCHES, felt, touches)
    write_table(EFFECTS, log, effects)
