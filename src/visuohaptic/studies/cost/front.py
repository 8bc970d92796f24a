"""Which settings are worth their time: the Pareto front of seconds and error rate, and paired comparisons."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.parameters import CostParameters, ExperimentParameters
from visuohaptic.recognition.intervals import Interval, compare_paired, difference_interval, holm
from visuohaptic.seeds import spawn_generator
from visuohaptic.studies.cost.settings import ORDER, Setting, is_reference, make_settings
from visuohaptic.studies.figures import Cell, condition_interval, ends, read_cells
from visuohaptic.studies.study import Given
from visuohaptic.tables.schema import build_rows, names_of, read_table, write_table
from visuohaptic.tables.studies import COST, COST_PARTS, COST_SECONDS

Row = dict[str, Any]
"""Of `tables.COST`."""

_OF_SETTING = (
    *("family", "place", "touches", "viewpoints", "looks", "strategy", "pipeline", "classifier"),
)
_TIMES = ("seconds", *(name for name, _ in COST_PARTS))

POINT = 0.01
"""A loss of accuracy that does not matter to most users."""


def make_cost(given: Given) -> None:
    """Join error rates and seconds of all settings, and mark the front: `tables.COST`."""
    run, settings = given.run, make_settings(given.run, given.study)
    found = read_cells(given.inputs["blocks"])
    cells = [
        found[one.condition.name, one.pipeline, one.strategy, one.classifier] for one in settings
    ]
    times = setting_times(settings, read_table(COST_SECONDS, given.inputs["tables"]))
    rows = setting_rows(settings, cells, times, run)
    slower = slower_settings(np.log(times[..., 0]), run.recognition.intervals.confidence)
    mark_steps(rows, cells, slower, run)
    mark_groups(rows, cells, slower, run)
    write_table(COST, build_rows(COST, rows), given.outputs[0])


def pareto_front(seconds: NDArray[np.float64], errors: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Tell which points no other beats: at most as slow, at most as wrong, and one of both less.

    Shape (n,) each; a point with a NaN is never on the front.
    """
    no_slower = seconds[None, :] <= seconds[:, None]
    no_worse = errors[None, :] <= errors[:, None]
    better = (seconds[None, :] < seconds[:, None]) | (errors[None, :] < errors[:, None])
    beaten = (no_slower & no_worse & better).any(axis=1)
    return ~beaten & np.isfinite(seconds) & np.isfinite(errors)


def setting_times(settings: Sequence[Setting], seconds: pa.Table) -> NDArray[np.float64]:
    """Give `tables.COST_SECONDS` by setting, object and turn: (s, o, t, p), NaN where there is none.

    The first of p is the whole recognition, the others are `COST_PARTS`.
    """
    timed = seconds.to_pylist()
    places = {(one.family, one.name): place for place, one in enumerate(settings)}
    objects = {key: place for place, key in enumerate(sorted({row["object"] for row in timed}))}
    turns = max((row["turn"] for row in timed), default=0) + 1
    found = np.full((len(settings), len(objects), turns, len(_TIMES)), np.nan)
    for row in timed:
        at = places[row["family"], row["setting"]], objects[row["object"]], row["turn"]
        found[at] = [row[name] for name in _TIMES]
    return found


def setting_rows(
    settings: Sequence[Setting],
    cells: Sequence[Cell],
    times: NDArray[np.float64],
    run: ExperimentParameters,
) -> list[Row]:
    """Give each setting with its error rate, its seconds, and whether it is on the front.

    Rows have no steps, and each is in a group of its own.
    """
    reference = next(
        (cell for one, cell in zip(settings, cells, strict=True) if is_reference(one, run)), None
    )
    rows = [
        {
            **dict.fromkeys(names_of(COST.columns)),
            **{name: getattr(setting, name) for name in _OF_SETTING},
            "setting": setting.name,
            "changes": setting.written_changes,
            **error_rate(cell, run),
            **ends("lost", "lost_", _loss(reference, cell, run)),
            **time_quantiles(own),
            "as_quick": False,
            "step": False,
            "group": place,
        }
        for place, (setting, cell, own) in enumerate(zip(settings, cells, times, strict=True))
    ]
    return mark_front(rows)


def error_rate(cell: Cell, run: ExperimentParameters) -> Row:
    """Give the share of recognitions that are wrong, its interval over objects, and their number."""
    if cell.error is not None:
        return {"failed": cell.error}
    wrong = replace(cell, accuracy=1 - cell.accuracy)
    found = condition_interval(wrong, run.recognition.intervals, run.seed)
    clipped = Interval(*(min(max(rate, 0.0), 1.0) for rate in vars(found).values()))
    return {**ends("error", "error_", clipped), "objects": len(cell.objects)}


def time_quantiles(times: NDArray[np.float64]) -> Row:
    """Give the median and quartiles of a setting's seconds, and its parts' medians: of (o, t, p)."""
    known = times[np.isfinite(times[..., 0])]
    if not len(known):
        return {}
    low, median, high = np.quantile(known[:, 0], [0.25, 0.5, 0.75]).tolist()
    values = (median, *np.median(known[:, 1:], axis=0).tolist(), low, high, len(known))
    names = (*_TIMES, "seconds_low", "seconds_high", "recognitions")
    return dict(zip(names, values, strict=True))


