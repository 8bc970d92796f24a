"""Tables that were measured once and are kept with the package, with where they come from."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path

import pyarrow.parquet as pq

from visuohaptic import __version__
from visuohaptic.tables.schema import Schema, read_table

_SOURCE = b"source"


@dataclass(frozen=True)
class Source:
    """Where a kept table comes from: processor, day of the measurement (UTC), what was run, and the package's version."""

    machine: str
    date: str
    command: str
    version: str


def store_table(
    schema: Schema, table: str | Path, output: str | Path, command: str, machine: str
) -> None:
    """Write a measured table with the command and the processor that gave it."""
    date = datetime.now(UTC).strftime("%Y-%m-%d")
    source = Source(machine, date, command, __version__)
    rows = read_table(schema, table)
    metadata = {**(rows.schema.metadata or {}), _SOURCE: json.dumps(asdict(source))}
    pq.write_table(rows.replace_schema_metadata(metadata), output, compression="zstd")


def source_of(path: str | Path) -> Source:
    """Read where a kept table comes from."""
    return Source(**json.loads((pq.read_schema(path).metadata or {})[_SOURCE]))
