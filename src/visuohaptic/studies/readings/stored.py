"""Readings that were measured once and are kept with the package, as they take half an hour.

`paper_set.parquet` and `outside.parquet` beside this file are `tables.READINGS` on the paper's set
and on the 130 objects outside it, with where they come from in their metadata;
`python -m visuohaptic.studies.readings.stored results/readings.parquet SET COMMAND PROCESSOR`
writes one again.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import as_file, files
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from visuohaptic.studies.figures import Row
from visuohaptic.studies.stored import Source, source_of, store_table
from visuohaptic.tables.schema import check_table
from visuohaptic.tables.studies import READINGS

PAPER_SET = "paper_set"
OUTSIDE = "outside"

EARLIER_OPTIONS: Mapping[str, str] = {
    "focus_radius": "0.2",
    "reach": "0.1",
    "unreachable": "keep",
    "order": "kept",
    "random_probing": "anywhere",
}
"""What readings had that were measured before these were choices."""


@dataclass(frozen=True)
class MeasuredReadings:
    """Rows of `tables.READINGS` in their order; the source of those that are not of this run."""

    rows: list[Row]
    source: Source | None = None

    @property
    def is_earlier(self) -> bool:
        """Whether they are of a state in which random touches were made where no sensor can come."""
        return {row["random_probing"] for row in self.rows} == {"anywhere"}


def read_readings(path: str | Path | None) -> MeasuredReadings | None:
    """Read the readings of a run where they were measured, else those kept with the package."""
    if path is not None and Path(path).is_file():
        return MeasuredReadings(_rows(path))
    return kept_readings(PAPER_SET)


def kept_readings(name: str) -> MeasuredReadings | None:
    """Read readings that are kept with the package, by the name of their objects."""
    kept = files("visuohaptic.studies.readings").joinpath(f"{name}.parquet")
    if not kept.is_file():
        return None
    with as_file(kept) as file:
        return MeasuredReadings(_rows(file), source_of(file))


def _rows(path: str | Path) -> list[Row]:
    table = pq.read_table(path)
    for place, column in enumerate(READINGS.columns):
        if column.name in EARLIER_OPTIONS and column.name not in table.column_names:
            values = pa.array([EARLIER_OPTIONS[column.name]] * table.num_rows, column.dtype)
            table = table.add_column(place, READINGS.arrow.field(place), values)
    table = table.cast(READINGS.arrow)
    check_table(READINGS, table)
    rows: list[Row] = table.sort_by([(key, "ascending") for key in READINGS.keys]).to_pylist()
    return sorted(rows, key=lambda row: int(row["place"]))


if __name__ == "__main__":
    table, name, command, machine = sys.argv[1:]
    store_table(READINGS, table, Path(__file__).with_name(f"{name}.parquet"), command, machine)
