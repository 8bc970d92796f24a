"""Which settings are worth their time: the Pareto front of seconds and error rate."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.intervals import Interval, difference_interval, rate_interval
from visuohaptic.seeds import spawn_generator
from visuohaptic.studies.cost.settings import FAMILIES, is_reference, make_settings
from visuohaptic.studies.figures import Cell, CellKey
from visuohaptic.tables.schema import build_table, read_table
from visuohaptic.tables.studies import COST

Row = dict[str, Any]

_OF_SETTING = (
    "family", "place", "touches", "viewpoints", "looks", "strategy", "pipeline", "classifier",
)  # fmt: skip
_LOST = ("lost", "lost_low", "lost_high")

AIM = 0.95
"""The accuracy that the sentence for the user is about."""


def pareto_front(seconds: NDArray[np.float64], errors: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Tell which points no other point beats: at most as slow, at most as wrong, and one of both less.

    Parameters
    ----------
    seconds, errors : numpy.ndarray
        Shape (n,), float64; a point with a NaN is never on the front.

    Returns
    -------
    numpy.ndarray
        Shape (n,), bool.
    """
    no_slower = seconds[None, :] <= seconds[:, None]
    no_worse = errors[None, :] <= errors[:, None]
    better = (seconds[None, :] < seconds[:, None]) | (errors[None, :] < errors[:, None])
    beaten = (no_slower & no_worse & better).any(axis=1)
    return ~beaten & np.isfinite(seconds) & np.isfinite(errors)


def weigh(
    cells: Mapping[CellKey, Cell], seconds: pa.Table, run: ExperimentParameters, study: str
) -> pa.Table:
    """Compare a study's settings: error rate against run time.

    Parameters
    ----------
    cells : mapping
        As `studies.figures.read_cells` gives them.
    seconds : pyarrow.Table
        Rows of `tables.COST_SECONDS`; a setting that failed need not have one.
    run : ExperimentParameters
        The run's.
    study : str
        Which study.

    Returns
    -------
    pyarrow.Table
        `tables.COST`.
    """
    rows = join_costs(error_rows(cells, run, study), seconds)
    mark_steps(rows, cells, run)
    return cost_table(rows)


def error_rows(cells: Mapping[CellKey, Cell], run: ExperimentParameters, study: str) -> list[Row]:
    """Give each setting with its error rate, and what it is more than the reference's."""
    settings = make_settings(run, study)
    keys = [(one.condition.name, one.pipeline, one.strategy, one.classifier) for one in settings]
    reference = next(
        (cells[key] for one, key in zip(settings, keys, strict=True) if is_reference(one, run)),
        None,
    )
    rows: list[Row] = []
    for setting, key in zip(settings, keys, strict=True):
        row = {name: getattr(setting, name) for name in _OF_SETTING}
        row |= {"setting": setting.name, "changes": setting.written_changes}
        row |= error_rate(cells[key], run)
        if reference is not None:
            lost = _gain(reference, cells[key], run)
            ends = (None, None, None) if lost is None else (lost.mean, lost.low, lost.high)
            row |= dict(zip(_LOST, ends, strict=True))
        rows.append(row)
    return rows


def join_costs(errors: Sequence[Row], seconds: pa.Table) -> list[Row]:
    """Join error rates with seconds, and mark the front.

    Parameters
    ----------
    errors : sequence of mapping
        Settings with their error rates, as `error_rows` gives them.
    seconds : pyarrow.Table
        Rows of `tables.COST_SECONDS`; a setting that failed need not have one.

    Returns
    -------
    list of dict
        A row a setting, in the order of `errors`.
    """
    timed = {(row["family"], row["setting"]): row for row in seconds.to_pylist()}
    rows: list[Row] = [{**timed.get((row["family"], row["setting"]), {}), **row} for row in errors]
    on_front = pareto_front(_column(rows, "seconds"), _column(rows, "error"))
    for row, on in zip(rows, on_front.tolist(), strict=True):
        whole = row.get("error") is not None and row.get("seconds") is not None
        row |= {"on_front": on, "dominated": whole and not on, "step": False}
    return rows


