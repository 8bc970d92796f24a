"""Evaluate a fitted model on objects that it was not trained on.

`odd.parquet` beside this file is `tables.EVALUATION` of the 22 objects of set `odd`, classified by models of the 142
objects of set `benchmark`. Its metadata holds its source.
`python -m visuohaptic.studies.evaluation.models reports/evaluation.parquet COMMAND PROCESSOR` writes it again.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.resources import as_file, files
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa

from visuohaptic.base.errors import RecognitionError
from visuohaptic.evaluation.summary import select
from visuohaptic.recognition.voting import evenly_spaced_subsets
from visuohaptic.studies.evaluation.answers import VIEWS, sum_up_answers
from visuohaptic.studies.stored import Source, source_of, store_table
from visuohaptic.tables.phases import owners_of
from visuohaptic.tables.schema import build_rows, join_parts, read_table
from visuohaptic.tables.studies import EVALUATION

if TYPE_CHECKING:
    from visuohaptic.recognition.model import RecognitionModel
    from visuohaptic.recognition.parameters import IntervalParameters

KEPT = "odd.parquet"


@dataclass(frozen=True)
class MeasuredEvaluation:
    """`tables.EVALUATION`, and its source if it is the table of the package instead of the run's."""

    table: pa.Table
    source: Source | None = None


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


def read_evaluation(path: str | Path | None) -> MeasuredEvaluation:
    """Read the run's `tables.EVALUATION` if the file exists, else the table of the package."""
    if path is not None and Path(path).is_file():
        return MeasuredEvaluation(read_table(EVALUATION, path))
    with as_file(files("visuohaptic.studies.evaluation").joinpath(KEPT)) as file:
        return MeasuredEvaluation(read_table(EVALUATION, file), source_of(file))


if __name__ == "__main__":
    measured, command, machine = sys.argv[1:]
    store_table(EVALUATION, measured, Path(__file__).with_name(KEPT), command, machine)
