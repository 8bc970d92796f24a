"""Read rows of `tables.COST`, and mark their Pareto front."""

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
    """Set ``on_front`` and ``dominated`` of each row.

    A row is dominated if another row is no worse in seconds and error rate, and better in at least one of them. Rows
    with both figures that are not dominated are on the front.
    """
    seconds, errors = seconds_and_errors(rows)
    as_good = (seconds <= seconds[:, None]) & (errors <= errors[:, None])
    better = (seconds < seconds[:, None]) | (errors < errors[:, None])
    dominated = (as_good & better).any(axis=1)
    on_front = np.isfinite(seconds + errors) & ~dominated
    return [
        {**row, "on_front": front, "dominated": beaten}
        for row, front, beaten in zip(rows, on_front.tolist(), dominated.tolist(), strict=True)
    ]


def seconds_and_errors(rows: Sequence[Row]) -> FloatArray:
    """Return the seconds and error rates of n rows, shape (2, n); missing values are NaN."""
    return np.array(
        [[row[name] for row in rows] for name in ("seconds", "error")], dtype=np.float64
    )


def read_costs(path: str | Path, order: Sequence[str] = ORDER) -> list[Row]:
    """Read rows of `tables.COST`, sorted by family, first the families of `order`, and by ``place``."""
    rows: list[Row] = read_table(COST, path).to_pylist()
    families = dict.fromkeys((*order, *(row["family"] for row in rows)))
    rank = {family: index for index, family in enumerate(families)}
    return sorted(rows, key=lambda row: (rank[row["family"]], row["place"]))