def mark_steps(
    rows: Sequence[Row], cells: Mapping[CellKey, Cell], run: ExperimentParameters
) -> None:
    """Mark the points of the front that are surely more accurate than the step before.

    The quickest point is the first step. Each further step is the quickest point whose accuracy
    is above that of the step before by an interval over objects that excludes 0.
    """
    last: Cell | None = None
    for row in front_rows(rows):
        name = f"{row['family']}, {row['setting']}"
        cell = cells[name, row["pipeline"], row["strategy"], row["classifier"]]
        gain = None if last is None else _gain(cell, last, run)
        row["step"] = last is None or (gain is not None and gain.low > 0)
        last = cell if row["step"] else last


def cost_table(rows: Sequence[Row]) -> pa.Table:
    """Make `tables.COST` of rows as `join_costs` gives them."""
    names = [column.name for column in COST.columns]
    return build_table(COST, {name: [row.get(name) for row in rows] for name in names})


def error_rate(cell: Cell, run: ExperimentParameters) -> dict[str, Any]:
    """Give the share of recognitions that name wrongly, its interval over objects, and their number.

    Parameters
    ----------
    cell : Cell
        A setting's figures.
    run : ExperimentParameters
        The run's: the intervals are its own.

    Returns
    -------
    dict of str
        Columns of `tables.COST`.
    """
    if cell.error is not None:
        return {"failed": cell.error}
    found = rate_interval(
        1 - cell.accuracy, cell.weights, run.recognition.intervals, _generator(run)
    )
    error, low, high = (min(max(end, 0.0), 1.0) for end in (found.mean, found.low, found.high))
    return {"error": error, "error_low": low, "error_high": high, "objects": len(cell.objects)}


def read_costs(path: str | Path) -> list[dict[str, Any]]:
    """Read `tables.COST` as rows, family by family, each along its line."""
    rows: list[dict[str, Any]] = read_table(COST, path).to_pylist()
    families = [family for study in FAMILIES.values() for family in study]
    order = {family: place for place, family in enumerate(families)}
    return sorted(rows, key=lambda row: (order[row["family"]], row["place"]))


def front_rows(rows: Sequence[Row]) -> list[Row]:
    """Give the rows on the front, the fastest first; of rows that are equal, the first alone."""
    front = sorted((row for row in rows if row["on_front"]), key=lambda row: row["seconds"])
    kept: dict[tuple[float, float], Row] = {}
    for row in front:
        kept.setdefault((row["seconds"], row["error"]), row)
    return list(kept.values())


def advise(rows: Sequence[Row], aim: float = AIM) -> str:
    """Tell the user what an accuracy takes, and what the next better one would.

    Parameters
    ----------
    rows : sequence of mapping
        Rows of `tables.COST`.
    aim : float
        The accuracy.

    Returns
    -------
    str
        One or two sentences.
    """
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


def _gain(first: Cell, second: Cell, run: ExperimentParameters) -> Interval | None:
    """Give how much more accurate the first is, where both name the same objects."""
    if not first.objects or first.objects != second.objects:
        return None
    intervals = run.recognition.intervals
    return difference_interval(
        first.accuracy, second.accuracy, second.weights, intervals, _generator(run)
    )


def _generator(run: ExperimentParameters) -> np.random.Generator:
    """Give the same draws of objects for all, so that equal figures have equal intervals."""
    return spawn_generator(run.seed, "studies")


def _column(rows: Sequence[Row], name: str) -> NDArray[np.float64]:
    found = [row.get(name) for row in rows]
    return np.array([np.nan if value is None else value for value in found], dtype=np.float64)


def _named(row: Row) -> str:
    return f"{row['setting']} (family {row['family'].replace('_', ' ')})"


def _milliseconds(row: Row) -> str:
    return f"{1000 * row['seconds']:.0f} ms"


def _percent(share: float) -> str:
    return f"{100 * share:.1f} %"


def _interval(row: Row) -> str:
    return f"interval {_percent(row['error_low'])} to {_percent(row['error_high'])}"
