"""Curves of accuracy over touches, the area under each, and how many touches a level takes."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.errors import RecognitionError
from visuohaptic.recognition.curves import TouchCurve
from visuohaptic.recognition.intervals import Interval, compare_paired, object_interval
from visuohaptic.recognition.metrics import round_numbers
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.recognition.summary import REFERENCE_STRATEGY
from visuohaptic.seeds import spawn_generator
from visuohaptic.tables.schema import (
    build_table,
    matrix,
    read_table,
    write_table,
)
from visuohaptic.tables.studies import CURVES, TOUCH_CURVES, TOUCHES_NEEDED

LEVEL = 0.9
"""The accuracy of which it is told how many touches it needs."""

Key = tuple[str, str, str]


class ObjectCurves:
    """The curves of one pipeline, strategy and classifier, an object each.

    Attributes
    ----------
    objects : list of (str, str)
        The o objects as (class, name), sorted.
    touches : list of int
        The t numbers of touches, ascending.
    accuracy : numpy.ndarray
        Shape (o, t), float64.
    weights : numpy.ndarray
        Shape (o,), float64.
    """

    def __init__(self, rows: pa.Table) -> None:
        keys = ["class", "object", "touches"]
        rows = rows.sort_by([(key, "ascending") for key in keys])
        owners = list(zip(*(rows.column(key).to_pylist() for key in keys[:2]), strict=True))
        self.objects = sorted(set(owners))
        self.touches = sorted(set(rows.column("touches").to_pylist()))
        values = matrix(rows, ["accuracy", "weight"])
        if len(values) != len(self.objects) * len(self.touches):
            raise RecognitionError(
                f"The curves have {len(values)} points for {len(self.objects)} objects and "
                f"{len(self.touches)} numbers of touches; each object needs a point at each."
            )
        values = values.reshape(len(self.objects), len(self.touches), 2)
        self.accuracy: NDArray[np.float64] = values[:, :, 0]
        self.weights: NDArray[np.float64] = values[:, 0, 1]

    @property
    def areas(self) -> NDArray[np.float64]:
        """Area under each object's curve, of accuracy 1 throughout, shape (o,)."""
        if len(self.touches) == 1:
            return self.accuracy[:, 0]
        steps = np.diff(self.touches)
        middles = (self.accuracy[:, 1:] + self.accuracy[:, :-1]) / 2
        areas: NDArray[np.float64] = middles @ steps / steps.sum()
        return areas


def sum_curves(
    curves: pa.Table, intervals: IntervalParameters, seed: int
) -> tuple[pa.Table, pa.Table]:
    """Sum up objects' curves, with intervals over objects.

    Parameters
    ----------
    curves : pyarrow.Table
        `tables.CURVES` of any pipelines and strategies.
    intervals : IntervalParameters
        Resampling over objects.
    seed : int
        The experiment's seed.

    Returns
    -------
    points : pyarrow.Table
        `tables.TOUCH_CURVES`.
    needed : pyarrow.Table
        `tables.TOUCHES_NEEDED`; what fixations gain is missing for fixations themselves, and where they
        weren't run.

    Raises
    ------
    RecognitionError
        If an object lacks a point, or strategies to be compared were tested on other objects.
    """
    found = {key: ObjectCurves(rows) for key, rows in _by_key(curves).items()}
    points: list[dict[str, Any]] = []
    needed: list[dict[str, Any]] = []
    for key, of_objects in sorted(found.items()):
        names = dict(zip(("pipeline", "strategy", "classifier"), key, strict=True))
        means = [
            object_interval(
                of_objects.accuracy[:, place],
                of_objects.weights,
                intervals,
                spawn_generator(seed, "curves", *key, count),
            )
            for place, count in enumerate(of_objects.touches)
        ]
        for count, mean in zip(of_objects.touches, means, strict=True):
            ends = {"accuracy": mean.mean, "low": mean.low, "high": mean.high}
            points.append({**names, "touches": count, **ends})
        reference = found.get((key[0], REFERENCE_STRATEGY, key[2]))
        needed.append({**names, **_needs(key, of_objects, means, reference, intervals, seed)})
    return (
        build_table(TOUCH_CURVES, _columns(points)),
        build_table(TOUCHES_NEEDED, _columns(needed)),
    )


