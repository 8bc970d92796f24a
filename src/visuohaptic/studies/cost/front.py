"""Which settings are worth their time: the Pareto front of seconds and error rate."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.cost.settings import FAMILIES, STRATEGY, make_settings
from visuohaptic.studies.figures import Cell, CellKey, condition_interval
from visuohaptic.tables.schema import build_table, read_table
from visuohaptic.tables.studies import COST

Row = Mapping[str, Any]

_OF_SETTING = ("family", "place", "touches", "viewpoints", "pipeline", "classifier")

AIM = 0.95
"""The accuracy that the sentence for the user is about."""


def pareto_front(seconds: NDArray[np.float64], errors: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Tell which points no other beats: at most as slow, at most as wrong, and one of both less.

    Shape (n,) each; a point with a NaN is never on the front.
    """
    no_slower = seconds[None, :] <= seconds[:, None]
    no_worse = errors[None, :] <= errors[:, None]
    better = (seconds[None, :] < seconds[:, None]) | (errors[None, :] < errors[:, None])
    beaten = (no_slower & no_worse & better).any(axis=1)
    return ~beaten & np.isfinite(seconds) & np.isfinite(errors)


def error_rows(cells: Mapping[CellKey, Cell], run: ExperimentParameters) -> list[Row]:
    """Give each setting with its error rate, from the study's cells by condition."""
    rows: list[Row] = []
    for setting in make_settings(run):
        key = (setting.condition.name, setting.pipeline, STRATEGY, setting.classifier)
        row = {name: getattr(setting, name) for name in _OF_SETTING}
        row |= {"setting": setting.name, "changes": setting.written_changes}
        rows.append(row | error_rate(cells[key], run))
    return rows


def join_costs(errors: Sequence[Row], seconds: pa.Table) -> pa.Table:
    """Join error rates with seconds where there are any, and mark the front: `tables.COST`."""
    timed = {(row["family"], row["setting"]): row for row in seconds.to_pylist()}
    names = [column.name for column in COST.columns]
    rows = []
    for row in errors:
        time = timed.get((row["family"], row["setting"]), {})
        rows.append({name: {**time, **row}.get(name) for name in names})
    whole = [row["error"] is not None and row["seconds"] is not None for row in rows]
    on_front = pareto_front(_column(rows, "seconds"), _column(rows, "error"))
    columns: dict[str, Any] = {name: [row[name] for row in rows] for name in names}
    columns["on_front"] = on_front.tolist()
    columns["dominated"] = [
        bool(there and not on) for there, on in zip(whole, on_front, strict=True)
    ]
    return build_table(COST, columns)


def error_rate(cell: Cell, run: ExperimentParameters) -> dict[str, Any]:
    """Give the share of recognitions that name wrongly, its interval over objects, and their number.

    Where no object was classified wrongly, resampling can't say how far the rate may be from 0; its
    upper end is then the exact binomial one for so many objects (C. Clopper and E. Pearson,
    Biometrika 26(4), 1934).
    """
    if cell.error is not None:
        return {"failed": cell.error}
    objects, intervals = len(cell.objects), run.recognition.intervals
    # Sums of shares may miss 1 by a rounding.
    if np.all(cell.accuracy > 1 - 1e-12):
        high = clopper_pearson_high(objects, intervals.confidence)
        return {"error": 0.0, "error_low": 0.0, "error_high": high, "objects": objects}
    found = condition_interval(cell, intervals, run.seed)
    error, low, high = (min(max(1 - end, 0.0), 1.0) for end in (found.mean, found.high, found.low))
    return {"error": error, "error_low": low, "error_high": high, "objects": objects}


def clopper_pearson_high(objects: int, confidence: float) -> float:
    """Give the upper end of the exact binomial interval of no error among so many objects."""
    return float(1 - ((1 - confidence) / 2) ** (1 / objects))


def read_costs(path: str | Path) -> list[dict[str, Any]]:
    """Read `tables.COST` as rows, family by family, each along its line."""
    rows: list[dict[str, Any]] = read_table(COST, path).to_pylist()
    order = {family: place for place, family in enumerate(FAMILIES)}
    return sorted(rows, key=lambda row: (order[row["family"]], row["place"]))


def front_rows(rows: Sequence[Row]) -> list[Row]:
    """Give the rows on the front, the fastest first; of rows that are equal, the first alone."""
    front = sorted((row for row in rows if row["on_front"]), key=lambda row: row["seconds"])
    kept: dict[tuple[float, float], Row] = {}
    for row in front:
        kept.setdefault((row["seconds"], row["error"]), row)
    return list(kept.values())


def advise(rows: Sequence[Row], aim: float = AIM) -> str:
    """Say in one or two sentences what an accuracy takes, and what the next better one would."""
    front = front_rows(rows)
    if not front:
        return "No setting could be both run and timed."
    wanted = f"{100 * aim:g} %"
    reached = [place for place, row in enumerate(front) if row["error"] <= 1 - aim]
    if not reached:
        best = front[-1]
        return (
            f"No setting reaches {wanted}: the most accurate, {_named(best)}, classifies "
            f"{_percent(1 - best['error'])} correctly and costs {_milliseconds(best)} a recognition."
        )
    row = front[reached[0]]
    said = (
        f"For {wanted} take {_named(row)}: it costs {_milliseconds(row)} a recognition, and "
        f"{_percent(row['error'])} are classified wrongly ({_interval(row)})."
    )
    if reached[0] + 1 == len(front):
        return f"{said} Nothing that was measured is more accurate."
    following = front[reached[0] + 1]
    times = following["seconds"] / row["seconds"]
    return (
        f"{said} The next point, {_named(following)}, costs {times:.1f} times as much "
        f"({_milliseconds(following)}), and {_percent(following['error'])} are classified wrongly "
        f"({_interval(following)})."
    )


def _column(rows: Sequence[Row], name: str) -> NDArray[np.float64]:
    return np.array([np.nan if row[name] is None else row[name] for row in rows], dtype=np.float64)


def _named(row: Row) -> str:
    return f"{row['setting']} (family {row['family'].replace('_', ' ')})"


def _milliseconds(row: Row) -> str:
    return f"{1000 * row['seconds']:.0f} ms"


def _percent(share: float) -> str:
    return f"{100 * share:.1f} %"


def _interval(row: Row) -> str:
    return f"interval {_percent(row['error_low'])} to {_percent(row['error_high'])}"
