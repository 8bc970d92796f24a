"""Read and write measured tables that are kept with the package, together with their source."""

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
    """Source of a kept table: processor, day of the measurement (UTC), command, and version of the package."""

    machine: str
    date: str
    command: str
    version: str


def store_table(
    schema: Schema, table: str | Path, output: str | Path, command: str, machine: str
) -> None:
    """Copy a measured table to `output`, with its command, processor, date and version in the metadata."""
    date = datetime.now(UTC).strftime("%Y-%m-%d")
    source = Source(machine, date, command, __version__)
    rows = read_table(schema, table)
    metadata = {**(rows.schema.metadata or {}), _SOURCE: json.dumps(asdict(source))}
    pq.write_table(rows.replace_schema_metadata(metadata), output, compression="zstd")


def source_of(path: str | Path) -> Source:
    """Read the source of a kept table from its metadata."""
    return Source(**json.loads((pq.read_schema(path).metadata or {})[_SOURCE]))
