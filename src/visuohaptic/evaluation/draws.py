"""Several draws of a random strategy's places: accuracies and leads as means over draws, and how far one draw moves them."""

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
    """All draws of one pipeline, strategy and classifier but the first, in order; `notes` name those that failed."""

    draws: tuple[Draw, ...] = ()
    notes: tuple[str, ...] = ()


def further_draws(rows: pa.Table | None) -> dict[CellKey, FurtherDraws]:
    """Read the further draws of each pipeline, strategy and classifier from rows of `tables.STUDY`.

    Column ``strategy`` names the draws, such as ``random#2``. No table has no draws.
    """
    if rows is None or not rows.num_rows:
        return {}
    cells = rows.select(_CELL).group_by(_CELL).aggregate([]).to_pylist()
    found: dict[CellKey, FurtherDraws] = {}
    for cell in sorted(cells, key=lambda one: draw_of(one["strategy"])):
        part = rows
        for name, value in cell.items():
            part = part.filter(pc.equal(part.column(name), value))
        strategy, number = draw_of(cell["strategy"])
        key = (cell["pipeline"], strategy, cell["classifier"])
        error, known = part.column("error")[0].as_py(), found.get(key, FurtherDraws())
        if error is not None:
            note = f"draw {number} of the places could not be measured: {error.rstrip('.')}"
            found[key] = FurtherDraws(known.draws, (*known.notes, note))
            continue
        means = average_by_object(part)
        draw = Draw(means.objects, means.accuracy, means.weights)
        found[key] = FurtherDraws((*known.draws, draw), known.notes)
    return found


def mean_over_draws(draws: Sequence[Draw]) -> Draw:
    """Average each object's accuracy, and its weight, over the draws that tested it.

    Parameters
    ----------
    draws : sequence of Draw
        At least one; the result has the objects of the first.

    Returns
    -------
    Draw
        The mean; of one draw the draw itself.
    """
    first, *others = draws
    if not others:
        return first
    tested = [dict(zip(one.objects, range(len(one.objects)), strict=True)) for one in draws]
    accuracy, weights = (
        np.array(
            [
                np.mean(
                    [
                        getattr(one, name)[places[key]]
                        for one, places in zip(draws, tested, strict=True)
                        if key in places
                    ]
                )
                for key in first.objects
            ]
        )
        for name in ("accuracy", "weights")
    )
    return Draw(first.objects, accuracy, weights)


@dataclass(frozen=True)
class LeadOverDraws:
    """Fixation minus each draw of a random strategy, as shares, in the order of the draws."""

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
        """How far one draw moves the lead: the standard deviation over draws, by n - 1; 0 of a single draw."""
        return float(np.std(self.leads, ddof=1)) if self.count > 1 else 0.0


def lead_over_draws(reference: Draw, draws: Sequence[Draw]) -> LeadOverDraws:
    """Compute how far `reference` is ahead of each draw, over the objects of both, weighted as the reference."""
    return LeadOverDraws(tuple(_lead(reference, one) for one in draws))


def _lead(reference: Draw, other: Draw) -> float:
    first, second = in_common(reference, other)
    return float(first.weights @ (first.accuracy - second.accuracy) / first.weights.sum())


def in_common(first: Draw, second: Draw) -> tuple[Draw, Draw]:
    """Return both with only the objects that both tested."""
    shared = {*first.objects} & {*second.objects}
    return _take(first, shared), _take(second, shared)


def _take(draw: Draw, objects: set[tuple[str, str]]) -> Draw:
    rows = [place for place, key in enumerate(draw.objects) if key in objects]
    kept = tuple(draw.objects[place] for place in rows)
    return Draw(kept, draw.accuracy[rows], draw.weights[rows])


def plain_lead(lead: LeadOverDraws) -> Mapping[str, object]:
    """Return the lead over draws in types that JSON has."""
    return {
        "count": lead.count,
        "leads": list(lead.leads),
        "standard_deviation": lead.standard_deviation,
    }
