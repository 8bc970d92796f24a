"""Which settings are worth their time: the Pareto front of seconds and error rate, and paired comparisons."""

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
from visuohaptic.recognition.intervals import (
    Interval,
    compare_paired,
    difference_interval,
    holm,
    rate_interval,
)
from visuohaptic.seeds import spawn_generator
from visuohaptic.studies.cost.settings import FAMILIES, is_reference, make_settings
from visuohaptic.studies.figures import Cell, CellKey, read_cells
from visuohaptic.studies.study import Given
from visuohaptic.tables.schema import build_table, read_table, write_table
from visuohaptic.tables.studies import COST, COST_PARTS, COST_SECONDS

Row = dict[str, Any]
"""Of `tables.COST`."""

Setting = tuple[str, str]
"""Family and name."""

Turn = tuple[str, int]
"""An object, and the turn in which it was timed."""

_OF_SETTING = (
    *("family", "place", "touches", "viewpoints", "looks", "strategy", "pipeline", "classifier"),
)
_COLUMNS = tuple(column.name for column in COST.columns)

POINT = 0.01
"""A loss of accuracy that does not matter to most users."""


def make_cost(given: Given) -> None:
    """Join error rates and seconds of all settings, and mark the front: `tables.COST`."""
    cells = read_cells(given.inputs["blocks"])
    seconds = read_table(COST_SECONDS, given.inputs["tables"])
    rows = join_costs(error_rows(cells, given.run, given.study), seconds)
    pairs = SettingPairs(cells, time_logarithms(seconds), given.run)
    mark_steps(rows, pairs)
    mark_groups(rows, pairs)
    write_table(COST, cost_table(rows), given.outputs[0])


