"""How well saliency agrees with people's gaze, in one sentence."""

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
"""Equal weights of all channels; weights of the channels and terms that were chosen on other objects."""


def gaze_sentence(path: str | Path | None) -> str:
    """Return the sentence on a table of agreement, empty without a table.

    The table has one row per object and predictor, with the columns ``object``, ``predictor``, ``part`` and
    ``correlation``; the JSON ``origin`` of its metadata has its date. Raises `ReportError` for another file.
    """
    if path is None:
        return ""
    try:
        table = open_parquet(path).read()
        date = json.loads(table.schema.metadata[b"origin"])["date"]
        rows = [row for row in table.to_pylist() if row["part"] == "training"]
        found = {(row["predictor"], row["object"]): row["correlation"] for row in rows}
        objects = sorted({row["object"] for row in rows})
        values = np.array([[found[name, one] for name in PREDICTORS] for one in objects], float)
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
    equal, fitted = (with_interval(estimate(one), decimal) for one in intervals)
    return (
        f"Measured on {date}, not in this run: on {len(objects)} objects with recorded gaze, the saliency "
        f"map's correlation with the time that people looked at each place is {equal} with equal weights of "
        f"all channels, and {fitted} with weights and terms that were fitted to other objects."
    )
