"""Average accuracies and leads over several draws of a random strategy.

A draw is one random choice of all locations that the strategy touches. The draws of strategy ``random`` are numbered
from 0. Draw 0 has the strategy's name, ``random``. Further draws are named ``random#1``, ``random#2`` and so on.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from visuohaptic.base.draw_names import draw_of
from visuohaptic.evaluation.by_object import ObjectAccuracies, average_by_object


class PredictionKey(NamedTuple):
    """The predictions of a classifier; in means over draws the strategy has no number of a draw."""

    pipeline: str
    strategy: str
    classifier: str


_CELL = list(PredictionKey._fields)


@dataclass(frozen=True)
class FurtherDraws:
    """The measured draws from number 1 of one pipeline, strategy and classifier, in the order of their numbers.

    `notes` has one sentence per draw that failed. Failed draws are not in `draws`.
    """

    draws: tuple[ObjectAccuracies, ...] = ()
    notes: tuple[str, ...] = ()


def further_draws(rows: pa.Table | None) -> dict[PredictionKey, FurtherDraws]:
    """Compute accuracies per object and draw from rows of `tables.STUDY` of one study and condition.

    The rows must not contain draw 0. Column ``strategy`` has the name of the draw, such as ``random#2``. The strategy
    in the keys of the result has no number, such as ``random``. A draw with text in column ``error`` has a note and
    no accuracies. Without a table or rows the result is empty.
    """
    if rows is None or not rows.num_rows:
        return {}
    cells = rows.select(_CELL).group_by(_CELL).aggregate([]).to_pylist()
    by_cell: dict[PredictionKey, FurtherDraws] = {}
    for cell in sorted(cells, key=lambda cell: draw_of(cell["strategy"])):
        measured = rows
        for name, value in cell.items():
            measured = measured.filter(pc.equal(measured.column(name), value))
        strategy, number = draw_of(cell["strategy"])
        key = PredictionKey(cell["pipeline"], strategy, cell["classifier"])
        error = measured.column("error")[0].as_py()
        earlier = by_cell.get(key, FurtherDraws())
        if error is not None:
            note = f"draw {number} of the places could not be measured: {error.rstrip('.')}"
            by_cell[key] = FurtherDraws(earlier.draws, (*earlier.notes, note))
            continue
        draw, _ = average_by_object(measured)
        by_cell[key] = FurtherDraws((*earlier.draws, draw), earlier.notes)
    return by_cell


def mean_over_draws(draws: Sequence[ObjectAccuracies]) -> ObjectAccuracies:
    """Average each object's accuracy and weight over the draws that tested the object.

    Parameters
    ----------
    draws : sequence of ObjectAccuracies
        At least one draw.

    Returns
    -------
    ObjectAccuracies
        The objects of the first draw, with their means. Objects that only other draws tested are dropped. A single
        draw is returned unchanged.
    """
    first, *others = draws
    if not others:
        return first
    indices = [{key: index for index, key in enumerate(draw.objects)} for draw in draws]
    accuracy, weights = [], []
    for key in first.objects:
        tested = [
            (draw, index_of[key])
            for draw, index_of in zip(draws, indices, strict=True)
            if key in index_of
        ]
        accuracy.append(np.mean([draw.accuracy[index] for draw, index in tested]))
        weights.append(np.mean([draw.weights[index] for draw, index in tested]))
    return ObjectAccuracies(first.objects, np.array(accuracy), np.array(weights))


@dataclass(frozen=True)
class LeadOverDraws:
    """The lead of fixation over each draw of a random strategy, in the order of the draws.

    `leads` are accuracies by fixation minus accuracies by the draw, in [-1, 1]: 0.1 is a lead of 10 points.
    """

    leads: tuple[float, ...]

    @property
    def count(self) -> int:
        """The number of draws."""
        return len(self.leads)

    @property
    def mean(self) -> float:
        """The mean of the leads."""
        return float(np.mean(self.leads))

    @property
    def standard_deviation(self) -> float:
        """The standard deviation of the leads over draws (n - 1); 0 for a single draw."""
        return float(np.std(self.leads, ddof=1)) if self.count > 1 else 0.0


def lead_over_draws(
    reference: ObjectAccuracies, draws: Sequence[ObjectAccuracies]
) -> LeadOverDraws:
    """Compute the lead of `reference`, the accuracies by fixation, over each draw.

    A lead is the weighted mean over objects of the accuracy of `reference` minus the accuracy of the draw. Only
    objects that both tested count, with the weights of `reference`. Without a common object the lead is NaN.
    """
    return LeadOverDraws(tuple(_lead(reference, draw) for draw in draws))


def _lead(reference: ObjectAccuracies, other: ObjectAccuracies) -> float:
    """Compute the lead of `reference` over one draw, as `lead_over_draws`."""
    first, second = in_common(reference, other)
    return float(first.weights @ (first.accuracy - second.accuracy) / first.weights.sum())


def in_common(
    first: ObjectAccuracies, second: ObjectAccuracies
) -> tuple[ObjectAccuracies, ObjectAccuracies]:
    """Return both arguments with only the objects that both tested, in the same order."""
    shared = {*first.objects} & {*second.objects}
    return _take_objects(first, shared), _take_objects(second, shared)


def _take_objects(draw: ObjectAccuracies, objects: set[tuple[str, str]]) -> ObjectAccuracies:
    rows = [row for row, key in enumerate(draw.objects) if key in objects]
    kept = tuple(draw.objects[row] for row in rows)
    return ObjectAccuracies(kept, draw.accuracy[rows], draw.weights[rows])


def plain_lead(lead: LeadOverDraws) -> Mapping[str, object]:
    """Return a dict with keys ``count``, ``leads`` and ``standard_deviation``, for JSON."""
    return {
        "count": lead.count,
        "leads": list(lead.leads),
        "standard_deviation": lead.standard_deviation,
    }
