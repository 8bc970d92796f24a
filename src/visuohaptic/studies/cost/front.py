"""Which settings are worth their time: the Pareto front of seconds and error rate."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.parameters import CostParameters, ExperimentParameters
from visuohaptic.recognition.intervals import Interval, rate_interval
from visuohaptic.studies.cost.pairs import (
    Row,
    Setting,
    SettingPairs,
    accuracy_gain,
    by_setting,
    draw_objects,
    is_known,
    setting_of,
    time_logarithms,
)
from visuohaptic.studies.cost.settings import FAMILIES, is_reference, make_settings
from visuohaptic.studies.figures import Cell, CellKey
from visuohaptic.tables.schema import build_table, read_table
from visuohaptic.tables.studies import COST, COST_PARTS

_OF_SETTING = (
    "family", "place", "touches", "viewpoints", "looks", "strategy", "pipeline", "classifier",
)  # fmt: skip
_LOST = ("lost", "lost_low", "lost_high")

POINT = 0.01
"""A loss of accuracy that does not matter to most users."""


def pareto_front(seconds: NDArray[np.float64], errors: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Tell which points no other beats: at most as slow, at most as wrong, and one of both less.

    Shape (n,) each; a point with a NaN is never on the front.
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
    pairs = SettingPairs(cells, time_logarithms(seconds), run)
    mark_steps(rows, pairs)
    mark_groups(rows, pairs)
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
        lost = None if reference is None else _lost(reference, cells[key], run)
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
        A row a setting, in the order of `errors`, without steps and each in a group of its own.
    """
    timed = sum_seconds(seconds)
    empty = dict.fromkeys(column.name for column in COST.columns)
    rows: list[Row] = [{**empty, **timed.get(setting_of(row), {}), **row} for row in errors]
    on_front = pareto_front(_column(rows, "seconds"), _column(rows, "error"))
    for place, (row, on) in enumerate(zip(rows, on_front.tolist(), strict=True)):
        row |= {"on_front": on, "dominated": is_known(row) and not on}
        row |= {"as_quick": False, "step": False, "group": place}
    return rows


def sum_seconds(seconds: pa.Table) -> dict[Setting, Row]:
    """Give the median and quartiles of each setting's `tables.COST_SECONDS`, and its parts' medians."""
    found: dict[Setting, Row] = {}
    for setting, rows in by_setting(seconds).items():
        quartiles = np.quantile([row["seconds"] for row in rows], [0.25, 0.5, 0.75])
        names = ("seconds_low", "seconds", "seconds_high")
        found[setting] = dict(zip(names, quartiles.tolist(), strict=True))
        for name, _ in COST_PARTS:
            found[setting][name] = float(np.median([row[name] for row in rows]))
        found[setting]["recognitions"] = len(rows)
    return found


def mark_steps(rows: Sequence[Row], pairs: SettingPairs) -> None:
    """Mark the settings that are worth their time.

    The first step is the most accurate of the settings that are as quick as the quickest. Each
    further step is significantly slower and significantly more accurate than the step before: of
    those that are as quick as the quickest such setting, it is the most accurate.
    """
    quick = pairs.as_quick(rows)
    for row in quick:
        row["as_quick"] = True
    while quick:
        step = min(quick, key=lambda row: float(row["error"]))
        step["step"] = True
        quick = pairs.as_quick(pairs.more_accurate(pairs.slower(rows, step), step))


def mark_groups(rows: Sequence[Row], pairs: SettingPairs) -> None:
    """Give each setting the number of the first group in which it is like every other setting."""
    groups: list[list[Row]] = []
    for row in rows:
        fitting = (group for group in groups if all(pairs.are_alike(row, one) for one in group))
        group = next(fitting, None)
        if group is None:
            group = []
            groups.append(group)
        group.append(row)
        row["group"] = groups.index(group)


def first_step(rows: Sequence[Row]) -> Row | None:
    """Give the most accurate of the settings that are as quick as the quickest."""
    return next((row for row in rows if row["step"] and row["as_quick"]), None)


def cost_table(rows: Sequence[Row]) -> pa.Table:
    """Make `tables.COST` of rows as `join_costs` gives them."""
    names = [column.name for column in COST.columns]
    return build_table(COST, {name: [row[name] for row in rows] for name in names})


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
        1 - cell.accuracy, cell.weights, run.recognition.intervals, draw_objects(run)
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


@dataclass(frozen=True)
class Saving:
    """What a smaller setting saves against the run's own, and what it loses.

    Attributes
    ----------
    row : dict
        Its row of `tables.COST`.
    saved : float
        Share of the seconds that it saves.
    verdict : {"free", "open", "costs"}
        Whether it surely costs less than `POINT`, can't be told apart from the run's own, or
        surely costs accuracy.
    """

    row: Row
    saved: float
    verdict: Literal["free", "open", "costs"]


