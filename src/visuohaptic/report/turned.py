"""Accuracies of turned objects that were measured once and are kept with the package, by set of objects.

`make turned` measures them and writes `turned.json` beside this file (studies/turned/README.md).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

import numpy as np
from pydantic import BaseModel, ConfigDict

from visuohaptic.base.arrays import FloatArray
from visuohaptic.evaluation.intervals import DIFFERENCE, object_interval
from visuohaptic.geometry.turning import Turns
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.estimates import Figure, estimate, read_json, with_interval
from visuohaptic.report.wording import counted, listed, points

KEPT = "turned.json"

POSES: Mapping[Turns, str] = {
    "none": "upright, facing one way",
    "vertical": "upright, turned about the vertical",
    "any": "turned in any way",
}
"""The poses of the objects in words, by `meshes.turns`."""


class TurnedCell(BaseModel):
    """Accuracies per object, None where an object was not tested: means over the draws of the turns."""

    model_config = ConfigDict(frozen=True)

    turns: Turns
    pipeline: str
    strategy: str
    classifier: str
    draws: int
    accuracy: tuple[float | None, ...]
    weights: tuple[float | None, ...]


class TurnedSet(BaseModel):
    """The accuracies of one set of objects, ``class/name``, with commit and day (UTC) of the measurement."""

    model_config = ConfigDict(frozen=True)

    commit: str
    date: str
    objects: tuple[str, ...]
    cells: tuple[TurnedCell, ...]


@dataclass(frozen=True)
class TurnedRow:
    """How accurate a pipeline is on objects in one pose, by fixation and by random touches in reach.

    `lead` is fixation minus random over the objects of both. All are means over `draws` draws of the turns.
    """

    turns: Turns
    pipeline: str
    classifier: str
    draws: int
    objects: int
    fixation: Figure
    random: Figure
    lead: Figure

    @property
    def pose(self) -> str:
        """The pose of the objects in words."""
        return POSES[self.turns]


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
    """Compute means and intervals over objects, pose by pose, the paper's pipeline first."""
    cells = {(one.turns, one.pipeline, one.strategy): one for one in kept.cells}
    pipelines = sorted({one.pipeline for one in kept.cells}, key="paper".__ne__)
    rows = []
    for turns in POSES:
        for pipeline in pipelines:
            fixation, random = (
                cells.get((turns, pipeline, strategy)) for strategy in ("fixation", "random")
            )
            if fixation is not None and random is not None:
                rows.append(_row(fixation, random, intervals))
    return rows


def turned_sentence(kept: TurnedSet, intervals: IntervalParameters, pipeline: str = "paper") -> str:
    """Say how far fixation leads random touches in reach by the pose of the objects, in one pipeline; empty if not kept."""
    rows = [row for row in turned_rows(kept, intervals) if row.pipeline == pipeline]
    if not rows:
        return ""
    leads = [
        f"{with_interval(row.lead, points, ' points')} where they are {row.pose}" for row in rows
    ]
    return (
        f"Measured on {kept.date}, on {counted(rows[0].objects, 'object')}: the lead over random places in reach is "
        f"{listed(leads)}."
    )


def _row(fixation: TurnedCell, random: TurnedCell, intervals: IntervalParameters) -> TurnedRow:
    first, second = _numbers(fixation), _numbers(random)
    both = np.isfinite(first[0]) & np.isfinite(second[0])
    lead = object_interval(first[0, both] - second[0, both], first[1, both], intervals, DIFFERENCE)
    return TurnedRow(
        turns=fixation.turns,
        pipeline=fixation.pipeline,
        classifier=fixation.classifier,
        draws=fixation.draws,
        objects=int(both.sum()),
        fixation=_figure(first, intervals),
        random=_figure(second, intervals),
        lead=estimate(lead),
    )


def _numbers(cell: TurnedCell) -> FloatArray:
    """Return accuracies and weights (2, o), NaN where an object was not tested."""
    return np.array([cell.accuracy, cell.weights], dtype=np.float64)


def _figure(numbers: FloatArray, intervals: IntervalParameters) -> Figure:
    accuracy, weights = numbers[:, np.isfinite(numbers[0])]
    return estimate(object_interval(accuracy, weights, intervals))
