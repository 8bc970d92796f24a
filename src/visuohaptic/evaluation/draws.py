"""Average accuracies and leads over several draws of the places of a random strategy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.draws import draw_of
from visuohaptic.evaluation.by_object import average_by_object

CellKey = tuple[str, str, str]
"""Pipeline, strategy and classifier."""

_CELL = ["pipeline", "strategy", "classifier"]


@dataclass(frozen=True)
class Draw:
    """Accuracies (o,) and weights (o,) of the objects that one draw tested."""

    objects: tuple[tuple[str, str], ...]
    accuracy: FloatArray
    weights: FloatArray

    @property
    def mean(self) -> float:
        """The mean over splits of the share of test sequences correctly classified."""
        return float(self.weights @ self.accuracy / self.weights.sum())


@dataclass(frozen=True)
class FurtherDraws:
    """The draws of one pipeline, strategy and classifier after the first, in order.

    `notes` has one sentence per draw that failed.
    """

    draws: tuple[Draw, ...] = ()
    notes: tuple[str, ...] = ()


def further_draws(rows: pa.Table | None) -> dict[CellKey, FurtherDraws]:
    """Return the further draws of each pipeline, strategy and classifier in rows of `tables.STUDY`.

    Column ``strategy`` names the draw, such as ``random#2``. Without a table the result is empty.
    """
    if rows is None or not rows.num_rows:
        return {}
    cells = rows.select(_CELL).group_by(_CELL).aggregate([]).to_pylist()
    by_cell: dict[CellKey, FurtherDraws] = {}
    for cell in sorted(cells, key=lambda cell: draw_of(cell["strategy"])):
        measured = rows
        for name, value in cell.items():
            measured = measured.filter(pc.equal(measured.column(name), value))
        strategy, number = draw_of(cell["strategy"])
        key = (cell["pipeline"], strategy, cell["classifier"])
        error = measured.column("error")[0].as_py()
        earlier = by_cell.get(key, FurtherDraws())
        if error is not None:
            note = f"draw {number} of the places could not be measured: {error.rstrip('.')}"
            by_cell[key] = FurtherDraws(earlier.draws, (*earlier.notes, note))
            continue
        means = average_by_object(measured)
        draw = Draw(means.objects, means.accuracy, means.weights)
        by_cell[key] = FurtherDraws((*earlier.draws, draw), earlier.notes)
    return by_cell


def mean_over_draws(draws: Sequence[Draw]) -> Draw:
    """Average each object's accuracy and weight over the draws that tested the object.

    Parameters
    ----------
    draws : sequence of Draw
        At least one draw. The result has the objects of the first draw.

    Returns
    -------
    Draw
        The mean over draws; a single draw is returned unchanged.
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
    return Draw(first.objects, np.array(accuracy), np.array(weights))


@dataclass(frozen=True)
class LeadOverDraws:
    """The lead of fixation over each draw of a random strategy: differences of shares, in the order of the draws."""

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


def lead_over_draws(reference: Draw, draws: Sequence[Draw]) -> LeadOverDraws:
    """Compute the lead of `reference` over each draw.

    A lead is the weighted mean of the differences over the objects of both, with the weights of `reference`.
    """
    return LeadOverDraws(tuple(_lead(reference, draw) for draw in draws))


def _lead(reference: Draw, other: Draw) -> float:
    first, second = in_common(reference, other)
    return float(first.weights @ (first.accuracy - second.accuracy) / first.weights.sum())


def in_common(first: Draw, second: Draw) -> tuple[Draw, Draw]:
    """Return both draws with only the objects that both tested."""
    shared = {*first.objects} & {*second.objects}
    return _take(first, shared), _take(second, shared)


def _take(draw: Draw, objects: set[tuple[str, str]]) -> Draw:
    rows = [row for row, key in enumerate(draw.objects) if key in objects]
    kept = tuple(draw.objects[row] for row in rows)
    return Draw(kept, draw.accuracy[rows], draw.weights[rows])


def plain_lead(lead: LeadOverDraws) -> Mapping[str, object]:
    """Return the lead over draws in types that JSON has."""
    return {
        "count": lead.count,
        "leads": list(lead.leads),
        "standard_deviation": lead.standard_deviation,
    }
