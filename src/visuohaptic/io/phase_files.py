"""One phase from tables to tables, an object in memory at a time.

It imports no phase: a job's script brings its own.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, get_type_hints

import pyarrow as pa
from pydantic import TypeAdapter

from visuohaptic.geometry.subject import Subject
from visuohaptic.geometry.surface import set_aside_reason
from visuohaptic.tables.phases import PHASES, by_object
from visuohaptic.tables.schema import read_table, write_table

SCHEMAS = {schema.name: schema for schema in PHASES}

Files = Mapping[str, str | Path]
Tables = dict[str, pa.Table]
Work = Callable[..., Any]


def run_phase_on_files(
    work: Work,
    arguments: Mapping[str, Any],
    meshes: Files,
    inputs: Files,
    outputs: Files,
    viewpoints: Sequence[int] = (),
) -> None:
    """Take the objects of some files through one phase.

    `work` takes a `Subject`, its rows of each input, and the arguments, of built-in types; it gives an object
    with a table for each output. `meshes` are files by `class/name`; an object that was set aside has no rows. `viewpoints` are numbers, for a phase that looks.
    """
    arguments = check_arguments(work, arguments)
    parts = {name: [SCHEMAS[name].arrow.empty_table()] for name in outputs}
    read = {name: read_table(SCHEMAS[name], path) for name, path in inputs.items()}
    for key, tables in objects_of(read, meshes):
        subject = Subject.of_mesh(key, meshes.get(key, ""), viewpoints)
        found = work(subject, *tables.values(), **arguments)
        for name, part in parts.items():
            part.append(getattr(found, name))
    for name, path in outputs.items():
        write_table(SCHEMAS[name], pa.concat_tables(parts[name]), path)


def check_arguments(work: Work, arguments: Mapping[str, Any]) -> dict[str, Any]:
    """Turn arguments of built-in types into what the annotations of a function say."""
    return {name: _check(work, name).validate_python(value) for name, value in arguments.items()}


@cache
def _check(work: Work, name: str) -> TypeAdapter[Any]:
    return TypeAdapter(get_type_hints(work)[name])


def objects_of(tables: Tables, meshes: Files) -> Iterator[tuple[str, Tables]]:
    """Give each object, `class/name`, and its rows: every mesh that takes part, or without meshes all of the first table."""
    rows = {name: dict(by_object(table)) for name, table in tables.items()}
    if meshes or not tables:
        keys = [key for key, mesh in meshes.items() if not set_aside_reason(mesh)]
    else:
        keys = [*next(iter(rows.values()))]
    for key in keys:
        yield key, {name: rows[name].get(key, table.slice(0, 0)) for name, table in tables.items()}
