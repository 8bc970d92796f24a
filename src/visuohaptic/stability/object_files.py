"""From an object of the run to its rows of the table of hard cases."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.geometry.surface import read_surface
from visuohaptic.scene.parameters import Scene
from visuohaptic.seeds import spawn_generator
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.stability.objects import SensedObject, check_object
from visuohaptic.stability.rows import result_table
from visuohaptic.tables.phases import FIXATIONS, TOUCHES
from visuohaptic.tables.schema import read_table, write_table
from visuohaptic.tables.stability import STABILITY
from visuohaptic.touches.choosing import touched_places


def make_object_stability(
    key: str,
    mesh: str | Path,
    fixations: str | Path | Sequence[str | Path],
    touches: str | Path | Sequence[str | Path],
    output: str | Path,
    attention: AttentionParameters,
    sensor: SensorParameters,
    scene: Scene,
    seed: int,
) -> None:
    """Make the checks on one object, and write the table; of an object set aside, or that was not touched, it has no rows."""
    located = read_table(FIXATIONS, fixations)
    felt = read_table(TOUCHES, touches)
    if not felt.num_rows:
        write_table(STABILITY, STABILITY.arrow.empty_table(), output)
        return
    located = touched_places(located, felt)
    sensed = SensedObject(read_surface(mesh), located, felt, attention, sensor, scene, seed)
    found = check_object(sensed, spawn_generator(seed, "stability", key))
    write_table(STABILITY, result_table(found.values(), key), output)
