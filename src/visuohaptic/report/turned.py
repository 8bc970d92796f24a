"""Accuracies of turned objects that were measured once and are kept with the package, by set of objects.

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
from visuohaptic.evaluation.intervals import object_interval
from visuohaptic.evaluation.published import PAPER_PIPELINE
from visuohaptic.geometry.turning import Turns
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.draws import KeptDraws
from visuohaptic.report.estimates import Figure, estimate, read_json, with_interval
from visuohaptic.report.wording import counted, listed, pipeline_name, points

KEPT = "turned.json"

POSES: Mapping[Turns, str] = {
    "none": "upright, facing one way",
    "vertical": "upright, turned about the vertical",
    "any": "turned in any way",
}
"""The poses of the objects in words, by `meshes.turns`."""

Known = Literal["statistics", "none", "centre", "vertical", "full", "trained_upright"]
"""What the descriptors take as known of the object's frame: `recognition.frame`, `STATISTICS` or `TRAINED_UPRIGHT`."""

STATISTICS: Literal["statistics"] = "statistics"
"""Nothing is known, and touches and pairs of touches are described by statistics, without their waves."""

TRAINED_UPRIGHT: Literal["trained_upright"] = "trained_upright"
"""All is taken as known, and the pipeline was fitted on objects that stand upright and face one way."""

KNOWN: Mapping[Known, str] = {
    "full": "all",
    "vertical": "centre and vertical",
    "centre": "centre",
    "none": "nothing",
    STATISTICS: "nothing, without waves",
    TRAINED_UPRIGHT: "all is assumed, fitted on upright objects",
}
"""What is known of the frame, in words."""

FRAMES_OF_POSES: tuple[tuple[Turns, Known], ...] = (
    ("none", "full"),
    ("vertical", "vertical"),
    ("any", "centre"),
    ("any", "none"),
)
"""Objects turned as far as the frame does not know: what is turned, and what is known."""

STRATEGIES = ("fixation", "random", "random_visible")
"""Touches by fixation, at random places in reach, and at random places in sight."""

HEADLINE_TOUCHES = 5
"""Touches per sequence of the table that stands beside the headline."""


class TurnedCell(BaseModel):
    """Accuracies per object, None where an object was not tested: means over the draws of the turns."""

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
    """The accuracies of one set of objects, ``class/name``, with commit and day (UTC) of the measurement.

    `choosing` are the objects on which descriptors and settings were chosen.
    """

    model_config = ConfigDict(frozen=True)

    commit: str
    date: str
    objects: tuple[str, ...]
    choosing: tuple[str, ...]
    cells: tuple[TurnedCell, ...]

    @property
    def reports(self) -> BoolArray:
        """Whether an object chose neither descriptors nor settings, shape (o,)."""
        return ~np.isin(self.objects, self.choosing)


class CellName(NamedTuple):
    """What names a cell of pipeline `order_free`."""

    turns: Turns
    known: Known
    touches: int
    strategy: str


@dataclass(frozen=True)
class TurnedRow:
    """How accurate a pipeline is on objects in one pose, described by what is known of their frame.

    Each figure is a mean over the objects that are `tested`, and is computed when a page asks for it.

    Attributes
    ----------
    turns, known, touches, pipeline
        What all `cells` have in common.
    cells : mapping of str to TurnedCell
        The accuracies by strategy.
    tested : ndarray of shape (o,), bool
        Whether an object counts and has sequences by all strategies.
    intervals : IntervalParameters
        The confidence of the intervals.
    """

    turns: Turns
    known: Known
    touches: int
    pipeline: str
    cells: Mapping[str, TurnedCell]
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
        """The number of draws of the turns of which an object's accuracy is the mean."""
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
        taken = [self.cells[name] for name in minus]
        return _figure([self.cells[plus]], taken, self.intervals, self.tested)


def read_turned(path: Path | None = None) -> dict[str, TurnedSet]:
    """Read the kept accuracies, by set of objects; `ReportError` if the file is damaged.

    `path` is a file as `make turned` writes; without it, that of the package.
    """
    return read_json(
        Path(str(files("visuohaptic.report").joinpath(KEPT))) if path is None else path,
        lambda found: {name: TurnedSet.model_validate(one) for name, one in found.items()},
        "holds no kept accuracies of turned objects",
        "run `make turned` again",
    )


def turned_rows(kept: TurnedSet, intervals: IntervalParameters) -> list[TurnedRow]:
    """Return the accuracies in the full frame, pose by pose, the paper's pipeline first."""
    chosen = ("full", HEADLINE_TOUCHES)
    cells = [one for one in kept.cells if (one.known, one.touches) == chosen]
    return list(_rows(cells, intervals, np.ones(len(kept.objects), dtype=np.bool_)))


def frame_rows(kept: TurnedSet, intervals: IntervalParameters) -> list[TurnedRow]:
    """Return the accuracies of pipeline `order_free` in every frame, over the objects that report."""
    chosen = ("order_free", HEADLINE_TOUCHES)
    cells = [one for one in kept.cells if (one.pipeline, one.touches) == chosen]
    return list(_rows(cells, intervals, kept.reports))


def curve_rows(kept: TurnedSet, intervals: IntervalParameters) -> list[TurnedRow]:
    """Return the accuracies of pipeline `order_free` by the number of touches, in the frames of several numbers.

    Means are over the objects that report and have sequences of each number of touches by each strategy.
    """
    cells = [one for one in kept.cells if one.pipeline == "order_free"]
    longer = {(one.turns, one.known) for one in cells if one.touches > HEADLINE_TOUCHES}
    chosen = [one for one in cells if (one.turns, one.known) in longer]
    return list(_rows(chosen, intervals, _tested(chosen, kept.reports)))


