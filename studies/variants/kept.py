"""Variants that were measured once and are kept with the package, as they take half an hour.

`paper_set.parquet` and `outside.parquet` beside this file are `VARIANTS` on the paper's set
and on the 130 objects outside it, with where they come from in their metadata;
`python -m variants.kept results/variants.parquet SET COMMAND PROCESSOR`
writes one again.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from functools import cache
from importlib.resources import as_file, files
from pathlib import Path

from variants.tables import VARIANTS
from visuohaptic.studies.figures import Row
from visuohaptic.studies.stored import Source, source_of, store_table
from visuohaptic.tables.schema import read_table

PAPER_SET = "paper_set"
OUTSIDE = "outside"


@dataclass(frozen=True)
class MeasuredVariants:
    """Rows of `VARIANTS` in their order; the source of those that are not of this run."""

    rows: list[Row]
    source: Source | None = None


def read_variants(path: str | Path | None) -> MeasuredVariants:
    """Read the variants of a run where they were measured, else those kept with the package."""
    if path is not None and Path(path).is_file():
        return MeasuredVariants(_rows(path))
    return kept_variants(PAPER_SET)


@cache
def kept_variants(name: str) -> MeasuredVariants:
    """Read variants that are kept with the package, by the name of their objects."""
    with as_file(files("variants").joinpath(f"{name}.parquet")) as file:
        return MeasuredVariants(_rows(file), source_of(file))


def _rows(path: str | Path) -> list[Row]:
    table = read_table(VARIANTS, path)
    rows: list[Row] = table.sort_by([(key, "ascending") for key in VARIANTS.keys]).to_pylist()
    return sorted(rows, key=lambda row: int(row["place"]))


if __name__ == "__main__":
    table, name, command, machine = sys.argv[1:]
    store_table(VARIANTS, table, Path(__file__).with_name(f"{name}.parquet"), command, machine)
