"""Accuracy per number of touches, and the rule that stops where the answer is certain."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyarrow as pa

from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.evaluation.intervals import compare_paired, object_interval
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.studies.figures import LEADER, ends, paired, rows_by
from visuohaptic.tables.phases import keys_of

CERTAIN = 0.95
"""Probability from which an answer is certain."""


def summarise(answers: pa.Table, intervals: IntervalParameters) -> list[dict[str, Any]]:
    """Summarise `KNOWN_OBJECTS`: one entry per strategy.

    ``by_touches`` has the accuracy after each number of touches with its interval over objects, and what `LEADER` is
    ahead in pairs over objects. ``stopping`` has the figures of `stop_when_certain`.
    """
    found: list[dict[str, Any]] = []
    accuracies: dict[str, tuple[list[str], FloatArray]] = {}
    for (strategy,), rows in rows_by(answers, ["strategy"]).items():
        objects, owners, correct, probability = by_view(rows)
        views = np.bincount(owners).astype(np.float64)
        accuracy = np.stack([np.bincount(owners, weights=row) for row in correct]) / views
        accuracies[strategy] = objects, accuracy
        by_touches = []
        for index, values in enumerate(accuracy):
            lead = None
            known, leading = accuracies.get(LEADER, ([], accuracy))
            if strategy != LEADER and known == objects:
                lead = compare_paired(leading[index], values, views, intervals)
            by_touches.append(
                {
                    "touches": index + 1,
                    **ends("accuracy", "", object_interval(values, views, intervals)),
                    **paired("lead", "p_value", lead),
                }
            )
        found.append(
            {
                "strategy": strategy,
                "objects": objects,
                "turns": len(rows.column("turn").unique()),
                "views": views.astype(int).tolist(),
                "accuracy": accuracy[-1].tolist(),
                "by_touches": by_touches,
                "stopping": stop_when_certain(owners, correct, probability, intervals),
            }
        )
    return found


def by_view(rows: pa.Table) -> tuple[list[str], IntArray, BoolArray, FloatArray]:
    """Arrange rows of `KNOWN_OBJECTS` of one strategy by view and touch.

    Returns the o objects, the object of each view (n,), whether the answer is correct (t, n), and its probability
    (t, n).
    """
    names = ("touches", "class", "object", "turn", "viewpoint")
    rows = rows.sort_by([(name, "ascending") for name in names])
    touches = len(rows.column("touches").unique())
    keys = keys_of(rows).to_pylist()[: rows.num_rows // touches]
    objects = sorted(set(keys))
    owners = np.array([objects.index(key) for key in keys])
    correct = rows.column("correct").to_numpy(zero_copy_only=False).reshape(touches, -1)
    probability = rows.column("probability").to_numpy().reshape(touches, -1)
    return objects, owners, correct, probability


def stop_when_certain(
    owners: IntArray, correct: BoolArray, probability: FloatArray, intervals: IntervalParameters
) -> dict[str, Any]:
    """Compute figures of the rule that touches until the probability of the answer is at least `CERTAIN`.

    A view that is never certain stops after its last touch.

    Parameters
    ----------
    owners : ndarray of shape (n,)
        Object of each view.
    correct : ndarray of shape (t, n), bool
        Whether the answer after each touch is correct.
    probability : ndarray of shape (t, n)
        Probability of the answer.
    intervals : IntervalParameters
        The confidence of the intervals over objects.

    Returns
    -------
    dict
        ``certain``: share of views that become certain; ``right``: share of these whose answer is correct; ``made``:
        mean number of touches; ``stopped``: share of all views whose last answer is correct; ``median``: number of
        touches after which half of the views are certain, None if fewer are. The first four have interval ends.
    """
    most, count = probability.shape
    reached = probability >= CERTAIN
    certain = reached.any(axis=0)
    last = np.where(certain, reached.argmax(axis=0), most - 1)
    right = correct[last, np.arange(count)]
    views = np.bincount(owners).astype(np.float64)
    certain_views = np.bincount(owners, weights=certain).astype(np.float64)
    some = certain_views > 0
    figures = {
        "certain": object_interval(certain_views / views, views, intervals),
        "right": object_interval(
            np.bincount(owners, weights=right & certain)[some] / certain_views[some],
            certain_views[some],
            intervals,
        )
        if some.any()
        else None,
        "made": object_interval(
            np.bincount(owners, weights=last + 1) / views, views, intervals, (1.0, float(most))
        ),
        "stopped": object_interval(np.bincount(owners, weights=right) / views, views, intervals),
    }
    shares = np.mean(np.logical_or.accumulate(reached, axis=0), axis=1)
    return {
        "stated": CERTAIN,
        **{
            key: value
            for name, one in figures.items()
            for key, value in ends(name, f"{name}_", one).items()
        },
        "median": int((shares >= 0.5).argmax()) + 1 if shares[-1] >= 0.5 else None,
    }
