"""Read the variants that are kept with the package, because measuring them takes half an hour.

`paper_set.parquet` and `outside.parquet` beside this file are `VARIANTS` on the paper's set and on the 130 objects
outside of it. Their metadata name the source. `python -m variants.kept results/variants.parquet SET COMMAND PROCESSOR`
writes one of the files again.
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
    """Rows of `VARIANTS` in the order of the design; `source` is None for rows of this run."""

    rows: list[Row]
    source: Source | None = None


def read_variants(path: str | Path | None) -> MeasuredVariants:
    """Read the variants of a run from `path`; if there is no such file, read the kept variants of the paper's set."""
    if path is not None and Path(path).is_file():
        return MeasuredVariants(_rows(path))
    return kept_variants(PAPER_SET)


@cache
def kept_variants(name: str) -> MeasuredVariants:
    """Read the kept variants of a set of objects: `PAPER_SET` or `OUTSIDE`."""
    with as_file(files("variants").joinpath(f"{name}.parquet")) as file:
        return MeasuredVariants(_rows(file), source_of(file))


def _rows(path: str | Path) -> list[Row]:
    table = read_table(VARIANTS, path)
    rows: list[Row] = table.sort_by([(key, "ascending") for key in VARIANTS.keys]).to_pylist()
    return sorted(rows, key=lambda row: int(row["place"]))


if __name__ == "__main__":
    table, name, command, machine = sys.argv[1:]
    store_table(VARIANTS, table, Path(__file__).with_name(f"{name}.parquet"), command, machine)