@dataclass(frozen=True)
class BreakEven:
    """From which price on looking pays.

    Attributes
    ----------
    error : float
        The least error rate that a strategy without a look reaches.
    blind, looking : dict
        The rows of `tables.COST` with the fewest touches that reach it, without and with looks;
        the second is None where no setting that looks does.
    """

    error: float
    blind: Row
    looking: Row | None

    @property
    def touches_a_look(self) -> float | None:
        """Price of a look, in touches, below which looking pays; None where it never does."""
        if self.looking is None:
            return None
        return (all_touches(self.blind) - all_touches(self.looking)) / self.looking["looks"]


def all_touches(row: Row) -> int:
    """Give the touches of a recognition from all its viewpoints."""
    return int(row["touches"] * row["viewpoints"])


def reference_row(rows: Sequence[Row]) -> Row | None:
    """Give the row of the run's own setting from one viewpoint, if it is among the rows."""
    return next((row for row in rows if row["lost_low"] == 0 == row["lost_high"]), None)


def find_savings(rows: Sequence[Row]) -> list[Saving]:
    """Compare quicker ways to look and touch with the run's own setting.

    Parameters
    ----------
    rows : sequence of dict
        Rows of `tables.COST`.

    Returns
    -------
    list of Saving
        Of settings that look, touch or describe otherwise and are quicker, with as many touches
        from as many viewpoints; the largest saving first. Those that do not differ significantly
        from the run's own, neither in time nor in error, are left out.
    """
    own = reference_row(rows)
    if own is None or own["seconds"] is None:
        return []
    alike = [
        row
        for row in rows
        if row["changes"] != "{}"
        and not any(name.startswith("recognition.") for name in json.loads(row["changes"]))
        and (row["touches"], row["viewpoints"]) == (own["touches"], own["viewpoints"])
        and None not in (row["seconds"], row["lost_high"])
        and row["seconds"] < own["seconds"]
        and row["group"] != own["group"]
    ]
    savings = [Saving(row, 1 - row["seconds"] / own["seconds"], _verdict(row)) for row in alike]
    return sorted(savings, key=lambda saving: -saving.saved)


def break_even(rows: Sequence[Row]) -> BreakEven | None:
    """Find the price of a look from which on touching without looking is cheaper.

    Parameters
    ----------
    rows : sequence of dict
        Rows of `tables.COST`.

    Returns
    -------
    BreakEven or None
        None where no strategy without a look was measured.
    """
    known = [row for row in rows if row["error"] is not None]
    blind = [row for row in known if not row["looks"]]
    if not blind:
        return None
    best = min(blind, key=lambda row: (row["error"], all_touches(row)))
    reached = [row for row in known if row["looks"] and row["error"] <= best["error"]]
    fewest = min(reached, key=lambda row: (all_touches(row), row["looks"]), default=None)
    return BreakEven(best["error"], best, fewest)


def on_robot(rows: Sequence[Row], cost: CostParameters) -> list[Row]:
    """Give rows with the time of a robot: computing, and a price for each touch and look.

    Parameters
    ----------
    rows : sequence of dict
        Rows of `tables.COST`.
    cost : CostParameters
        The prices.

    Returns
    -------
    list of dict
        Copies with other seconds, and the front by them.
    """
    moved: list[Row] = []
    for row in rows:
        price = cost.touch_seconds * all_touches(row) + cost.look_seconds * row["looks"]
        times = {
            name: row[name] + price
            for name in ("seconds", "seconds_low", "seconds_high")
            if row[name] is not None
        }
        moved.append({**row, **times})
    on_front = pareto_front(_column(moved, "seconds"), _column(moved, "error"))
    for row, on in zip(moved, on_front.tolist(), strict=True):
        row |= {"on_front": on, "dominated": is_known(row) and not on}
    return moved


def _verdict(row: Row) -> Literal["free", "open", "costs"]:
    if row["lost_high"] < POINT:
        return "free"
    return "open" if row["lost_low"] <= 0 else "costs"


def _lost(reference: Cell, cell: Cell, run: ExperimentParameters) -> Interval | None:
    return Interval(0.0, 0.0, 0.0) if cell is reference else accuracy_gain(reference, cell, run)


def _column(rows: Sequence[Row], name: str) -> NDArray[np.float64]:
    found = [row.get(name) for row in rows]
    return np.array([np.nan if value is None else value for value in found], dtype=np.float64)
