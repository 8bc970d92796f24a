"""Compute the area under each curve of accuracy against touches, and the number of touches that a level needs."""

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
    paired_with_classes,
    read_cells,
    write_json,
)
from visuohaptic.studies.study import StepInputs
from visuohaptic.tables.schema import build_rows, write_table

LEVEL = 0.9
"""The accuracy for which the number of touches is reported."""

_KEYS = ("pipeline", "strategy", "classifier")


def curve_areas(curve: Sequence[Cell]) -> NDArray[np.float64]:
    """Compute the area under each object's curve, as a share of the area of accuracy 1, shape (o,).

    `curve` has one cell per number of touches, ascending from 1, all with the same o objects.
    """
    accuracy = np.stack([cell.accuracy for cell in curve], axis=1)
    if len(curve) == 1:
        return accuracy[:, 0]
    middles: NDArray[np.float64] = (accuracy[:, 1:] + accuracy[:, :-1]) / 2
    return middles @ np.ones(len(curve) - 1) / (len(curve) - 1)


def stays_at(level: float, values: Sequence[float]) -> int | None:
    """Return the smallest number of touches from which all values are at least `level`; None if there is none.

    `values` are ordered by the number of touches, ascending from 1.
    """
    below = [touches for touches, value in enumerate(values, start=1) if value < level]
    first = max(below, default=0) + 1
    return first if first <= len(values) else None


def touches_needed(cells: Mapping[CellKey, Cell], intervals: IntervalParameters) -> pa.Table:
    """Summarise curves with intervals over objects; return `TOUCHES_NEEDED`.

    Curves with a missing or failed cell are left out. The gain is None if fixation was not tested on the same objects.
    Raises `RecognitionError` if no curve is complete.
    """
    curves = _curves(cells)
    if not curves:
        raise RecognitionError(
            "No curve has a point at each number of touches; at least one such curve is needed."
        )
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
    """Write `TOUCHES_NEEDED` of the study's blocks, and as JSON the same numbers (``needed``) and the curves (``curves``)."""
    needed, figures = step.outputs
    cells, intervals = read_cells(step.inputs["blocks"]), step.run.recognition.intervals
    table = touches_needed(cells, intervals)
    write_table(TOUCHES_NEEDED, table, needed)
    curves = [
        {**dict(zip(_KEYS, key, strict=True)), "points": _points(curve, intervals)}
        for key, curve in sorted(_curves(cells).items())
    ]
    by_name = {"curves": nested(curves, _KEYS), "needed": nested(table.to_pylist(), _KEYS)}
    write_json(by_name, figures)


def _points(curve: Sequence[Cell], intervals: IntervalParameters) -> list[list[float | None]]:
    """Return accuracy, low and high end by number of touches."""
    found = (condition_interval(cell, intervals) for cell in curve)
    return [[one.mean, one.low, one.high] for one in found]


def _curves(cells: Mapping[CellKey, Cell]) -> dict[tuple[str, ...], list[Cell]]:
    names = [touches_name(count) for count in range(1, LONGEST_SEQUENCE + 1)]
    curves = {
        rest: [cells[key] for name in names if (key := CellKey(name, *rest)) in cells]
        for rest in dict.fromkeys(key[1:] for key in cells)
    }
    return {
        key: curve
        for key, curve in curves.items()
        if len(curve) == len(names) and not any(cell.error for cell in curve)
    }


def _reached(points: Sequence[Interval]) -> dict[str, int | None]:
    # The upper end of the accuracy gives the lower end of the number of touches.
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
        classes = [category for category, _ in curve[0].objects]
        compared = compare_paired(curve_areas(reference), areas, weights, intervals, classes)
    return {**ends("area", "area_", area), **paired_with_classes("gain", "p_value", compared)}
