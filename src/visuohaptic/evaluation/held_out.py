"""Evaluate a fitted model on held-out objects: objects that it was not trained on."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import RecognitionError
from visuohaptic.evaluation.intervals import object_interval, plain_interval
from visuohaptic.evaluation.summary import select
from visuohaptic.recognition.voting import evenly_spaced_subsets
from visuohaptic.tables.phases import owners_of
from visuohaptic.tables.schema import build_rows, join_parts
from visuohaptic.tables.studies import EVALUATION

if TYPE_CHECKING:
    from visuohaptic.recognition.model import RecognitionModel
    from visuohaptic.recognition.parameters import IntervalParameters

VIEWS = (1, 4, 16)
"""Numbers of views from which an object is classified. An object with fewer views uses all of its views."""


def evaluate_model(model: RecognitionModel, features: pa.Table) -> pa.Table:
    """Classify objects that a model was not trained on, from every evenly spaced choice of 1, 4 and 16 views.

    Parameters
    ----------
    model : RecognitionModel
        A calibrated model of pipeline `order_free`.
    features : pyarrow.Table
        Rows of `tables.FEATURES` with the settings of the training objects. Rows of strategies that the model was
        not trained on are ignored.

    Returns
    -------
    pyarrow.Table
        `tables.EVALUATION`.

    Raises
    ------
    RecognitionError
        If no new object has a class that the model knows, or the model has no prediction sets.
    """
    parts = [_evaluate_strategy(model, features, strategy) for strategy in model.strategies]
    return join_parts(EVALUATION, parts)


def _evaluate_strategy(model: RecognitionModel, features: pa.Table, strategy: str) -> pa.Table:
    """Evaluate a model on the touches by one strategy."""
    own = select(features, strategy=strategy)
    touched = set(owners_of(own))
    new = sorted(touched - set(model.objects))
    if not any(category in model.classes for category, _ in new):
        raise RecognitionError(
            f"None of {len(touched)} objects touched by {strategy} is new to the model and of a class that "
            "the model knows; at least one is needed."
        )
    rows = [
        {"class": category, "object": name, **row}
        for category, name in new
        for row in _classify_object(
            model, select(own, **{"class": category}, object=name), category
        )
    ]
    same = {
        "strategy": strategy,
        "classifier": model.classifier,
        "stated": model.parameters.order_free.coverage,
        "learnt": len(model.objects),
    }
    return build_rows(EVALUATION, [{**same, **row} for row in rows])


def _classify_object(
    model: RecognitionModel, touches: pa.Table, category: str
) -> Iterator[dict[str, object]]:
    """Yield the columns of each prediction for an object of class `category`."""
    viewpoint = touches.column("viewpoint").to_numpy()
    seen = np.unique(viewpoint)
    for views in sorted({min(views, len(seen)) for views in VIEWS}):
        for bag, chosen in enumerate(evenly_spaced_subsets(len(seen), views)):
            answer = model.answer(touches.filter(pa.array(np.isin(viewpoint, seen[chosen]))))
            if answer.candidates is None:
                raise RecognitionError(
                    "The model has no prediction sets. Train it in pipeline order_free, with at least two "
                    "objects of every class."
                )
            yield {
                "views": views,
                "bag": bag,
                "known": category in model.classes,
                "correct": next(iter(answer.probabilities)) == category,
                "covered": category in answer.candidates,
                "candidates": len(answer.candidates),
                "unknown": bool(answer.unknown),
            }


def summarise_evaluation(table: pa.Table, intervals: IntervalParameters) -> list[dict[str, Any]]:
    """Summarise `tables.EVALUATION` by strategy and number of views with `sum_up_answers`."""
    parts = [select(table, strategy=name) for name in table.column("strategy").unique().to_pylist()]
    return [
        figures
        for part in parts
        for figures, _ in sum_up_answers(part, part["stated"][0].as_py(), intervals)
    ]


def sum_up_answers(
    table: pa.Table, coverage: float, intervals: IntervalParameters
) -> Iterator[tuple[dict[str, Any], pa.Table]]:
    """Summarise predictions per strategy and number of views.

    Parameters
    ----------
    table : pyarrow.Table
        One row per prediction, with columns ``strategy``, ``views``, ``class``, ``object``, ``candidates``, and the
        booleans ``known``, ``correct``, ``covered`` and ``unknown``.
    coverage : float
        The stated coverage of the prediction sets.
    intervals : IntervalParameters
        The confidence of the intervals over objects.

    Yields
    ------
    figures : dict
        Each share as mean, low and high, and ``set_size``, the mean size of the prediction sets. Shares without
        objects are left out.
    rows : pyarrow.Table
        The rows of the strategy and number of views.
    """
    for strategy in table.column("strategy").unique().to_pylist():
        for views in table.column("views").unique().to_pylist():
            rows = select(table, strategy=strategy, views=views)
            known = select(rows, known=True)
            figures: dict[str, Any] = {"strategy": strategy, "views": views, "stated": coverage}
            for name, counted, column in (
                ("accuracy", known, "correct"),
                ("coverage", known, "covered"),
                ("false_unknown", known, "unknown"),
                ("found_unknown", select(rows, known=False), "unknown"),
            ):
                if len(counted):
                    means, counts = _by_object(counted, column)
                    interval = object_interval(means, counts, intervals)
                    figures[name] = list(plain_interval(interval).values())
            figures["set_size"] = float(np.mean(known["candidates"].to_numpy()))
            yield figures, rows


def _by_object(rows: pa.Table, column: str) -> tuple[FloatArray, FloatArray]:
    """Return each object's mean of a boolean column, and its number of rows."""
    keys = ["class", "object"]
    means = rows.group_by(keys, use_threads=False).aggregate([(column, "mean"), ([], "count_all")])
    return (
        means[f"{column}_mean"].to_numpy(),
        means["count_all"].to_numpy().astype(np.float64),
    )
