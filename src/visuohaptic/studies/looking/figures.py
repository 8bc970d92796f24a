"""Accuracies, calibration, paired gains and robot times of study looking, summed up."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.parameters import CostParameters
from visuohaptic.recognition.intervals import compare_paired, plain_interval, rate_interval
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.seeds import spawn_generator
from visuohaptic.studies.looking.seeing import SIGHTS
from visuohaptic.studies.looking.sensing import BLIND, STRATEGIES, compared
from visuohaptic.studies.looking.settings import (
    CHECKED,
    CLEAN,
    CUES,
    LOOK,
    PRODUCT,
    SIDE_BY_SIDE,
    STOPPING,
    TOUCH,
)
from visuohaptic.tables.phases import owners_of
from visuohaptic.tables.schema import matrix

Key = tuple[str, str, str, int, float | None]
"""Sight, answer, strategy, touches and budget, as in `tables.LOOKING`."""

FUSED = (PRODUCT, CHECKED, SIDE_BY_SIDE)
"""Answers of both senses."""


@dataclass(frozen=True)
class Cell:
    """One key of the table.

    Attributes
    ----------
    accuracy, weights : numpy.ndarray
        Shape (o,), float64: of each object; the weighted mean over objects is the mean over splits.
    seconds : float
        Mean time of the robot.
    calibration_error : float
        Mean over trials of how far the share that is right is from the stated probability, in each
        tenth of it (M. P. Naeini et al., AAAI 2015).
    """

    accuracy: NDArray[np.float64]
    weights: NDArray[np.float64]
    seconds: float
    calibration_error: float

    @property
    def mean(self) -> float:
        """The mean over splits."""
        return float(self.weights @ self.accuracy / self.weights.sum())


def cells_of(table: pa.Table) -> dict[Key, Cell]:
    """Average each object's rows of `tables.LOOKING` over the splits that tested it."""
    names = [table.column(name).to_pylist() for name in ("sight", "answer", "strategy")]
    counts = [table.column(name).to_pylist() for name in ("touches", "budget")]
    owners = owners_of(table)
    places = {owner: place for place, owner in enumerate(sorted(set(owners)))}
    owner = np.array([places[one] for one in owners])
    values = matrix(table, ["split", "repeat", "trials", "accuracy", "seconds"])
    gaps = np.stack(table.column("gaps").to_pylist())
    rows: dict[Key, list[int]] = {}
    for row, key in enumerate(zip(*names, *counts, strict=True)):
        rows.setdefault(key, []).append(row)
    return {key: _cell(owner[own], values[own], gaps[own]) for key, own in rows.items()}


def _cell(owner: NDArray[np.int64], values: NDArray[np.float64], gaps: NDArray[np.float64]) -> Cell:
    split, repeat, trials, accuracy, seconds = values.T
    _, run = np.unique(split * (repeat.max() + 1) + repeat, return_inverse=True)
    share = trials / np.bincount(run, weights=trials)[run]
    _, place = np.unique(owner, return_inverse=True)
    weights = np.bincount(place, weights=share).astype(np.float64)
    means = np.bincount(place, weights=share * np.rint(accuracy * trials) / trials) / weights
    error = np.abs(gaps.sum(axis=0)).sum() / trials.sum()
    return Cell(means, weights, float(share @ seconds / share.sum()), float(error))


def sum_up_looking(
    table: pa.Table, cost: CostParameters, touches: int, intervals: IntervalParameters, seed: int
) -> dict[str, Any]:
    """Sum up `tables.LOOKING`.

    Parameters
    ----------
    table : pyarrow.Table
        The table.
    cost : CostParameters
        The prices.
    touches : int
        Touches with which senses are compared in every sight.
    intervals : IntervalParameters
        How intervals are drawn.
    seed : int
        The experiment's seed.

    Returns
    -------
    dict
        ``prices``; ``sights``: each answer in each sight, and each answer of both senses against
        the better of its parts; ``curves``: accuracy against time in clean sight; ``budgets``: the
        same at each budget, with the rule that stops; ``worth``: what touching brings a second
        after a look, in each sight.
    """
    summary = _Summary(cells_of(table), cost, touches, intervals, seed)
    return {
        "prices": {**cost.model_dump(include={"look_seconds", "touch_seconds", "budgets"})},
        "touches": touches,
        "objects": len(set(owners_of(table))),
        "sights": [summary.sight(sight) for sight in SIGHTS],
        "curves": list(summary.curves()),
        "budgets": [row for budget in cost.budgets for row in summary.at_budget(budget)],
        "worth": [summary.worth(sight) for sight in SIGHTS],
    }


