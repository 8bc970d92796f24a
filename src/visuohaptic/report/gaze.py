"""One sentence on the agreement of saliency with people's gaze."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from visuohaptic.base.errors import ReportError, TableError
from visuohaptic.evaluation.intervals import CORRELATION, object_interval
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.estimates import estimate, with_interval
from visuohaptic.report.wording import decimal
from visuohaptic.tables.schema import open_parquet

PREDICTORS = ("equal", "chosen")
"""Saliency with equal weights of all channels, and with weights and terms fitted to other objects."""


def gaze_sentence(path: str | Path | None) -> str:
    """Return the sentence on a table of agreement; empty if `path` is None.

    The table has one row per object and predictor, with the columns ``object``, ``predictor``, ``part`` and
    ``correlation``. The JSON value ``origin`` in its metadata has its date.

    Raises
    ------
    ReportError
        If the file is no such table.
    """
    if path is None:
        return ""
    try:
        table = open_parquet(path).read()
        date = json.loads(table.schema.metadata[b"origin"])["date"]
        rows = [row for row in table.to_pylist() if row["part"] == "training"]
        correlations = {(row["predictor"], row["object"]): row["correlation"] for row in rows}
        objects = sorted({row["object"] for row in rows})
        values = np.array(
            [[correlations[name, key] for name in PREDICTORS] for key in objects], float
        )
        weights = np.ones(len(objects))
        intervals = [
            object_interval(column, weights, IntervalParameters(), CORRELATION)
            for column in values.T
        ]
    except (OSError, TableError, ValueError, LookupError, TypeError) as error:
        why = " ".join(str(error).split()).rstrip(".")
        raise ReportError(
            f"{path} holds no table of agreement with gaze ({why}); "
            f"`git checkout {path}` restores the kept one."
        ) from error
    equal, fitted = (with_interval(estimate(interval), decimal) for interval in intervals)
    return (
        f"Saliency agrees with people's gaze on {len(objects)} objects with recorded gaze (measured on {date}, not in "
        f"this run). The saliency map's correlation with the time that people looked at each place is {equal} with "
        f"equal weights of all channels. With weights and terms that were fitted to other objects it is {fitted}."
    )
