"""Sentences on the relation of saliency to people's gaze."""

from __future__ import annotations

import numpy as np
import pyarrow as pa

from visuohaptic.evaluation.intervals import CORRELATION, object_interval
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.estimates import Estimate, estimate, with_interval
from visuohaptic.report.wording import decimal

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


def relation(correlation: Estimate) -> str:
    """Return the words for a correlation with its interval, by `RELATIONS` and the sign."""
    if correlation.holds(0.0):
        return "unrelated"
    if correlation.mean < 0:
        return "inversely related"
    return next(
        (words for bound, words in RELATIONS if correlation.mean < bound), "strongly related"
    )


def gaze_sentence(table: pa.Table, date: str) -> str:
    """Return sentences on rows of `AGREEMENT` for objects to which no weights were fitted, measured on a date."""
    rows = [row for row in table.to_pylist() if row["part"] == "training"]
    correlations = {(row["predictor"], row["object"]): row["correlation"] for row in rows}
    objects = sorted({row["object"] for row in rows})
    values = np.array([[correlations[name, key] for name in PREDICTORS] for key in objects], float)
    weights = np.ones(len(objects))
    intervals = [
        object_interval(column, weights, IntervalParameters(), CORRELATION) for column in values.T
    ]
    equal, fitted = map(estimate, intervals)
    return (
        f"With equal weights of all channels, saliency is {relation(equal)} to people's gaze on {len(objects)} objects with "
        f"recorded gaze (measured on {date}, not in this run): the saliency map's correlation with the time that people "
        f"looked at each place is {with_interval(equal, decimal)}. With weights and terms that were fitted to other "
        f"objects, saliency is {relation(fitted)} to people's gaze: {with_interval(fitted, decimal)}. {_RULE}"
    )