def _rows(
    cells: Sequence[TurnedCell], intervals: IntervalParameters, counted: BoolArray
) -> Iterator[TurnedRow]:
    """Yield a row per pose, frame, number of touches and pipeline, over the objects that count."""
    rows: dict[tuple[Turns, Known, int, str], dict[str, TurnedCell]] = {}
    for one in cells:
        key = one.turns, one.known, one.touches, one.pipeline
        rows.setdefault(key, {})[one.strategy] = one
    for turns, known, touches, pipeline in sorted(rows, key=_place):
        found = rows[turns, known, touches, pipeline]
        if len(found) < len(STRATEGIES):
            continue
        tested = _tested(list(found.values()), counted)
        yield TurnedRow(turns, known, touches, pipeline, found, tested, intervals)


def _place(row: tuple[Turns, Known, int, str]) -> tuple[object, ...]:
    """Return what rows are sorted by: pose, the paper's pipeline first, frame from all to nothing, and touches."""
    turns, known, touches, pipeline = row
    return list(POSES).index(turns), pipeline != "paper", list(KNOWN).index(known), touches


def contrast(
    kept: TurnedSet,
    plus: Sequence[CellName],
    minus: Sequence[CellName],
    intervals: IntervalParameters,
) -> Figure:
    """Compute a sum of accuracies less another sum, in pairs over the objects that report.

    Raises `ReportError` if a cell is not kept.
    """
    cells = {
        CellName(one.turns, one.known, one.touches, one.strategy): one
        for one in kept.cells
        if one.pipeline == "order_free"
    }
    missing = [name for name in (*plus, *minus) if name not in cells]
    if missing:
        raise ReportError(
            f"No accuracy of turned objects is kept for {' '.join(map(str, missing[0]))}."
        )
    added, taken = ([cells[name] for name in names] for names in (plus, minus))
    return _figure(added, taken, intervals, kept.reports)


def more_objects_sentences(
    kept: TurnedSet, intervals: IntervalParameters, drawn: Sequence[KeptDraws] = ()
) -> list[str]:
    """Say per pipeline whether fixation leads on upright objects of a kept set; `drawn` are kept draws of the set.

    Only an interval that excludes 0 gives the lead a sign.
    """
    draws = {one.pipeline: one.lead for one in drawn}
    rows = [row for row in turned_rows(kept, intervals) if row.turns == "none"]
    said = []
    for row in rows:
        begins = f"With {counted(row.objects, 'object')} {_lead_in_words(row.lead)} in {pipeline_name(row.pipeline)}"
        lead = with_interval(row.lead, points, " points")
        found = draws.get(row.pipeline)
        over = ""
        if found:
            ends = f"{points(min(found.leads))} to {points(max(found.leads))}"
            over = f"; {counted(found.count, 'draw')} of the places give {ends}"
        said.append(
            f"{begins}: {lead} over random places in reach{over} (measured on {kept.date})."
        )
    return said


def turned_sentence(
    kept: TurnedSet, intervals: IntervalParameters, pipeline: str = PAPER_PIPELINE
) -> str:
    """Say how far fixation leads random touches in reach on turned objects, in one pipeline."""
    rows = [
        row
        for row in turned_rows(kept, intervals)
        if row.pipeline == pipeline and row.turns != "none"
    ]
    leads = [f"{with_interval(row.lead, points, ' points')} ({row.pose})" for row in rows]
    return (
        f"With {counted(rows[0].objects, 'turned object')} the lead in {pipeline_name(pipeline)} is {listed(leads)}, "
        "over random places in reach."
    )


def unknown_pose_sentence(kept: TurnedSet, intervals: IntervalParameters) -> str:
    """Say by how much not knowing the pose changes the lead of fixation, on objects turned in any way."""
    touches = HEADLINE_TOUCHES
    unknown = {name: CellName("any", "none", touches, name) for name in STRATEGIES}
    known = {name: CellName("none", "full", touches, name) for name in STRATEGIES}
    changes = []
    for other, place in (("random", "in reach"), ("random_visible", "in sight")):
        plus, minus = [unknown["fixation"], known[other]], [unknown[other], known["fixation"]]
        change = contrast(kept, plus, minus, intervals)
        changes.append(f"by {with_interval(change, points, ' points')} over random places {place}")
    return (
        f"Where the pose is unknown instead of known, the lead in pipeline order_free changes {listed(changes)} "
        f"({counted(int(kept.reports.sum()), 'object')})."
    )


def _lead_in_words(lead: Figure) -> str:
    if lead.low is not None and lead.low > 0:
        return "fixation leads"
    if lead.high is not None and lead.high < 0:
        return "random touches lead"
    return "no lead is shown"


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
    counted: BoolArray,
) -> Figure:
    """Compute a sum of accuracies less another sum over the objects that count and that all cells tested."""
    added, taken = (np.array([_numbers(cell)[0] for cell in cells]) for cells in (plus, minus))
    values = added.sum(axis=0) - (taken.sum(axis=0) if len(minus) else 0.0)
    used = _tested([*plus, *minus], counted)
    weights = _numbers(plus[0])[1]
    bounds = (-float(len(minus)), float(len(plus)))
    return estimate(object_interval(values[used], weights[used], intervals, bounds))
