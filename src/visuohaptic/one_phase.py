"""One phase from tables to tables, an object in memory at a time.

It knows no phase, so that a job depends on its own phase alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa

from visuohaptic.functions import Function
from visuohaptic.geometry.subject import Subject
from visuohaptic.geometry.surface import set_aside_reason
from visuohaptic.tables.phases import PHASES, by_object, of_objects
from visuohaptic.tables.schema import read_table, write_table

SCHEMAS = {schema.name: schema for schema in PHASES}

Files = Mapping[str, str | Path]
Tables = dict[str, pa.Table]


def run_files(
    work: Function,
    arguments: Mapping[str, Any],
    meshes: Files,
    inputs: Files,
    outputs: Files,
    viewpoints: Sequence[int] = (),
) -> None:
    """Take the objects of some files through one phase.

    `work` takes a `Subject`, its rows of each input, and the arguments, of built-in types; it gives an object
    with a table for each output. `meshes` are files by `class/name`. Without inputs each object has its mesh
    alone, and one that was set aside has no rows. `viewpoints` are numbers, for a phase that looks.
    """
    checked = work.checked(arguments)
    parts = {name: [SCHEMAS[name].arrow.empty_table()] for name in outputs}
    read = {name: read_table(SCHEMAS[name], path) for name, path in inputs.items()}
    for key, tables in objects_of(read, meshes):
        subject = Subject.of_mesh(key, meshes.get(key, ""), viewpoints)
        found = work(subject, *tables.values(), **checked)
        for name, part in parts.items():
            part.append(getattr(found, name))
    for name, path in outputs.items():
        write_table(SCHEMAS[name], pa.concat_tables(parts[name]), path)


def objects_of(tables: Tables, meshes: Files) -> Iterator[tuple[str, Tables]]:
    """Give each object, `class/name`, and its rows; without tables each mesh that takes part."""
    if not tables:
        yield from ((key, {}) for key, mesh in meshes.items() if not set_aside_reason(mesh))
        return
    first, *others = tables
    for key, rows in by_object(tables[first]):
        yield key, {first: rows, **{name: of_objects(tables[name], [key]) for name in others}}
