"""What was measured once on recordings that are not part of this package, kept with it.

`measured.parquet` is `tables.GAZE`, figures and hashes, with its origin as metadata; `python -m
visuohaptic.gaze.stored results/gaze/measured.parquet COMMAND SOURCE` writes it again.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib.resources import as_file, files
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from visuohaptic.tables.gaze import GAZE
from visuohaptic.tables.schema import read_table

FILE = "measured.parquet"
_ORIGIN = b"origin"


@dataclass(frozen=True)
class MeasuredGaze:
    """Rows of `tables.GAZE`; where those come from that are not of this run."""

    table: pa.Table
    origin: Mapping[str, str] | None = None


def read_measured(path: str | Path | None) -> MeasuredGaze | None:
    """Read what this run measured, else what is kept with the package; None without both."""
    if path is not None and Path(path).is_file():
        return MeasuredGaze(read_table(GAZE, [path]))
    kept = files(__package__).joinpath(FILE)
    if not kept.is_file():
        return None
    with as_file(kept) as file:
        origin = json.loads((pq.read_schema(file).metadata or {})[_ORIGIN])
        return MeasuredGaze(read_table(GAZE, [file]), origin)


def keep(path: str | Path, command: str, source: str) -> None:
    """Keep a table with the package, with the date, the command and the recordings' source."""
    table = read_table(GAZE, [path])
    origin = {
        "date": datetime.now(UTC).date().isoformat(),
        "command": command,
        "source": source,
    }
    metadata = {**(table.schema.metadata or {}), _ORIGIN: json.dumps(origin).encode()}
    with as_file(files(__package__).joinpath(FILE)) as file:
        pq.write_table(table.replace_schema_metadata(metadata), file, compression="zstd")


if __name__ == "__main__":
    keep(*sys.argv[1:4])
