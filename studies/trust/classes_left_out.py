"""Measure prediction sets and the answer `unknown` with models that lack a whole class."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from sklearn.pipeline import Pipeline

from trust.tables import STATED_COVERAGES, TRUST
from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.base.errors import RecognitionError
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.evaluation.held_out import VIEWS, sum_up_answers
from visuohaptic.evaluation.summary import select
from visuohaptic.recognition.certainty import Certainty, fit_certainty
from visuohaptic.recognition.descriptors import describe_all
from visuohaptic.recognition.experiment import one_thread
from visuohaptic.recognition.pipelines import (
    fit_calibrated,
    log_probabilities,
    make_order_free,
    pooled_log_probabilities,
)
from visuohaptic.recognition.sequences import TouchSequences, gather_pipeline, take_strategy
from visuohaptic.recognition.splits import grouped_folds, objects_of_classes
from visuohaptic.recognition.voting import evenly_spaced_subsets
from visuohaptic.studies.conditions import HEADLINE_CLASSIFIERS
from visuohaptic.studies.figures import write_json
from visuohaptic.studies.study import StepInputs
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import build_rows, read_table, write_table

if TYPE_CHECKING:
    from visuohaptic.recognition.parameters import IntervalParameters, RecognitionParameters


def measure_trust(
    features: pa.Table,
    strategy: str,
    classifier: str,
    parameters: RecognitionParameters,
    seed: int,
) -> pa.Table:
    """Classify known and unknown objects by models that lack one class each; return `TRUST`.

    Each class is left out in turn, and all of its objects are unknown to the model. Of the other classes, one grouped
    fold of objects is tested, and the rest trains pipeline `order_free`. Raises `RecognitionError` if there are fewer
    than three classes, or too few objects.
    """
    table, _ = take_strategy(features, strategy, parameters.touches)
    sequences = gather_pipeline(table, parameters, "order_free", seed)
    if len(sequences.classes) < 3:
        raise RecognitionError(
            f"There are {len(sequences.classes)} classes; at least three are needed to leave one out."
        )
    described = describe_all(sequences, parameters, seed)
    rows: list[dict[str, object]] = []
    with one_thread():
        for left_out in range(len(sequences.classes)):
            generator = spawn_generator(seed, "certainty", left_out)
            tested = _draw_tested(sequences, left_out, parameters.protocol.folds, generator)
            unseen = np.isin(sequences.object_index, tested)
            unseen |= sequences.labels == left_out
            model = fit_without(sequences, described, unseen, classifier, generator)
            if model is None:
                raise RecognitionError(
                    f"Without class {sequences.classes[left_out]} and the tested objects every class has "
                    "one training object; at least three objects of one class are needed."
                )
            for index in np.unique(sequences.object_index[unseen]):
                answers = _classify(sequences, described, model, index, parameters)
                rows += [{"left_out": sequences.classes[left_out], **row} for row in answers]
    same = {"strategy": strategy, "classifier": classifier}
    return build_rows(
        TRUST, [{**same, "known": row["class"] != row["left_out"], **row} for row in rows]
    )


def summarise_trust(
    table: pa.Table, coverage: float, intervals: IntervalParameters
) -> list[dict[str, Any]]:
    """Summarise `TRUST` by strategy and number of views: the figures of `sum_up_answers`, and ``area``.

    ``area`` is the area under the ROC curve of unknown against known objects, a mean over the classes left out.
    """
    summary = []
    for figures, rows in sum_up_answers(table, coverage, intervals):
        areas = [
            _area(select(rows, left_out=name)) for name in rows["left_out"].unique().to_pylist()
        ]
        summary.append(figures | {"area": float(np.mean(areas))})
    return summary


def make_trust(step: StepInputs) -> None:
    """Write `TRUST` of every strategy, and its summary as JSON."""
    run, (table, metrics) = step.run, step.outputs
    rows = read_table(FEATURES, step.inputs["features"])
    classifier = HEADLINE_CLASSIFIERS["order_free"]
    measured = pa.concat_tables(
        measure_trust(rows, strategy, classifier, run.recognition, run.seed)
        for strategy in run.probing.strategies
    )
    write_table(TRUST, measured, table)
    recognition = run.recognition
    summary = summarise_trust(measured, recognition.order_free.coverage, recognition.intervals)
    write_json(summary, metrics)


def _draw_tested(
    sequences: TouchSequences, left_out: int, folds: int, generator: np.random.Generator
) -> tuple[int, ...]:
    """Return one fold of the objects of all classes except `left_out`."""
    members = objects_of_classes(sequences)
    known_classes = [objects for label, objects in enumerate(members) if label != left_out]
    drawn_folds = grouped_folds(known_classes, folds, generator)
    return drawn_folds[left_out % len(drawn_folds)]


def fit_without(
    sequences: TouchSequences,
    described: FloatArray,
    unseen: BoolArray,
    classifier: str,
    generator: np.random.Generator,
) -> tuple[Pipeline, Certainty] | None:
    """Fit pipeline `order_free` and its `Certainty` on the sequences that are not `unseen` (s,).

    `described` (s, d) are the descriptors of all sequences. Returns None if every class has only one training object.
    """

    def fit(rows: FloatArray, labels: IntArray, owners: IntArray) -> Pipeline:
        pipeline = make_order_free(classifier)
        preparation = pipeline[:-1].fit(rows)
        fitted = fit_calibrated(pipeline[-1], preparation.transform(rows), labels, owners)
        return Pipeline([("preparation", preparation), ("classifier", fitted)])

    training = (described[~unseen], sequences.labels[~unseen], sequences.object_index[~unseen])
    model = fit(*training)
    certainty = fit_certainty(fit, model, *training, generator)
    return None if certainty is None else (model, certainty)


def _classify(
    sequences: TouchSequences,
    described: FloatArray,
    model: tuple[Pipeline, Certainty],
    index: int,
    parameters: RecognitionParameters,
) -> Iterator[dict[str, object]]:
    """Yield one row of answers per number of views of an object."""
    pipeline, certainty = model
    category, name = sequences.objects[index]
    label, coverage = sequences.classes.index(category), parameters.order_free.coverage
    rows = pipeline[:-1].transform(described[sequences.object_index == index])
    logs = log_probabilities(pipeline[-1], rows, len(sequences.classes))
    most = int(np.bincount(sequences.object_index).max())
    for views in sorted({min(views, most) for views in VIEWS}):
        # An object with fewer views is classified from all of them.
        choices = evenly_spaced_subsets(len(rows), min(views, len(rows)))
        chosen = np.isin(np.arange(len(rows)), choices[index % len(choices)])
        answer = pooled_log_probabilities(logs, chosen[None])[0]
        sure = certainty.assess(rows[chosen], answer, coverage)
        sets = {
            stated: certainty.prediction_set(answer, chosen.sum(), stated / 100)
            for stated in STATED_COVERAGES
        }
        yield {
            "class": category,
            "object": name,
            "views": views,
            "correct": bool(answer.argmax() == label),
            "covered": bool(sure.candidates[label]),
            "covered_at": [stated for stated, candidates in sets.items() if candidates[label]],
            "candidates": int(sure.candidates.sum()),
            "novelty_rank": sure.novelty_rank,
            "evidence": sure.novelty,
            "unknown": sure.unknown,
        }


def _area(rows: pa.Table) -> float:
    """Compute the area under the ROC curve of a class left out against the known objects in the same rows."""
    from sklearn.metrics import roc_auc_score

    return float(roc_auc_score(pc.invert(rows["known"]).to_numpy(), rows["evidence"].to_numpy()))
