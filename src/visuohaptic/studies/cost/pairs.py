"""Which settings of a study differ significantly, in time and in accuracy, on the same objects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyarrow as pa

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.intervals import Interval, compare_paired, difference_interval, holm
from visuohaptic.seeds import spawn_generator
from visuohaptic.studies.figures import Cell, CellKey

Row = dict[str, Any]
"""Of `tables.COST`."""

Setting = tuple[str, str]
"""Family and name."""

Turn = tuple[str, int]
"""An object, and the turn in which it was timed."""


@dataclass(frozen=True)
class SettingPairs:
    """Which settings differ significantly: by comparisons of the same objects, at the run's confidence.

    Attributes
    ----------
    cells : mapping
        As `studies.figures.read_cells` gives them.
    logarithms : mapping
        As `time_logarithms` gives them.
    run : ExperimentParameters
        The run's.
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
        quickest = min(known, key=lambda row: row["seconds"], default=None)
        return [
            row
            for row in known
            if quickest is not None and (row is quickest or self.time_ratio(quickest, row).low <= 0)
        ]

    def slower(self, rows: Sequence[Row], last: Row) -> list[Row]:
        """Give the settings that are significantly slower than the last step."""
        return [row for row in rows if is_known(row) and self.time_ratio(last, row).low > 0]

    def more_accurate(self, rows: Sequence[Row], last: Row) -> list[Row]:
        """Give the settings that are significantly more accurate than the last step.

        By the sign-change test over objects; p values are adjusted for the number of settings (Holm).
        """
        before = self._cell(last)
        able = [row for row in rows if _same_objects(self._cell(row), before)]
        found = [
            compare_paired(
                self._cell(row).accuracy,
                before.accuracy,
                before.weights,
                self.run.recognition.intervals,
                draw_objects(self.run),
            )
            for row in able
        ]
        limit = 1 - self.run.recognition.intervals.confidence
        adjusted = holm([one.p_value for one in found])
        return [
            row
            for row, one, p_value in zip(able, found, adjusted, strict=True)
            if one.difference.mean > 0 and p_value <= limit
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


def setting_of(row: Row) -> Setting:
    """Give the key of a row."""
    return row["family"], row["setting"]


def by_setting(seconds: pa.Table) -> dict[Setting, list[Row]]:
    """Give the rows of `tables.COST_SECONDS` of each setting."""
    found: dict[Setting, list[Row]] = {}
    for row in seconds.to_pylist():
        found.setdefault(setting_of(row), []).append(row)
    return found


def is_known(row: Row) -> bool:
    """Tell whether a setting could be both run and timed."""
    return row["seconds"] is not None and row["error"] is not None


def _same_objects(first: Cell, second: Cell) -> bool:
    return bool(first.objects) and first.objects == second.objects


def accuracy_gain(first: Cell, second: Cell, run: ExperimentParameters) -> Interval | None:
    """Give how much more accurate the first is, where both name the same objects."""
    if not _same_objects(first, second):
        return None
    intervals = run.recognition.intervals
    return difference_interval(
        first.accuracy, second.accuracy, second.weights, intervals, draw_objects(run)
    )


def draw_objects(run: ExperimentParameters) -> np.random.Generator:
    """Give the same draws of objects for all, so that equal figures have equal intervals."""
    return spawn_generator(run.seed, "studies")