def pareto_front(seconds: NDArray[np.float64], errors: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Tell which points no other beats: at most as slow, at most as wrong, and one of both less.

    Shape (n,) each; a point with a NaN is never on the front.
    """
    no_slower = seconds[None, :] <= seconds[:, None]
    no_worse = errors[None, :] <= errors[:, None]
    better = (seconds[None, :] < seconds[:, None]) | (errors[None, :] < errors[:, None])
    beaten = (no_slower & no_worse & better).any(axis=1)
    return ~beaten & np.isfinite(seconds) & np.isfinite(errors)


def error_rows(cells: Mapping[CellKey, Cell], run: ExperimentParameters, study: str) -> list[Row]:
    """Give each setting with its error rate, and what it is more than the reference's."""
    settings = make_settings(run, study)
    own = [
        cells[one.condition.name, one.pipeline, one.strategy, one.classifier] for one in settings
    ]
    pairs = list(zip(settings, own, strict=True))
    reference = next((cell for one, cell in pairs if is_reference(one, run)), None)
    return [
        {
            **{name: getattr(setting, name) for name in _OF_SETTING},
            "setting": setting.name,
            "changes": setting.written_changes,
            **error_rate(cell, run),
            **_loss(reference, cell, run),
        }
        for setting, cell in pairs
    ]


def error_rate(cell: Cell, run: ExperimentParameters) -> Row:
    """Give the share of recognitions that are wrong, its interval over objects, and their number."""
    if cell.error is not None:
        return {"failed": cell.error}
    intervals = run.recognition.intervals
    found = rate_interval(1 - cell.accuracy, cell.weights, intervals, _draw_objects(run))
    error, low, high = (min(max(end, 0.0), 1.0) for end in (found.mean, found.low, found.high))
    return {"error": error, "error_low": low, "error_high": high, "objects": len(cell.objects)}


def join_costs(errors: Sequence[Row], seconds: pa.Table) -> list[Row]:
    """Join error rates, as `error_rows` gives them, with seconds, and mark the front.

    Rows have no steps, and each is in a group of its own.
    """
    timed = {setting: _quantiles(rows) for setting, rows in by_setting(seconds).items()}
    empty, unmarked = dict.fromkeys(_COLUMNS), {"as_quick": False, "step": False}
    rows = [
        {**empty, **timed.get(setting_of(row), {}), **row, **unmarked, "group": place}
        for place, row in enumerate(errors)
    ]
    return _mark_front(rows)


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


def cost_table(rows: Sequence[Row]) -> pa.Table:
    """Make `tables.COST` of rows as `join_costs` gives them."""
    return build_table(COST, {name: [row[name] for row in rows] for name in _COLUMNS})


@dataclass(frozen=True)
class SettingPairs:
    """Which settings differ significantly: by comparisons of the same objects, at the run's confidence.

    `cells` are as `studies.figures.read_cells` gives them, `logarithms` as `time_logarithms` does.
    """

    cells: Mapping[CellKey, Cell]
    logarithms: Mapping[Setting, Mapping[Turn, float]]
    run: ExperimentParameters

    def time_ratio(self, first: Row, second: Row) -> Interval:
        """Give the logarithm of the second's seconds by the first's, over objects.

        An object's ratio is the mean over the turns in which both were timed. The interval is
        Student's, of the objects' ratios; with fewer than two objects it is without ends.
        """
        from scipy.special import stdtrit

        one, two = (self.logarithms.get(setting_of(row), {}) for row in (first, second))
        by_object: dict[str, list[float]] = {}
        for key in one.keys() & two.keys():
            by_object.setdefault(key[0], []).append(two[key] - one[key])
        ratios = np.array([np.mean(found) for _, found in sorted(by_object.items())])
        if len(ratios) < 2:
            return Interval(0.0, -np.inf, np.inf)
        confidence = self.run.recognition.intervals.confidence
        quantile = stdtrit(len(ratios) - 1, (1 + confidence) / 2)
        reach = float(quantile * ratios.std(ddof=1) / np.sqrt(len(ratios)))
        mean = float(ratios.mean())
        return Interval(mean, mean - reach, mean + reach)

    def as_quick(self, rows: Sequence[Row]) -> list[Row]:
        """Give the settings that are not significantly slower than the quickest."""
        known = [row for row in rows if is_known(row)]
        if not known:
            return []
        quickest = min(known, key=lambda row: float(row["seconds"]))
        return [row for row in known if row is quickest or self.time_ratio(quickest, row).low <= 0]

    def slower(self, rows: Sequence[Row], last: Row) -> list[Row]:
        """Give the settings that are significantly slower than another."""
        return [row for row in rows if is_known(row) and self.time_ratio(last, row).low > 0]

    def more_accurate(self, rows: Sequence[Row], last: Row) -> list[Row]:
        """Give the settings that are significantly more accurate than the last step.

        By the sign-change test over objects; p values are adjusted for the number of settings (Holm).
        """
        before, intervals = self._cell(last), self.run.recognition.intervals
        able = [row for row in rows if _same_objects(self._cell(row), before)]
        pairs = ((self._cell(row).accuracy, before.accuracy, before.weights) for row in able)
        found = [compare_paired(*pair, intervals, _draw_objects(self.run)) for pair in pairs]
        adjusted = holm([one.p_value for one in found])
        return [
            row
            for row, one, p_value in zip(able, found, adjusted, strict=True)
            if one.difference.mean > 0 and p_value <= 1 - intervals.confidence
        ]

    def are_alike(self, first: Row, second: Row) -> bool:
        """Tell whether two settings differ significantly neither in time nor in error."""
        if not (is_known(first) and is_known(second)):
            return False
        ratio = self.time_ratio(first, second)
        if not ratio.low <= 0 <= ratio.high:
            return False
        gain = accuracy_gain(self._cell(first), self._cell(second), self.run)
        return gain is not None and gain.low <= 0 <= gain.high

    def _cell(self, row: Row) -> Cell:
        name = f"{row['family']}, {row['setting']}"
        return self.cells[name, row["pipeline"], row["strategy"], row["classifier"]]


def time_logarithms(seconds: pa.Table) -> dict[Setting, dict[Turn, float]]:
    """Give the logarithm of each setting's seconds, by object and turn."""
    return {
        setting: {(row["object"], row["turn"]): float(np.log(row["seconds"])) for row in rows}
        for setting, rows in by_setting(seconds).items()
    }


def by_setting(seconds: pa.Table) -> dict[Setting, list[Row]]:
    """Give the rows of `tables.COST_SECONDS` of each setting."""
    found: dict[Setting, list[Row]] = {}
    for row in seconds.to_pylist():
        found.setdefault(setting_of(row), []).append(row)
    return found


def setting_of(row: Row) -> Setting:
    """Give the key of a row."""
    return row["family"], row["setting"]


def is_known(row: Row) -> bool:
    """Tell whether a setting could be both run and timed."""
    return row["seconds"] is not None and row["error"] is not None


def accuracy_gain(first: Cell, second: Cell, run: ExperimentParameters) -> Interval | None:
    """Give how much more accurate the first is, where both name the same objects."""
    if not _same_objects(first, second):
        return None
    intervals, draws = run.recognition.intervals, _draw_objects(run)
    return difference_interval(first.accuracy, second.accuracy, second.weights, intervals, draws)


def read_costs(path: str | Path) -> list[Row]:
    """Read `tables.COST` as rows, family by family, each along its line."""
    rows: list[Row] = read_table(COST, path).to_pylist()
    order = [family for study in FAMILIES.values() for family in study]
    return sorted(rows, key=lambda row: (order.index(row["family"]), row["place"]))


def front_rows(rows: Sequence[Row]) -> list[Row]:
    """Give the rows on the front, the fastest first; of rows that are equal, the first alone."""
    front = sorted((row for row in rows if row["on_front"]), key=lambda row: float(row["seconds"]))
    kept: dict[tuple[float, float], Row] = {}
    for row in front:
        kept.setdefault((row["seconds"], row["error"]), row)
    return list(kept.values())


def first_step(rows: Sequence[Row]) -> Row | None:
    """Give the most accurate of the settings that are as quick as the quickest."""
    return next((row for row in rows if row["step"] and row["as_quick"]), None)


def reference_row(rows: Sequence[Row]) -> Row | None:
    """Give the row of the run's own setting from one viewpoint, if it is among the rows."""
    return next((row for row in rows if row["lost_low"] == 0 == row["lost_high"]), None)


def all_touches(row: Row) -> int:
    """Give the touches of a recognition from all its viewpoints."""
    return int(row["touches"] * row["viewpoints"])


@dataclass(frozen=True)
class Saving:
    """What a smaller setting, a row of `tables.COST`, saves against the run's own: a share of the seconds."""

    row: Row
    saved: float

    @property
    def verdict(self) -> Literal["free", "open", "costs"]:
        """Whether it surely costs less than `POINT`, can't be told apart from the run's own, or surely costs."""
        if self.row["lost_high"] < POINT:
            return "free"
        return "open" if self.row["lost_low"] <= 0 else "costs"


def find_savings(rows: Sequence[Row]) -> list[Saving]:
    """Compare quicker ways to look and touch, rows of `tables.COST`, with the run's own setting.

    They look, touch or describe otherwise, with as many touches from as many viewpoints; the largest
    saving first. Those that do not differ significantly, neither in time nor in error, are left out.
    """
    own = reference_row(rows)
    if own is None or own["seconds"] is None:
        return []
    found = [
        Saving(row, 1 - row["seconds"] / own["seconds"])
        for row in rows
        if row["changes"] != "{}"
        and not any(name.startswith("recognition.") for name in json.loads(row["changes"]))
        and (row["touches"], row["viewpoints"]) == (own["touches"], own["viewpoints"])
        and None not in (row["seconds"], row["lost_high"])
        and row["seconds"] < own["seconds"]
        and row["group"] != own["group"]
    ]
    return sorted(found, key=lambda saving: -saving.saved)


@dataclass(frozen=True)
class BreakEven:
    """The least error rate without a look, and the settings with the fewest touches that reach it.

    `blind` looks at nothing; `looking` does, and is None where no setting that looks reaches it.
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


def break_even(rows: Sequence[Row]) -> BreakEven | None:
    """Find the price of a look from which on touching without one is cheaper; None where every strategy looks."""
    known = [row for row in rows if row["error"] is not None]
    blind = [row for row in known if not row["looks"]]
    if not blind:
        return None
    best = min(blind, key=lambda row: (row["error"], all_touches(row)))
    reached = [row for row in known if row["looks"] and row["error"] <= best["error"]]
    fewest = min(reached, key=lambda row: (all_touches(row), row["looks"]), default=None)
    return BreakEven(best["error"], best, fewest)


def on_robot(rows: Sequence[Row], cost: CostParameters) -> list[Row]:
    """Copy rows of `tables.COST` with the time of a robot, a price for each touch and look added, and its front."""

    def moved(row: Row) -> Row:
        price = cost.touch_seconds * all_touches(row) + cost.look_seconds * row["looks"]
        names = ("seconds", "seconds_low", "seconds_high")
        return {**row, **{name: row[name] + price for name in names if row[name] is not None}}

    return _mark_front([moved(row) for row in rows])


def _mark_front(rows: list[Row]) -> list[Row]:
    seconds, errors = (
        np.array([np.nan if row[name] is None else row[name] for row in rows], dtype=np.float64)
        for name in ("seconds", "error")
    )
    for row, on in zip(rows, pareto_front(seconds, errors).tolist(), strict=True):
        row |= {"on_front": on, "dominated": is_known(row) and not on}
    return rows


def _quantiles(rows: Sequence[Row]) -> Row:
    """Give the median and quartiles of a setting's seconds, and its parts' medians."""
    quartiles = np.quantile([row["seconds"] for row in rows], [0.25, 0.5, 0.75]).tolist()
    parts = {name: float(np.median([row[name] for row in rows])) for name, _ in COST_PARTS}
    names = ("seconds_low", "seconds", "seconds_high")
    return {**dict(zip(names, quartiles, strict=True)), **parts, "recognitions": len(rows)}


def _loss(reference: Cell | None, cell: Cell, run: ExperimentParameters) -> Row:
    lost = None if reference is None else accuracy_gain(reference, cell, run)
    if cell is reference:
        lost = Interval(0.0, 0.0, 0.0)
    ends = (None, None, None) if lost is None else (lost.mean, lost.low, lost.high)
    return dict(zip(("lost", "lost_low", "lost_high"), ends, strict=True))


def _same_objects(first: Cell, second: Cell) -> bool:
    return bool(first.objects) and first.objects == second.objects


def _draw_objects(run: ExperimentParameters) -> np.random.Generator:
    """Give the same draws of objects for all, so that equal figures have equal intervals."""
    return spawn_generator(run.seed, "studies")