def mark_steps(
    rows: Sequence[Row],
    cells: Sequence[Cell],
    slower: NDArray[np.bool_],
    run: ExperimentParameters,
) -> None:
    """Mark the settings that are worth their time; `slower` is as `slower_settings` gives it.

    The first step is the most accurate of the settings that are as quick as the quickest. Each
    further step is significantly slower and significantly more accurate than the step before: of
    those that are as quick as the quickest such setting, it is the most accurate.
    """

    def as_quick(places: Sequence[int]) -> list[int]:
        quickest = min(places, key=lambda place: float(rows[place]["seconds"]), default=0)
        return [place for place in places if not slower[quickest, place]]

    known = [place for place, row in enumerate(rows) if is_known(row)]
    quick = as_quick(known)
    for place in quick:
        rows[place]["as_quick"] = True
    while quick:
        step = min(quick, key=lambda place: float(rows[place]["error"]))
        rows[step]["step"] = True
        later = [place for place in known if slower[step, place]]
        better = more_accurate([cells[place] for place in later], cells[step], run)
        quick = as_quick([later[place] for place in better])


def mark_groups(
    rows: Sequence[Row],
    cells: Sequence[Cell],
    slower: NDArray[np.bool_],
    run: ExperimentParameters,
) -> None:
    """Give each setting the number of the first group where it differs from none in time or in error."""

    def are_alike(first: int, second: int) -> bool:
        if not (is_known(rows[first]) and is_known(rows[second])):
            return False
        if slower[first, second] or slower[second, first]:
            return False
        gain = accuracy_gain(cells[second], cells[first], run)
        return gain is not None and gain.low <= 0 <= gain.high

    groups: dict[int, list[int]] = {}
    for place, row in enumerate(rows):
        fitting = (
            number
            for number, group in groups.items()
            if all(are_alike(one, place) for one in group)
        )
        row["group"] = next(fitting, len(groups))
        groups.setdefault(row["group"], []).append(place)


def slower_settings(logarithms: NDArray[np.float64], confidence: float) -> NDArray[np.bool_]:
    """Tell which settings are significantly slower than which: (s, o, t) to (s, s), the slower second.

    An object's ratio of two times is the mean over the turns in which both were taken. Student's
    interval of the objects' ratios is above 1; with fewer than two objects none is.
    """
    from scipy.special import stdtrit

    ratios = np.ma.masked_invalid(logarithms[None] - logarithms[:, None]).mean(axis=3)
    objects = ratios.count(axis=2)
    quantile = stdtrit(np.maximum(objects - 1, 1), (1 + confidence) / 2)
    reach = quantile * ratios.std(axis=2, ddof=1) / np.sqrt(np.maximum(objects, 1))
    return (np.ma.filled(ratios.mean(axis=2) - reach, 0) > 0) & (objects > 1)


def more_accurate(cells: Sequence[Cell], last: Cell, run: ExperimentParameters) -> list[int]:
    """Give the places of the settings that are significantly more accurate than the last step.

    By the sign-change test over objects; p values are adjusted for the number of settings (Holm).
    """
    intervals = run.recognition.intervals
    places = [place for place, cell in enumerate(cells) if _same_objects(cell, last)]
    found = [
        compare_paired(
            cells[place].accuracy, last.accuracy, last.weights, intervals, _draw_objects(run)
        )
        for place in places
    ]
    adjusted = holm([one.p_value for one in found])
    return [
        place
        for place, one, p_value in zip(places, found, adjusted, strict=True)
        if one.difference.mean > 0 and p_value <= 1 - intervals.confidence
    ]


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
    return sorted(rows, key=lambda row: (ORDER.index(row["family"]), row["place"]))


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
        """Whether it surely costs less than `POINT`, has no clear difference from the run's own, or surely costs."""
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

    return mark_front([moved(row) for row in rows])


def mark_front(rows: list[Row]) -> list[Row]:
    """Mark which rows are on the front, which are dominated, and which, without figures, are neither."""
    points = [[row[name] for row in rows] for name in ("seconds", "error")]
    for row, on in zip(rows, pareto_front(*np.array(points, dtype=float)).tolist(), strict=True):
        row |= {"on_front": on, "dominated": is_known(row) and not on}
    return rows


def _loss(reference: Cell | None, cell: Cell, run: ExperimentParameters) -> Interval | None:
    if cell is reference:
        return Interval(0.0, 0.0, 0.0)
    return None if reference is None else accuracy_gain(reference, cell, run)


def _same_objects(first: Cell, second: Cell) -> bool:
    return bool(first.objects) and first.objects == second.objects


def _draw_objects(run: ExperimentParameters) -> np.random.Generator:
    """Give the same draws of objects for all, so that equal figures have equal intervals."""
    return spawn_generator(run.seed, "studies")
