"""Kept accuracies of turned objects: measured once and stored with the package, by set of objects.

`make turned` measures them and writes `turned.json` beside this file (studies/turned/README.md).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib.resources import files
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np
from pydantic import BaseModel, ConfigDict

from visuohaptic.base.arrays import BoolArray, FloatArray
from visuohaptic.base.errors import ReportError
from visuohaptic.evaluation.intervals import class_interval, compare_differences, object_interval
from visuohaptic.geometry.turning import Turns
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.estimates import Figure, estimate, lead, read_json

KEPT = "turned.json"

POSES: Mapping[Turns, str] = {
    "none": "upright, facing one way",
    "vertical": "upright, turned about the vertical",
    "any": "turned in any way",
}
"""The poses of the objects in words, by `meshes.turns`."""

Known = Literal["statistics", "none", "centre", "vertical", "full", "trained_upright"]
"""The part of the object's frame that descriptors use: `recognition.frame`, `STATISTICS` or `TRAINED_UPRIGHT`."""

STATISTICS: Literal["statistics"] = "statistics"
"""Nothing of the frame is known; touches and pairs of touches are described only by statistics, without waves."""

TRAINED_UPRIGHT: Literal["trained_upright"] = "trained_upright"
"""The full frame is assumed, and the pipeline was fitted on objects that stand upright and face one way."""

KNOWN: Mapping[Known, str] = {
    "full": "all",
    "vertical": "centre and vertical",
    "centre": "centre",
    "none": "nothing",
    STATISTICS: "nothing, without waves",
    TRAINED_UPRIGHT: "all is assumed, fitted on upright objects",
}
"""The known part of the frame, in words."""

FRAMES_OF_POSES: tuple[tuple[Turns, Known], ...] = (
    ("none", "full"),
    ("vertical", "vertical"),
    ("any", "centre"),
    ("any", "none"),
)
"""Turns and known part of the frame, for objects turned about exactly the unknown part."""

STRATEGIES = ("fixation", "random", "random_visible")
"""Touches by fixation, at random places in reach, and at random places in sight."""

HEADLINE_TOUCHES = 5
"""Touches per sequence in the table beside the headline."""


class TurnedCell(BaseModel):
    """Accuracies per object, means over the draws of the turns; None where an object was not tested."""

    model_config = ConfigDict(frozen=True)

    turns: Turns
    known: Known
    touches: int
    pipeline: str
    strategy: str
    classifier: str
    draws: int
    accuracy: tuple[float | None, ...]
    weights: tuple[float | None, ...]


class TurnedSet(BaseModel):
    """The accuracies of one set of objects, ``class/name``, with commit and date (UTC) of the measurement.

    Descriptors and settings were chosen on the objects in `choosing`.
    """

    model_config = ConfigDict(frozen=True)

    commit: str
    date: str
    objects: tuple[str, ...]
    choosing: tuple[str, ...]
    cells: tuple[TurnedCell, ...]

    @property
    def classes(self) -> tuple[str, ...]:
        """The class of each object."""
        return tuple(name.partition("/")[0] for name in self.objects)

    @property
    def reports(self) -> BoolArray:
        """Whether an object took no part in choosing descriptors and settings, shape (o,)."""
        return ~np.isin(self.objects, self.choosing)


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
    def pose(self) -> str:
        """The pose of the objects in words."""
        return POSES[self.turns]

    @property
    def classifier(self) -> str:
        """The classifier."""
        return self.cells["fixation"].classifier

    @property
    def draws(self) -> int:
        """The number of draws of the turns; an object's accuracy is the mean over the draws."""
        return self.cells["fixation"].draws

    @property
    def objects(self) -> int:
        """The number of tested objects."""
        return int(self.tested.sum())

    @cached_property
    def fixation(self) -> Figure:
        """The accuracy of touches by fixation."""
        return self._figure("fixation")

    @cached_property
    def random(self) -> Figure:
        """The accuracy of touches at random places in reach."""
        return self._figure("random")

    @cached_property
    def visible(self) -> Figure:
        """The accuracy of touches at random places in sight."""
        return self._figure("random_visible")

    @cached_property
    def lead(self) -> Figure:
        """Fixation minus random places in reach."""
        return self._figure("fixation", "random")

    @cached_property
    def salience(self) -> Figure:
        """Fixation minus random places in sight."""
        return self._figure("fixation", "random_visible")

    def _figure(self, plus: str, *minus: str) -> Figure:
        subtracted = [self.cells[name] for name in minus]
        return _figure([self.cells[plus]], subtracted, self.intervals, self.classes, self.tested)


