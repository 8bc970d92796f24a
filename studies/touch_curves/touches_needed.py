"""The area under each curve of accuracy over touches, and how many touches a level takes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from touch_curves.study import LONGEST_SEQUENCE, touches_name
from touch_curves.tables import TOUCHES_NEEDED
from visuohaptic.base.errors import RecognitionError
from visuohaptic.evaluation.intervals import Interval, compare_paired, object_interval
from visuohaptic.evaluation.summary import REFERENCE_STRATEGY
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.studies.figures import (
    Cell,
    CellKey,
    condition_interval,
    ends,
    nested,
    paired,
    read_cells,
    write_json,
)
from visuohaptic.studies.study import StepInputs
from visuohaptic.tables.schema import build_rows, write_table

LEVEL = 0.9
"""The accuracy for which the number of touches is reported."""

_KEYS = ("pipeline", "strategy", "classifier")


def curve_areas(curve: Sequence[Cell]) -> NDArray[np.float64]:
    """Give the area under each object's curve, as a share of that of accuracy 1: shape (o,).

    The cells are those with one touch, two, and so on, of the same o objects.
    """
    accuracy = np.stack([cell.accuracy for cell in curve], axis=1)
    if len(curve) == 1:
        return accuracy[:, 0]
    middles: NDArray[np.float64] = (accuracy[:, 1:] + accuracy[:, :-1]) / 2
    return middles @ np.ones(len(curve) - 1) / (len(curve) - 1)


def stays_at(level: float, values: Sequence[float]) -> int | None:
    """Give the fewest touches from which on values stay at a level; None if they never do."""
    below = [place for place, value in enumerate(values) if value < level]
    first = max(below) + 1 if below else 0
    return first + 1 if first < len(values) else None


def touches_needed(cells: Mapping[CellKey, Cell], intervals: IntervalParameters) -> pa.Table:
    """Sum up curves with intervals over objects: `TOUCHES_NEEDED`.

    A curve that failed somewhere is left out, and a gain where fixations weren't run on the same
    objects. Raises `RecognitionError` if no curve is whole.
    """
    curves = _curves(cells)
    if not curves:
        raise RecognitionError("There is no curve with a point at each number of touches.")
    rows = [
        {
            **dict(zip(_KEYS, key, strict=True)),
            "level": LEVEL,
            **_reached([condition_interval(cell, intervals) for cell in curve]),
            "most_touches": len(curve),
            **_area(curve, curves.get((key[0], REFERENCE_STRATEGY, key[2])), intervals),
            "objects": len(curve[0].objects),
        }
        for key, curve in sorted(curves.items())
    ]
    return build_rows(TOUCHES_NEEDED, rows)


def make_touches_needed(step: StepInputs) -> None:
    """Write `TOUCHES_NEEDED` of the study's blocks, and the same numbers as JSON."""
    needed, metrics = step.outputs
    cells = read_cells(step.inputs["blocks"])
    table = touches_needed(cells, step.run.recognition.intervals)
    write_table(TOUCHES_NEEDED, table, needed)
    write_json(nested(table.to_pylist(), _KEYS), metrics)


def _curves(cells: Mapping[CellKey, Cell]) -> dict[tuple[str, ...], list[Cell]]:
    names = [touches_name(count) for count in range(1, LONGEST_SEQUENCE + 1)]
    found = {
        key: [cells[(name, *key)] for name in names if (name, *key) in cells]
        for key in dict.fromkeys(key[1:] for key in cells)
    }
    return {
        key: curve
        for key, curve in found.items()
        if len(curve) == len(names) and not any(cell.error for cell in curve)
    }


def _reached(points: Sequence[Interval]) -> dict[str, int | None]:
    # Where the upper end stays at the level, fewer touches may do.
    ends = {"touches": "mean", "touches_low": "high", "touches_high": "low"}
    return {
        name: stays_at(LEVEL, [getattr(point, end) for point in points])
        for name, end in ends.items()
    }


def _area(
    curve: Sequence[Cell],
    reference: Sequence[Cell] | None,
    intervals: IntervalParameters,
) -> dict[str, Any]:
    areas, weights = curve_areas(curve), curve[0].weights
    area = object_interval(areas, weights, intervals)
    compared = None
    if reference and reference is not curve and reference[0].objects == curve[0].objects:
        compared = compare_paired(curve_areas(reference), areas, weights, intervals)
    return {**ends("area", "area_", area), **paired("gain", "p_value", compared)}