@dataclass(frozen=True)
class _Summary:
    cells: Mapping[Key, Cell]
    cost: CostParameters
    touches: int
    intervals: IntervalParameters
    seed: int

    def key(self, sight: str, answer: str, strategy: str = STRATEGIES[0], touches: int = -1) -> Key:
        """Give a key; a cue needs no touch, and touch no sight."""
        if answer in CUES or not touches:
            return (sight, answer if answer in CUES else LOOK, "none", 0, None)
        count = self.touches if touches < 0 else touches
        return (CLEAN if answer == TOUCH else sight, answer, strategy, count, None)

    def row(self, key: Key) -> dict[str, Any]:
        """Give accuracy with its interval, time and calibration error."""
        cell = self.cells[key]
        generator = spawn_generator(self.seed, "looking")
        interval = rate_interval(cell.accuracy, cell.weights, self.intervals, generator)
        ends = plain_interval(interval)
        return {
            "accuracy": ends["mean"],
            "low": ends["low"],
            "high": ends["high"],
            "seconds": cell.seconds,
            "calibration_error": cell.calibration_error,
        }

    def gain(self, first: Cell, second: Cell, over: str) -> dict[str, Any]:
        """Give what one cell gains over another, in pairs over objects."""
        generator = spawn_generator(self.seed, "looking", "comparison")
        found = compare_paired(
            first.accuracy, second.accuracy, first.weights, self.intervals, generator
        )
        ends = plain_interval(found.difference)
        return {
            "over": over,
            "difference": ends["mean"],
            "low": ends["low"],
            "high": ends["high"],
            "p_value": found.p_value,
        }

    def sight(self, sight: str) -> dict[str, Any]:
        """Compare the senses in one sight."""
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

    def curves(self) -> Iterator[dict[str, Any]]:
        """Give accuracy against time of every strategy in clean sight, touch alone and both."""
        for key in sorted(self.cells, key=str):
            sight, answer, strategy, touches, _ = key
            if sight == CLEAN and answer in {LOOK, TOUCH, CHECKED}:
                names = {"answer": answer, "strategy": strategy, "touches": touches}
                yield {**names, **self.row(key)}

    def at_budget(self, budget: float) -> Iterator[dict[str, Any]]:
        """Give what is reached within a budget: of a fixed number of touches, and by the rule on average."""
        if budget >= self.cost.look_seconds:
            yield {"budget": budget, "answer": LOOK, **self._named(self.key(CLEAN, LOOK))}
        for strategy in compared(self.cost):
            for answer in (TOUCH, CHECKED):
                if key := self._affordable(budget, answer, strategy):
                    yield {"budget": budget, "answer": answer, **self._named(key, strategy)}
            (stops,) = [
                key
                for key in self.cells
                if key[:3] == (CLEAN, STOPPING, strategy) and key[4] == budget
            ]
            stopped = self.cells[stops]
            fixed = self.fixed(strategy, stopped.seconds)
            gain = self.gain(stopped, fixed, f"{fixed.seconds:.1f} s")
            yield {"budget": budget, "answer": STOPPING, **self._named(stops), "gain": gain}

    def fixed(self, strategy: str, seconds: float) -> Cell:
        """Mix the two nearest numbers of touches after a look that are the same for all, so that they take as long."""
        keys = [self.key(CLEAN, LOOK)]
        keys += sorted(key for key in self.cells if key[:3] == (CLEAN, CHECKED, strategy))
        line = [self.cells[key] for key in keys]
        later = next((n for n, cell in enumerate(line) if cell.seconds >= seconds), len(line) - 1)
        first, second = line[max(later - 1, 0)], line[later]
        step = second.seconds - first.seconds
        share = min((seconds - first.seconds) / step, 1.0) if step else 0.0
        accuracy = (1 - share) * first.accuracy + share * second.accuracy
        return Cell(accuracy, first.weights, seconds, np.nan)

    def _named(self, key: Key, strategy: str | None = None) -> dict[str, Any]:
        return {"strategy": strategy or key[2], "touches": key[3], **self.row(key)}

    def _affordable(self, budget: float, answer: str, strategy: str) -> Key | None:
        """Name the most touches within a budget; None where there is time for none."""
        paid = 0.0 if (answer, strategy) == (TOUCH, BLIND) else self.cost.look_seconds
        count = int((budget - paid) // self.cost.touch_seconds)
        most = max(key[3] for key in self.cells)
        return self.key(CLEAN, answer, strategy, min(count, most)) if count > 0 else None

    def worth(self, sight: str) -> dict[str, Any]:
        """Find the number of touches after a look that brings most accuracy a second, in a sight."""
        look = self.cells[self.key(sight, LOOK)]
        touched = [key for key in self.cells if key[:3] == (sight, CHECKED, STRATEGIES[0])]
        rises = {
            key[3]: (cell.mean - look.mean) / (cell.seconds - look.seconds)
            for key in touched
            if (cell := self.cells[key])
        }
        touches = max(rises, key=lambda count: (rises[count], -count))
        return {"sight": sight, "touches": touches, "accuracy_a_second": rises[touches]}
