"""Means of agreement over objects, with intervals, and how predictors differ."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import cycle, islice
from typing import Any

import numpy as np
import pyarrow as pa

from human_gaze.predicting import PREDICTORS, Predictor
from visuohaptic.base.arrays import FloatArray
from visuohaptic.evaluation.intervals import (
    CORRELATION,
    SHARE,
    UNBOUNDED,
    Bounds,
    Interval,
    object_interval,
)
from visuohaptic.recognition.parameters import IntervalParameters

SHOWN: Mapping[str, Bounds] = {
    "correlation": CORRELATION,
    "auc_top": SHARE,
    "auc_gaze": SHARE,
    "normalised_saliency": UNBOUNDED,
    "divergence": (0.0, math.inf),
    "similarity": SHARE,
}
"""Measures, each with the least and the largest value that it can have."""
_GAIN: Bounds = (-2.0, 2.0)


@dataclass(frozen=True)
class PredictorRow:
    """One predictor over all objects of a part: `measures` by the names of `SHOWN`.

    `gain` is the correlation less that of what it is compared with; on `positive` objects it is above 0.
    """

    predictor: Predictor
    measures: Mapping[str, Interval]
    gain: Interval
    positive: int
    objects: int


def summarise(table: pa.Table, part: str) -> list[PredictorRow]:
    """Sum up rows of `AGREEMENT` of one part but the peer's, by `PREDICTORS`, with gains over ``equal``."""
    rows = [row for row in table.to_pylist() if row["part"] == part]
    return _summed([row for row in rows if row["predictor"] != "peer"], "equal")


def beside_peer(table: pa.Table) -> list[PredictorRow]:
    """Sum up rows of the objects that a peer predicted, with gains over it; empty without a peer."""
    rows = table.to_pylist()
    known = {row["object"] for row in rows if row["predictor"] == "peer"}
    return _summed([row for row in rows if row["object"] in known], "peer")


def _summed(rows: Sequence[Mapping[str, Any]], against: str) -> list[PredictorRow]:
    by_name: dict[str, list[Mapping[str, Any]]] = {}
    for row in sorted(rows, key=lambda row: str(row["object"])):
        by_name.setdefault(row["predictor"], []).append(row)
    if not by_name:
        return []
    predictors = [predictor for predictor in PREDICTORS if predictor.name in by_name]
    figures = [_figures(by_name[predictor.name]) for predictor in predictors]
    base = _figures(by_name[against])[:, :1]
    columns = np.column_stack([part for own in figures for part in (own, own[:, :1] - base)])
    weights = np.ones(len(base))
    bounds = cycle([*SHOWN.values(), _GAIN])
    intervals = (
        object_interval(column, weights, IntervalParameters(), own)
        for column, own in zip(columns.T, bounds, strict=False)
    )
    return [
        PredictorRow(
            predictor,
            dict(zip(SHOWN, islice(intervals, len(SHOWN)), strict=True)),
            next(intervals),
            int((own[:, 0] > 0).sum()),
            len(base),
        )
        for predictor, own in zip(predictors, figures, strict=True)
    ]


def _figures(rows: Sequence[Mapping[str, Any]]) -> FloatArray:
    """Give the measures of `SHOWN`, shape (objects, measures)."""
    return np.array([[row[name] for name in SHOWN] for row in rows], dtype=np.float64)
