"""Run one phase from table files to table files, with one object in memory at a time.

This module imports no phase, so that editing one phase does not rerun the jobs of the others.
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
    """Run one phase on every object of the input tables, and write the output tables.

    Parameters
    ----------
    work : callable
        ``work(subject, *input_tables, **arguments)`` returns an object with one attribute per output table.
    arguments : mapping of str to object
        Arguments of `work` as built-in types; `check_arguments` converts them.
    meshes : mapping of str to path
        Mesh file of each object, by `class/name`.
    inputs, outputs : mapping of str to path
        Parquet files by table name. With meshes the phase runs on every mesh that was not set aside.
    viewpoints : sequence of int
        Indices of the viewpoints, for a phase that looks at the object.

    Raises
    ------
    TableError
        If an input file can't be read, or breaks its schema.
    """
    arguments = check_arguments(work, arguments)
    tables_of = {name: [SCHEMAS[name].arrow.empty_table()] for name in outputs}
    tables_read = {name: read_table(SCHEMAS[name], path) for name, path in inputs.items()}
    for key, tables in objects_of(tables_read, meshes):
        subject = Subject.of_mesh(key, meshes.get(key, ""), viewpoints)
        result = work(subject, *tables.values(), **arguments)
        for name, blocks in tables_of.items():
            blocks.append(getattr(result, name))
    for name, path in outputs.items():
        write_table(SCHEMAS[name], pa.concat_tables(tables_of[name]), path)


def check_arguments(work: Work, arguments: Mapping[str, Any]) -> dict[str, Any]:
    """Convert arguments of built-in types to the types in the annotations of `work`.

    Raises pydantic's ``ValidationError`` if a value does not fit its annotation.
    """
    return {name: _check(work, name).validate_python(value) for name, value in arguments.items()}


@cache
def _check(work: Work, name: str) -> TypeAdapter[Any]:
    return TypeAdapter(get_type_hints(work)[name])


def objects_of(tables: Tables, meshes: Files) -> Iterator[tuple[str, Tables]]:
    """Yield each object, `class/name`, with its rows of each table.

    Objects are the meshes that were not set aside. Without meshes the objects are those of the first table.
    """
    rows = {name: dict(by_object(table)) for name, table in tables.items()}
    if meshes or not tables:
        keys = [key for key, mesh in meshes.items() if not set_aside_reason(mesh)]
    else:
        keys = [*next(iter(rows.values()))]
    for key in keys:
        yield key, {name: rows[name].get(key, table.slice(0, 0)) for name, table in tables.items()}
