"""Accuracies of turned objects in rows, by pose, known part of the frame, and number of touches."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from turned.kept import HEADLINE_TOUCHES, KNOWN, TurnedCell, TurnedSet
from turned.study import STRATEGIES, Known
from visuohaptic.base.arrays import BoolArray
from visuohaptic.base.errors import ReportError
from visuohaptic.evaluation.intervals import class_interval, compare_differences, object_interval
from visuohaptic.geometry.turning import Turns
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.estimates import Estimate, estimate, lead
from visuohaptic.report.wording import POSES

FRAMES_OF_POSES: tuple[tuple[Turns, Known], ...] = (
    ("none", "full"),
    ("vertical", "vertical"),
    ("any", "centre"),
    ("any", "none"),
)
"""Turns and known part of the frame, for objects turned about exactly the unknown part."""


class CellName(NamedTuple):
    """The name of a cell of pipeline `order_free`."""

    turns: Turns
    known: Known
    touches: int
    strategy: str


@dataclass(frozen=True)
class TurnedRow:
    """The accuracies of a pipeline on objects in one pose, with one known part of their frame.

    Each figure is a mean over the objects in `tested`, and is computed on first use.

    Attributes
    ----------
    turns, known, touches, pipeline
        Pose, known part of the frame, touches per sequence and pipeline of all `cells`.
    cells : mapping of str to TurnedCell
        The accuracies by strategy.
    classes : tuple of str
        The class of each of o objects.
    tested : ndarray of shape (o,), bool
        Whether an object counts and was tested with all strategies.
    intervals : IntervalParameters
        The confidence of the intervals.
    """

    turns: Turns
    known: Known
    touches: int
    pipeline: str
    cells: Mapping[str, TurnedCell]
    classes: tuple[str, ...]
    tested: BoolArray
    intervals: IntervalParameters

    @property
    def draws(self) -> int:
        """The number of draws of the turns; an object's accuracy is the mean over the draws."""
        return self.cells["fixation"].draws

    @property
    def objects(self) -> int:
        """The number of tested objects."""
        return int(self.tested.sum())

    @cached_property
    def fixation(self) -> Estimate:
        """The accuracy of touches by fixation."""
        cells = [self.cells["fixation"]]
        return _figure(cells, [], self.intervals, self.classes, self.tested)


def turned_rows(kept: TurnedSet, intervals: IntervalParameters) -> list[TurnedRow]:
    """Return the accuracies in the full frame, one row per pose and pipeline, the paper's pipeline first."""
    chosen = ("full", HEADLINE_TOUCHES)
    cells = [cell for cell in kept.cells if (cell.known, cell.touches) == chosen]
    counted = np.ones(len(kept.objects), dtype=np.bool_)
    return list(_rows(cells, intervals, kept.classes, counted))


def frame_rows(kept: TurnedSet, intervals: IntervalParameters) -> list[TurnedRow]:
    """Return the accuracies of pipeline `order_free`, one row per pose and known part of the frame.

    Means are over the objects in `kept.held_out`.
    """
    chosen = ("order_free", HEADLINE_TOUCHES)
    cells = [cell for cell in kept.cells if (cell.pipeline, cell.touches) == chosen]
    return list(_rows(cells, intervals, kept.classes, kept.held_out))


def curve_rows(kept: TurnedSet, intervals: IntervalParameters) -> list[TurnedRow]:
    """Return the accuracies of pipeline `order_free` by number of touches per sequence.

    Only poses and frames that were measured with several numbers of touches have rows. Means are over the objects in
    `kept.held_out` that were tested with each number of touches and each strategy.
    """
    cells = [cell for cell in kept.cells if cell.pipeline == "order_free"]
    longer = {(cell.turns, cell.known) for cell in cells if cell.touches > HEADLINE_TOUCHES}
    chosen = [cell for cell in cells if (cell.turns, cell.known) in longer]
    return list(_rows(chosen, intervals, kept.classes, _tested(chosen, kept.held_out)))


def _rows(
    cells: Sequence[TurnedCell],
    intervals: IntervalParameters,
    classes: tuple[str, ...],
    counted: BoolArray,
) -> Iterator[TurnedRow]:
    """Yield one row per pose, frame, touches and pipeline that has all strategies; `counted` (o,) selects objects."""
    rows: dict[tuple[Turns, Known, int, str], dict[str, TurnedCell]] = {}
    for cell in cells:
        key = cell.turns, cell.known, cell.touches, cell.pipeline
        rows.setdefault(key, {})[cell.strategy] = cell
    for turns, known, touches, pipeline in sorted(rows, key=_sorting_key):
        by_strategy = rows[turns, known, touches, pipeline]
        if len(by_strategy) < len(STRATEGIES):
            continue
        tested = _tested(list(by_strategy.values()), counted)
        yield TurnedRow(turns, known, touches, pipeline, by_strategy, classes, tested, intervals)


def _sorting_key(row: tuple[Turns, Known, int, str]) -> tuple[object, ...]:
    """Return a sorting key: pose, the paper's pipeline first, frame from all to nothing known, and touches."""
    turns, known, touches, pipeline = row
    return list(POSES).index(turns), pipeline != "paper", list(KNOWN).index(known), touches


def contrast(
    kept: TurnedSet,
    plus: Sequence[CellName],
    minus: Sequence[CellName],
    intervals: IntervalParameters,
) -> Estimate:
    """Compute a sum of accuracies minus another sum, paired over objects, with its interval.

    Parameters
    ----------
    kept : TurnedSet
        The kept accuracies; the mean is over the objects in `kept.held_out` that all cells tested.
    plus, minus : sequence of CellName
        The cells of pipeline `order_free` that are added and subtracted.
    intervals : IntervalParameters
        The confidence.

    Raises
    ------
    ReportError
        If a cell is not kept.
    """
    cells = {
        CellName(cell.turns, cell.known, cell.touches, cell.strategy): cell
        for cell in kept.cells
        if cell.pipeline == "order_free"
    }
    missing = [name for name in (*plus, *minus) if name not in cells]
    if missing:
        raise ReportError(
            f"No accuracy of turned objects is kept for {' '.join(map(str, missing[0]))}."
        )
    added, subtracted = ([cells[name] for name in names] for names in (plus, minus))
    return _figure(added, subtracted, intervals, kept.classes, kept.held_out)


def _tested(cells: Sequence[TurnedCell], counted: BoolArray) -> BoolArray:
    """Return whether an object counts and was tested in all cells, shape (o,)."""
    accuracies = np.array([cell.accuracy for cell in cells])
    return np.isfinite(accuracies).all(axis=0) & counted


def _figure(
    plus: Sequence[TurnedCell],
    minus: Sequence[TurnedCell],
    intervals: IntervalParameters,
    classes: Sequence[str],
    counted: BoolArray,
) -> Estimate:
    """Compute a sum of accuracies minus another sum, over the objects that count and that all cells tested."""
    added, subtracted = (np.array([cell.accuracy for cell in cells]) for cells in (plus, minus))
    values = added.sum(axis=0) - (subtracted.sum(axis=0) if len(minus) else 0.0)
    tested = _tested([*plus, *minus], counted)
    weights = plus[0].weights
    bounds = (-float(len(minus)), float(len(plus)))
    of_tested = np.array(classes)[tested]
    chosen = values[tested], weights[tested]
    if minus:
        return lead(compare_differences(*chosen, intervals, bounds, of_tested))
    return estimate(
        object_interval(*chosen, intervals, bounds),
        class_interval(*chosen, of_tested, intervals, bounds),
    )