def make_touches_needed(
    curves: Sequence[str | Path],
    points: str | Path,
    needed: str | Path,
    figures: str | Path,
    intervals: IntervalParameters,
    seed: int,
) -> None:
    """Sum up curves into two tables, and into a JSON file beside the metrics.

    Parameters
    ----------
    curves : sequence of path
        All parts of `tables.CURVES`.
    points, needed : path
        The Parquet files to write.
    figures : path
        The JSON file: the same numbers, by pipeline, strategy and classifier.
    intervals : IntervalParameters
        Resampling over objects.
    seed : int
        The experiment's seed.
    """
    curve, need = sum_curves(read_table(CURVES, curves), intervals, seed)
    write_table(TOUCH_CURVES, curve, points)
    write_table(TOUCHES_NEEDED, need, needed)
    text = json.dumps(round_numbers(_nested(curve, need)), indent=2, sort_keys=True)
    Path(figures).parent.mkdir(parents=True, exist_ok=True)
    Path(figures).write_text(text + "\n", encoding="utf-8")


def _needs(
    key: Key,
    of_objects: ObjectCurves,
    means: Sequence[Interval],
    reference: ObjectCurves | None,
    intervals: IntervalParameters,
    seed: int,
) -> dict[str, Any]:
    curve = TouchCurve(tuple(of_objects.touches), tuple(means))
    fewest, most = curve.touches_needed_interval(LEVEL)
    generator = spawn_generator(seed, "areas", *key)
    area = object_interval(of_objects.areas, of_objects.weights, intervals, generator)
    gain: dict[str, Any] = dict.fromkeys(("gain", "gain_low", "gain_high", "p_value"))
    if reference is not None and reference is not of_objects:
        if (reference.objects, reference.touches) != (of_objects.objects, of_objects.touches):
            raise RecognitionError(
                f"Strategies {REFERENCE_STRATEGY} and {key[1]} were not tested on the same objects "
                f"and numbers of touches; make the curves of both again."
            )
        generator = spawn_generator(seed, "areas", "comparison", *key)
        compared = compare_paired(
            reference.areas, of_objects.areas, of_objects.weights, intervals, generator
        )
        difference = compared.difference
        gain = {
            "gain": difference.mean,
            "gain_low": difference.low,
            "gain_high": difference.high,
            "p_value": compared.p_value,
        }
    return {
        "level": LEVEL,
        "touches": curve.touches_needed(LEVEL),
        "touches_low": fewest,
        "touches_high": most,
        "most_touches": of_objects.touches[-1],
        "area": area.mean,
        "area_low": area.low,
        "area_high": area.high,
        **gain,
        "objects": len(of_objects.objects),
    }


def _by_key(curves: pa.Table) -> dict[Key, pa.Table]:
    import pyarrow.compute as pc

    names = ["pipeline", "strategy", "classifier"]
    found: dict[Key, pa.Table] = {}
    for row in curves.select(names).group_by(names).aggregate([]).to_pylist():
        held = curves
        for name in names:
            held = held.filter(pc.equal(held.column(name), row[name]))
        found[row["pipeline"], row["strategy"], row["classifier"]] = held
    return found


def _columns(rows: Sequence[dict[str, Any]]) -> dict[str, list[Any]]:
    return {name: [row[name] for row in rows] for name in rows[0]}


def _nested(points: pa.Table, needed: pa.Table) -> dict[str, Any]:
    nested: dict[str, Any] = {}
    for row in needed.to_pylist():
        key = [row.pop(name) for name in ("pipeline", "strategy", "classifier")]
        nested.setdefault(key[0], {}).setdefault(key[1], {})[key[2]] = {**row, "curve": []}
    for row in points.to_pylist():
        key = [row.pop(name) for name in ("pipeline", "strategy", "classifier")]
        nested[key[0]][key[1]][key[2]]["curve"].append(row)
    return nested
