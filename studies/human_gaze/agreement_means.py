"""Compute means of agreement over objects with intervals, and differences between predictors."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
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
    compare_differences,
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
"""Measures, each with its smallest and largest possible value."""
_GAIN: Bounds = (-2.0, 2.0)


@dataclass(frozen=True)
class PredictorRow:
    """One predictor over all objects of a part.

    Attributes
    ----------
    predictor : Predictor
    measures : mapping of str to Interval
        Mean of each measure of `SHOWN`.
    gain : Interval
        Mean correlation minus the mean correlation of the predictor to compare with.
    positive : int
        Objects with a gain above 0.
    objects : int
        Number of objects.
    """

    predictor: Predictor
    measures: Mapping[str, Interval]
    gain: Interval
    positive: int
    objects: int


def summarise(table: pa.Table, part: str) -> list[PredictorRow]:
    """Summarise `AGREEMENT` by predictor over the objects of one part, with gains over predictor ``equal``.

    `part` is ``training`` or ``test``. Predictor ``peer`` is left out.
    """
    rows = [row for row in table.to_pylist() if row["part"] == part]
    return _summed([row for row in rows if row["predictor"] != "peer"], "equal")


def beside_peer(table: pa.Table) -> list[PredictorRow]:
    """Summarise `AGREEMENT` by predictor over the objects that the peer predicted, with gains over the peer.

    Returns an empty list without a peer.
    """
    rows = table.to_pylist()
    predicted = {row["object"] for row in rows if row["predictor"] == "peer"}
    return _summed([row for row in rows if row["object"] in predicted], "peer")


def _summed(rows: Sequence[Mapping[str, Any]], against: str) -> list[PredictorRow]:
    by_name: dict[str, list[Mapping[str, Any]]] = {}
    for row in sorted(rows, key=lambda row: str(row["object"])):
        by_name.setdefault(row["predictor"], []).append(row)
    if not by_name:
        return []
    predictors = [predictor for predictor in PREDICTORS if predictor.name in by_name]
    figures = [_figures(by_name[predictor.name]) for predictor in predictors]
    base = _figures(by_name[against])[:, 0]
    weights, parameters = np.ones(len(base)), IntervalParameters()
    return [
        PredictorRow(
            predictor,
            {
                name: object_interval(column, weights, parameters, bounds)
                for (name, bounds), column in zip(SHOWN.items(), values.T, strict=True)
            },
            compare_differences(values[:, 0] - base, weights, parameters, _GAIN).difference,
            int((values[:, 0] > 0).sum()),
            len(base),
        )
        for predictor, values in zip(predictors, figures, strict=True)
    ]


def _figures(rows: Sequence[Mapping[str, Any]]) -> FloatArray:
    """Return the measures of `SHOWN`, shape (objects, measures)."""
    return np.array([[row[name] for name in SHOWN] for row in rows], dtype=np.float64)
