"""Which settings are worth their time: the Pareto front of seconds and error rate, and paired comparisons."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.parameters import CostParameters, ExperimentParameters
from visuohaptic.recognition.intervals import Interval, PairedComparison, compare_paired, holm
from visuohaptic.seeds import spawn_generator
from visuohaptic.studies.cost.settings import ORDER, Setting, make_settings
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


def make_cost(given: Given) -> None:
    """Join error rates and seconds of all settings, and mark the front: `tables.COST`."""
    run, settings = given.run, make_settings(given.run, given.study)
    found = read_cells(given.inputs["blocks"])
    cells = [
        found[one.condition.name, one.pipeline, one.strategy, one.classifier] for one in settings
    ]
    times = setting_times(settings, read_table(COST_SECONDS, given.inputs["tables"]))
    rows = setting_rows(settings, cells, times, run)
    write_table(COST, build_rows(COST, rows), given.outputs[0])


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
    """Give each setting with its error rate and seconds, and mark the front and the steps.

    Errors are compared with those of the first setting that is the run's own, from one viewpoint.
    """
    own = next((place for place, one in enumerate(settings) if one.is_own(run)), None)
    slower = slower_settings(np.log(times[..., 0]), run.recognition.intervals.confidence)
    rows = [
        {
            **dict.fromkeys(names_of(COST.columns)),
            **{name: getattr(setting, name) for name in _OF_SETTING},
            "setting": setting.name,
            "changes": setting.written_changes,
            **error_rate(cells[place], run),
            **ends("lost", "lost_", _loss(cells, place, own, run)),
            **time_quantiles(times[place]),
            "quicker": own is not None and bool(slower[place, own]),
        }
        for place, setting in enumerate(settings)
    ]
    return mark_front(mark_steps(rows, cells, slower, run))


def error_rate(cell: Cell, run: ExperimentParameters) -> Row:
    """Give the share of recognitions that are wrong, its interval over objects, and their number."""
    if cell.error is not None:
        return {"failed": cell.error}
    wrong = replace(cell, accuracy=1 - cell.accuracy)
    found = condition_interval(wrong, run.recognition.intervals, run.seed)
    clipped = Interval(*(min(max(rate, 0.0), 1.0) for rate in vars(found).values()))
    return {**ends("error", "error_", clipped), "objects": len(cell.objects)}


def _loss(
    cells: Sequence[Cell], place: int, own: int | None, run: ExperimentParameters
) -> Interval | None:
    if place == own:
        return Interval(0.0, 0.0, 0.0)
    found = None if own is None else _compare(cells[own], cells[place], run)
    return found.difference if found else None


def _compare(first: Cell, second: Cell, run: ExperimentParameters) -> PairedComparison | None:
    """Compare cells that name the same objects; all with the same draws, so that equal ones stay equal."""
    if not first.objects or first.objects != second.objects:
        return None
    draws = spawn_generator(run.seed, "studies")
    intervals = run.recognition.intervals
    return compare_paired(first.accuracy, second.accuracy, second.weights, intervals, draws)


def time_quantiles(times: NDArray[np.float64]) -> Row:
    """Give the median and quartiles of a setting's seconds, and its parts' medians: of (o, t, p)."""
    known = times[np.isfinite(times[..., 0])]
    if not len(known):
        return {}
    low, median, high = np.quantile(known[:, 0], [0.25, 0.5, 0.75]).tolist()
    values = (median, *np.median(known[:, 1:], axis=0).tolist(), low, high, len(known))
    names = (*_TIMES, "seconds_low", "seconds_high", "recognitions")
    return dict(zip(names, values, strict=True))


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


def mark_steps(
    rows: Sequence[Row],
    cells: Sequence[Cell],
    slower: NDArray[np.bool_],
    run: ExperimentParameters,
) -> Sequence[Row]:
    """Mark the settings that are worth their time; `slower` is as `slower_settings` gives it.

    The first step is the most accurate of those that are as quick as the quickest. So is each further
    one, of the settings that are significantly slower and more accurate than the step before.
    """

    def as_quick(places: Sequence[int]) -> list[int]:
        quickest = min(places, key=lambda place: float(rows[place]["seconds"]), default=0)
        return [place for place in places if not slower[quickest, place]]

    known = [place for place, row in enumerate(rows) if _is_known(row)]
    quick = as_quick(known)
    for place, row in enumerate(rows):
        row |= {"as_quick": place in quick, "step": False}
    while quick:
        step = min(quick, key=lambda place: float(rows[place]["error"]))
        rows[step]["step"] = True
        later = [place for place in known if slower[step, place]]
        better = more_accurate([cells[place] for place in later], cells[step], run)
        quick = as_quick([later[place] for place in better])
    return rows


def more_accurate(cells: Sequence[Cell], last: Cell, run: ExperimentParameters) -> list[int]:
    """Give the places of the settings that are significantly more accurate than the last step.

    By the sign-change test over objects; p values are adjusted for the number of settings (Holm).
    """
    compared = [(place, _compare(cell, last, run)) for place, cell in enumerate(cells)]
    found = [(place, one) for place, one in compared if one]
    adjusted = holm([one.p_value for _, one in found])
    return [
        place
        for (place, one), p_value in zip(found, adjusted, strict=True)
        if one.difference.mean > 0 and p_value <= 1 - run.recognition.intervals.confidence
    ]


def mark_front(rows: Sequence[Row]) -> list[Row]:
    """Mark which rows are on the front, which are dominated, and which, without figures, are neither.

    On the front no other is at most as slow, at most as wrong, and one of both less.
    """
    points = [[row[name] for row in rows] for name in ("seconds", "error")]
    seconds, errors = np.array(points, dtype=np.float64)
    no_slower, no_worse = seconds <= seconds[:, None], errors <= errors[:, None]
    better = (seconds < seconds[:, None]) | (errors < errors[:, None])
    beaten = (no_slower & no_worse & better).any(axis=1).tolist()
    return [
        {**row, "on_front": _is_known(row) and not one, "dominated": _is_known(row) and one}
        for row, one in zip(rows, beaten, strict=True)
    ]


def _is_known(row: Row) -> bool:
    return row["seconds"] is not None and row["error"] is not None


def read_costs(path: str | Path) -> list[Row]:
    """Read `tables.COST` as rows, family by family, each along its line."""
    rows: list[Row] = read_table(COST, path).to_pylist()
    return sorted(rows, key=lambda row: (ORDER.index(row["family"]), row["place"]))


def front_rows(rows: Sequence[Row]) -> list[Row]:
    """Give the rows on the front, the fastest first; of rows that are equal, the first alone."""
    front = sorted((row for row in rows if row["on_front"]), key=lambda row: float(row["seconds"]))
    # Of rows that are as fast, those on the front have one error rate.
    return list({row["seconds"]: row for row in reversed(front)}.values())[::-1]


def first_step(rows: Sequence[Row]) -> Row | None:
    """Give the most accurate of the settings that are as quick as the quickest."""
    return next((row for row in rows if row["step"] and row["as_quick"]), None)


def reference_row(rows: Sequence[Row]) -> Row | None:
    """Give the row of the run's own setting from one viewpoint, if it is among the rows."""
    return next((row for row in rows if row["lost_low"] == 0 == row["lost_high"]), None)


