"""What the table of gaze says: means over objects with intervals, and how predictors differ."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.gaze.predicting import PREDICTORS, Predictor

RESAMPLES = 10_000
LEVEL = 0.95
SHOWN = ("correlation", "auc_top", "auc_gaze", "normalised_saliency", "divergence", "similarity")


@dataclass(frozen=True)
class Estimate:
    """A mean over objects, and its interval by resampling objects."""

    mean: float
    low: float
    high: float


@dataclass(frozen=True)
class PredictorRow:
    """One predictor over all objects of a part.

    Attributes
    ----------
    predictor : Predictor
        Which.
    measures : mapping of str to Estimate
        By the names of `SHOWN`.
    gain : Estimate
        Correlation less that of `equal`, over the same objects.
    positive : int
        Objects on which the correlation is above 0.
    objects : int
        How many there are.
    """

    predictor: Predictor
    measures: Mapping[str, Estimate]
    gain: Estimate
    positive: int
    objects: int


def estimate(values: NDArray[np.float64], seed: int = 0) -> Estimate:
    """Give the mean and its percentile bootstrap interval, shape (n,) of objects, n at least 1."""
    generator = np.random.default_rng(seed)
    drawn = generator.integers(0, len(values), (RESAMPLES, len(values)))
    low, high = np.quantile(values[drawn].mean(axis=1), [(1 - LEVEL) / 2, (1 + LEVEL) / 2])
    return Estimate(float(values.mean()), float(low), float(high))


def summarise(table: pa.Table, part: str) -> list[PredictorRow]:
    """Sum up rows of `tables.GAZE` of one part, in the order of `PREDICTORS`; empty without rows."""
    rows = [row for row in table.to_pylist() if row["part"] == part]
    by_name: dict[str, list[dict[str, Any]]] = {}
    for row in sorted(rows, key=lambda row: str(row["object"])):
        by_name.setdefault(row["predictor"], []).append(row)
    if not by_name:
        return []
    base = _column(by_name["equal"], "correlation")
    return [
        PredictorRow(
            predictor,
            {name: estimate(_column(by_name[predictor.name], name)) for name in SHOWN},
            estimate(_column(by_name[predictor.name], "correlation") - base),
            int((_column(by_name[predictor.name], "correlation") > 0).sum()),
            len(base),
        )
        for predictor in PREDICTORS
        if predictor.name in by_name
    ]


def _column(rows: Sequence[Mapping[str, Any]], name: str) -> NDArray[np.float64]:
    return np.array([row[name] for row in rows], dtype=np.float64)