def read_turned(path: Path | None = None) -> dict[str, TurnedSet]:
    """Read the kept accuracies, by set of objects.

    `path` is a file that `make turned` wrote; by default the file of the package. Raises `ReportError` if the file is
    damaged.
    """
    return read_json(
        Path(str(files("visuohaptic.report").joinpath(KEPT))) if path is None else path,
        lambda stored: {name: TurnedSet.model_validate(kept) for name, kept in stored.items()},
        "holds no kept accuracies of turned objects",
        "run `make turned` again",
    )


def turned_rows(kept: TurnedSet, intervals: IntervalParameters) -> list[TurnedRow]:
    """Return the accuracies in the full frame, one row per pose and pipeline, the paper's pipeline first."""
    chosen = ("full", HEADLINE_TOUCHES)
    cells = [cell for cell in kept.cells if (cell.known, cell.touches) == chosen]
    counted = np.ones(len(kept.objects), dtype=np.bool_)
    return list(_rows(cells, intervals, kept.classes, counted))


def frame_rows(kept: TurnedSet, intervals: IntervalParameters) -> list[TurnedRow]:
    """Return the accuracies of pipeline `order_free`, one row per pose and known part of the frame.

    Means are over the objects in `kept.reports`.
    """
    chosen = ("order_free", HEADLINE_TOUCHES)
    cells = [cell for cell in kept.cells if (cell.pipeline, cell.touches) == chosen]
    return list(_rows(cells, intervals, kept.classes, kept.reports))


def curve_rows(kept: TurnedSet, intervals: IntervalParameters) -> list[TurnedRow]:
    """Return the accuracies of pipeline `order_free` by number of touches per sequence.

    Only poses and frames that were measured with several numbers of touches have rows. Means are over the objects in
    `kept.reports` that were tested with each number of touches and each strategy.
    """
    cells = [cell for cell in kept.cells if cell.pipeline == "order_free"]
    longer = {(cell.turns, cell.known) for cell in cells if cell.touches > HEADLINE_TOUCHES}
    chosen = [cell for cell in cells if (cell.turns, cell.known) in longer]
    return list(_rows(chosen, intervals, kept.classes, _tested(chosen, kept.reports)))


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
) -> Figure:
    """Compute a sum of accuracies minus another sum, paired over objects, with its interval.

    Parameters
    ----------
    kept : TurnedSet
        The kept accuracies; the mean is over the objects in `kept.reports` that all cells tested.
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
    return _figure(added, subtracted, intervals, kept.classes, kept.reports)


def _numbers(cell: TurnedCell) -> FloatArray:
    """Return accuracies and weights (2, o), NaN where an object was not tested."""
    return np.array([cell.accuracy, cell.weights], dtype=np.float64)


def _tested(cells: Sequence[TurnedCell], counted: BoolArray) -> BoolArray:
    """Return whether an object counts and was tested in all cells, shape (o,)."""
    accuracies = np.array([_numbers(cell)[0] for cell in cells])
    return np.isfinite(accuracies).all(axis=0) & counted


def _figure(
    plus: Sequence[TurnedCell],
    minus: Sequence[TurnedCell],
    intervals: IntervalParameters,
    classes: Sequence[str],
    counted: BoolArray,
) -> Figure:
    """Compute a sum of accuracies minus another sum, over the objects that count and that all cells tested."""
    added, subtracted = (np.array([_numbers(cell)[0] for cell in cells]) for cells in (plus, minus))
    values = added.sum(axis=0) - (subtracted.sum(axis=0) if len(minus) else 0.0)
    tested = _tested([*plus, *minus], counted)
    weights = _numbers(plus[0])[1]
    bounds = (-float(len(minus)), float(len(plus)))
    of_tested = np.array(classes)[tested]
    chosen = values[tested], weights[tested]
    if minus:
        return lead(compare_differences(*chosen, intervals, bounds, of_tested))
    return estimate(
        object_interval(*chosen, intervals, bounds),
        class_interval(*chosen, of_tested, intervals, bounds),
    )
