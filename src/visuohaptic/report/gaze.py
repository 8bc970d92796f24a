"""Sentences on the relation of saliency to people's gaze."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from visuohaptic.base.errors import ReportError, TableError
from visuohaptic.evaluation.intervals import CORRELATION, object_interval
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.estimates import Figure, estimate, with_interval
from visuohaptic.report.wording import decimal
from visuohaptic.tables.schema import open_parquet

PREDICTORS = ("equal", "chosen")
"""Saliency with equal weights of all channels, and with weights and terms fitted to other objects."""

RELATIONS = ((0.1, "unrelated"), (0.3, "weakly related"), (0.5, "moderately related"))
"""Words for correlations below a bound; from the last bound on the words are ``strongly related``.

The bounds are those of J. Cohen, Statistical Power Analysis for the Behavioral Sciences, 2nd edition, 1988, section 3.2.
"""

_RULE = (
    f"Rule: a correlation {', '.join(f'below {bound:g} is called {words}' for bound, words in RELATIONS)}, any other "
    "strongly related; it is called unrelated if its interval contains 0, and inversely related if all of its interval "
    "lies below 0."
)


def relation(correlation: Figure) -> str:
    """Return the words for a correlation with its interval, by `RELATIONS` and the sign."""
    if correlation.holds(0.0):
        return "unrelated"
    if correlation.mean < 0:
        return "inversely related"
    return next(
        (words for bound, words in RELATIONS if correlation.mean < bound), "strongly related"
    )


def gaze_sentence(path: str | Path | None) -> str:
    """Return the sentences on a table of agreement; empty if `path` is None.

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
    equal, fitted = map(estimate, intervals)
    return (
        f"With equal weights of all channels, saliency is {relation(equal)} to people's gaze on {len(objects)} objects with "
        f"recorded gaze (measured on {date}, not in this run): the saliency map's correlation with the time that people "
        f"looked at each place is {with_interval(equal, decimal)}. With weights and terms that were fitted to other "
        f"objects, saliency is {relation(fitted)} to people's gaze: {with_interval(fitted, decimal)}. {_RULE}"
    )
