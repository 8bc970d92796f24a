"""Rows of `tables.COST`: read, and marked where no other row is quicker and more accurate."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from visuohaptic.base.arrays import FloatArray
from visuohaptic.studies.cost.settings import ORDER
from visuohaptic.tables.schema import read_table
from visuohaptic.tables.studies import COST

Row = dict[str, Any]
"""A row of `tables.COST`."""


def mark_front(rows: Sequence[Row]) -> list[Row]:
    """Mark which rows are on the front, which are dominated, and which, without figures, are neither.

    On the front no other is at most as slow, at most as wrong, and one of both less.
    """
    seconds, errors = seconds_and_errors(rows)
    as_good = (seconds <= seconds[:, None]) & (errors <= errors[:, None])
    better = (seconds < seconds[:, None]) | (errors < errors[:, None])
    beaten = (as_good & better).any(axis=1)
    front = np.isfinite(seconds + errors) & ~beaten
    marks = zip(rows, front.tolist(), beaten.tolist(), strict=True)
    return [{**row, "on_front": best, "dominated": worse} for row, best, worse in marks]


def seconds_and_errors(rows: Sequence[Row]) -> FloatArray:
    """Return the seconds and error rates of rows, shape (2, n), NaN where a row has none."""
    return np.array(
        [[row[name] for row in rows] for name in ("seconds", "error")], dtype=np.float64
    )


def read_costs(path: str | Path, order: Sequence[str] = ORDER) -> list[Row]:
    """Read `tables.COST` as rows, family by family, those of `order` first, each along its line."""
    rows: list[Row] = read_table(COST, path).to_pylist()
    families = dict.fromkeys((*order, *(row["family"] for row in rows)))
    places = {family: place for place, family in enumerate(families)}
    return sorted(rows, key=lambda row: (places[row["family"]], row["place"]))
