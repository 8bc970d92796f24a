"""From objects of the run to their rows of the table of hard cases."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import pyarrow as pa

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.geometry.surface import read_surface
from visuohaptic.scene.parameters import Scene
from visuohaptic.seeds import spawn_generator
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.stability.objects import SensedObject, check_object
from visuohaptic.stability.rows import result_table
from visuohaptic.tables.phases import FIXATIONS, TOUCHES, by_object
from visuohaptic.tables.schema import read_table, write_table
from visuohaptic.tables.stability import STABILITY
from visuohaptic.touches.choosing import touched_places


def make_object_stability(
    meshes: Mapping[str, str | Path],
    fixations: str | Path | Sequence[str | Path],
    touches: str | Path | Sequence[str | Path],
    output: str | Path,
    attention: AttentionParameters,
    sensor: SensorParameters,
    scene: Scene,
    seed: int,
) -> None:
    """Make the checks on some objects, by `class/name`, and write the table; one that was not touched has no rows."""
    located = dict(by_object(read_table(FIXATIONS, fixations)))
    parts = [STABILITY.arrow.empty_table()]
    for key, felt in by_object(read_table(TOUCHES, touches)):
        places = touched_places(located[key], felt)
        surface = read_surface(meshes[key])
        sensed = SensedObject(surface, places, felt, attention, sensor, scene, seed)
        found = check_object(sensed, spawn_generator(seed, "stability", key))
        parts.append(result_table(found.values(), key))
    write_table(STABILITY, pa.concat_tables(parts), output)