def all_touches(row: Row) -> int:
    """Give the touches of a recognition from all its viewpoints."""
    return int(row["touches"] * row["viewpoints"])


def find_savings(rows: Sequence[Row]) -> list[Row]:
    """Give the quicker ways to look and touch, with the share of the run's own seconds that is ``saved``.

    They look, touch or describe otherwise, with as many touches from as many viewpoints, and are
    significantly quicker; the largest saving first.
    """
    own = reference_row(rows)
    found = [
        {**row, "saved": 1 - row["seconds"] / own["seconds"]}
        for row in rows
        if own
        and row["quicker"]
        and row["lost_high"] is not None
        and row["changes"] != "{}"
        and not any(name.startswith("recognition.") for name in json.loads(row["changes"]))
        and (row["touches"], row["viewpoints"]) == (own["touches"], own["viewpoints"])
    ]
    return sorted(found, key=lambda row: -float(row["saved"]))


def on_robot(rows: Sequence[Row], cost: CostParameters) -> list[Row]:
    """Copy rows of `tables.COST` with the time of a robot, a price for each touch and look added, and its front."""

    def moved(row: Row) -> Row:
        price = cost.touch_seconds * all_touches(row) + cost.look_seconds * row["looks"]
        names = ("seconds", "seconds_low", "seconds_high")
        return {**row, **{name: row[name] + price for name in names if row[name] is not None}}

    return mark_front([moved(row) for row in rows])
