"""The variants that are kept with the study, because measuring them takes half an hour.

``kept_paper.parquet`` and ``kept_outside.parquet`` are `VARIANTS` on the paper's set and on the 130 objects outside of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.resources import as_file, files
from pathlib import Path

from variants.tables import VARIANTS
from visuohaptic.studies.figures import Row
from visuohaptic.studies.keeping import Source, kept_file, read_source
from visuohaptic.tables.schema import read_table

PAPER_SET = "paper"
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
    with as_file(files("variants")) as folder:
        file = kept_file(folder, name)
        return MeasuredVariants(_rows(file), read_source(file))


def _rows(path: str | Path) -> list[Row]:
    table = read_table(VARIANTS, path)
    rows: list[Row] = table.sort_by([(key, "ascending") for key in VARIANTS.keys]).to_pylist()
    return sorted(rows, key=lambda row: int(row["place"]))
