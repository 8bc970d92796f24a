"""Summarise study eye_and_touch: accuracy, calibration, paired gains and robot time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
import pyarrow as pa

from eye_and_touch.seeing import SIGHTS
from eye_and_touch.sensing import BLIND, STRATEGIES, compared
from eye_and_touch.study import (
    CHECKED,
    CLEAN,
    CUES,
    LOOK,
    PRODUCT,
    SIDE_BY_SIDE,
    STOPPING,
    TOUCH,
)
from visuohaptic.evaluation.by_object import average_by_object
from visuohaptic.evaluation.intervals import compare_paired, object_interval
from visuohaptic.parameters import CostParameters
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.studies.figures import (
    Cell,
    Row,
    ends,
    paired_with_classes,
    rows_by,
)
from visuohaptic.tables.phases import owners_of
from visuohaptic.tables.schema import matrix

Key = tuple[str, str, str, int, float | None]
"""Sight, answer, strategy, touches and budget, as in `EYE_AND_TOUCH`."""

FUSED = (PRODUCT, CHECKED, SIDE_BY_SIDE)
"""Answers of both senses."""


@dataclass(frozen=True)
class SenseCell(Cell):
    """Accuracy per object, mean robot time and calibration error of one key of the table.

    The calibration error is the mean, weighted by trials, of the absolute difference between accuracy and stated
    probability in ten bins of probability (M. P. Naeini et al., AAAI 2015).
    """

    seconds: float = np.nan
    calibration_error: float = np.nan


def cells_of(table: pa.Table) -> dict[Key, SenseCell]:
    """Return a cell per key: the rows of `EYE_AND_TOUCH` of each object, averaged over the splits that tested it."""
    keys = ("sight", "answer", "strategy", "touches", "budget")
    return {key: _cell(rows) for key, rows in rows_by(table, keys).items()}


def _cell(rows: pa.Table) -> SenseCell:
    found, share = average_by_object(rows, "trials")
    trials, seconds = matrix(rows, ["trials", "seconds"]).T
    gaps = np.abs(np.sum(rows.column("gaps").to_pylist(), axis=0))
    return SenseCell(
        *(found.objects, found.accuracy, found.weights),
        seconds=float(share @ seconds / share.sum()),
        calibration_error=float(gaps.sum() / trials.sum()),
    )


def sum_up_senses(
    table: pa.Table, cost: CostParameters, touches: int, intervals: IntervalParameters
) -> Row:
    """Summarise `EYE_AND_TOUCH` for the report and the README.

    Parameters
    ----------
    table : pyarrow.Table
        Rows of `EYE_AND_TOUCH`.
    cost : CostParameters
        Prices of a look and a touch, and budgets, in seconds.
    touches : int
        Touches with which the senses are compared in every sight.
    intervals : IntervalParameters
        Settings of intervals and paired tests.

    Returns
    -------
    dict
        ``sights``: answers in every sight with their gains; ``curves``: accuracy against time; ``budgets``: accuracy
        within each budget; ``worth``: the largest gain per second of touching after a look. Also prices and counts.
    """
    summary = _Summary(cells_of(table), cost, touches, intervals)
    return {
        "prices": cost.model_dump(include={"look_seconds", "touch_seconds", "budgets"}),
        "touches": touches,
        "objects": len(set(owners_of(table))),
        "sights": [summary.sight(sight) for sight in SIGHTS],
        "curves": summary.curves(),
        "budgets": [row for budget in cost.budgets for row in summary.at_budget(budget)],
        "worth": [summary.worth(sight) for sight in SIGHTS],
    }


@dataclass(frozen=True)
class _Summary:
    cells: Mapping[Key, SenseCell]
    cost: CostParameters
    touches: int
    intervals: IntervalParameters

    def key(self, sight: str, answer: str, strategy: str = STRATEGIES[0], touches: int = 0) -> Key:
        """Return the key of an answer; cues have no touches, and touch is only in clean sight."""
        if answer in CUES:
            return (sight, answer, "none", 0, None)
        seen = CLEAN if answer == TOUCH else sight
        return (seen, answer, strategy, touches or self.touches, None)

    def row(self, key: Key) -> Row:
        """Return accuracy with its interval, robot time and calibration error."""
        cell = self.cells[key]
        interval = object_interval(cell.accuracy, cell.weights, self.intervals)
        return {
            **ends("accuracy", "", interval),
            "seconds": cell.seconds,
            "calibration_error": cell.calibration_error,
        }

    def gain(self, first: Cell, second: Cell, over: str) -> Row:
        """Return the gain of the first cell over the second with both intervals, paired over objects; `over` names the second."""
        classes = [category for category, _ in first.objects]
        comparison = compare_paired(
            first.accuracy, second.accuracy, first.weights, self.intervals, classes
        )
        return {"over": over, **paired_with_classes("difference", "p_value", comparison)}

    def sight(self, sight: str) -> Row:
        """Return the answers of all senses in one sight, and their gains over the better sense."""
        keys = {answer: self.key(sight, answer) for answer in (*CUES, TOUCH, *FUSED)}
        cells = {answer: self.cells[key] for answer, key in keys.items()}
        better = max((LOOK, TOUCH), key=lambda answer: cells[answer].mean)
        return {
            "sight": sight,
            "answers": {answer: self.row(key) for answer, key in keys.items()},
            "gains": {
                **{answer: self.gain(cells[answer], cells[better], better) for answer in FUSED},
                TOUCH: self.gain(cells[TOUCH], cells[LOOK], LOOK),
            },
        }

    def curves(self) -> list[Row]:
        """Return accuracy and time of every strategy in clean sight, for looking, touch and both."""
        keys = (key for key in self.cells if key[0] == CLEAN and key[1] in {LOOK, TOUCH, CHECKED})
        return [self._named(key) for key in sorted(keys, key=str)]

    def at_budget(self, budget: float) -> Iterator[Row]:
        """Yield the rows within a budget: fixed numbers of touches, and the rule that stops (on average)."""
        if budget >= self.cost.look_seconds:
            yield {"budget": budget, **self._named(self.key(CLEAN, LOOK))}
        most = max(key[3] for key in self.cells)
        for strategy in compared(self.cost):
            for answer in (TOUCH, CHECKED):
                count = min(self._affordable(budget, answer, strategy), most)
                if count > 0:
                    key = self.key(CLEAN, answer, strategy, count)
                    yield {"budget": budget, **self._named(key)}
            stops = (CLEAN, STOPPING, strategy, most, budget)
            stopped = self.cells[stops]
            fixed = self.fixed(strategy, stopped.seconds)
            gain = self.gain(stopped, fixed, f"{stopped.seconds:.1f} s")
            yield {"budget": budget, **self._named(stops), "gain": gain}

    def fixed(self, strategy: str, seconds: float) -> Cell:
        """Interpolate accuracy after a look and a fixed number of touches at a time, between the two nearest numbers."""
        keys = [self.key(CLEAN, LOOK)]
        keys += sorted(key for key in self.cells if key[:3] == (CLEAN, CHECKED, strategy))
        line = [self.cells[key] for key in keys]
        later = next(
            (index for index, cell in enumerate(line) if cell.seconds >= seconds), len(line) - 1
        )
        first, second = line[max(later - 1, 0)], line[later]
        step = second.seconds - first.seconds
        share = min((seconds - first.seconds) / step, 1.0) if step else 0.0
        mixed = (1 - share) * first.accuracy + share * second.accuracy
        return replace(first, accuracy=mixed)

    def worth(self, sight: str) -> Row:
        """Return the number of touches after a look with the largest gain per second in a sight, and this gain."""
        look = self.cells[self.key(sight, LOOK)]
        rises = {
            key[3]: (cell.mean - look.mean) / (cell.seconds - look.seconds)
            for key, cell in self.cells.items()
            if key[:3] == (sight, CHECKED, STRATEGIES[0])
        }
        touches = max(rises, key=lambda count: (rises[count], -count))
        return {"sight": sight, "touches": touches, "accuracy_a_second": rises[touches]}

    def _named(self, key: Key) -> Row:
        _, answer, strategy, touches, _ = key
        names = {"answer": answer, "strategy": strategy, "touches": touches}
        return {**names, **self.row(key)}

    def _affordable(self, budget: float, answer: str, strategy: str) -> int:
        """Return how many touches a budget allows."""
        paid = 0.0 if (answer, strategy) == (TOUCH, BLIND) else self.cost.look_seconds
        return int((budget - paid) // self.cost.touch_seconds)
