"""Prediction sets and the answer `unknown`, measured with whole classes left out."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray

from trust.tables import STATED_COVERAGES, TRUST
from visuohaptic.base.errors import RecognitionError
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.evaluation.summary import select
from visuohaptic.recognition.certainty import fit_calibration, one_classifier
from visuohaptic.recognition.descriptors import describe_all
from visuohaptic.recognition.experiment import fitting, gather_pipeline
from visuohaptic.recognition.pooling import spread_choices
from visuohaptic.recognition.sequences import take_strategy
from visuohaptic.recognition.splits import grouped_folds, objects_of_classes
from visuohaptic.recognition.tuning import fit_best_classifiers
from visuohaptic.studies.conditions import CLASSIFIER
from visuohaptic.studies.evaluation.answers import VIEWS, sum_up_answers
from visuohaptic.studies.figures import write_json
from visuohaptic.studies.study import StepInputs
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import build_rows, read_table, write_table

if TYPE_CHECKING:
    from visuohaptic.recognition.parameters import IntervalParameters, RecognitionParameters
    from visuohaptic.recognition.sequences import TouchSequences


def measure_trust(
    features: pa.Table,
    strategy: str,
    classifier: str,
    parameters: RecognitionParameters,
    seed: int,
) -> pa.Table:
    """Classify known and unknown objects by models that lack one whole class each: `TRUST`.

    Of every class in turn, all objects are unknown; of the others, one grouped fold is tested and the
    rest trains and calibrates pipeline `best`. Raises `RecognitionError` of fewer than three classes.
    """
    table, _ = take_strategy(features, strategy, parameters.touches)
    sequences = gather_pipeline(table, parameters, "best", seed)
    if len(sequences.classes) < 3:
        raise RecognitionError(
            f"There are {len(sequences.classes)} classes; at least three are needed to leave one out."
        )
    described = describe_all(sequences, parameters.best, seed)
    one = one_classifier(parameters, classifier)
    rows: list[dict[str, object]] = []
    with fitting():
        for left_out in range(len(sequences.classes)):
            generator = spawn_generator(seed, "certainty", left_out)
            rows += _without_class(sequences, described, left_out, one, generator)
    key = {"strategy": strategy, "classifier": classifier}
    return build_rows(TRUST, [{**key, **row} for row in rows])


def summarise_trust(
    table: pa.Table, coverage: float, intervals: IntervalParameters, seed: int
) -> list[dict[str, Any]]:
    """Sum up `TRUST` by strategy and number of views: what `sum_up_answers` gives, and ``area``.

    That is under the curve that tells unknown objects from known ones, a mean over the classes left out.
    """
    found = []
    for figures, rows in sum_up_answers(table, coverage, intervals, seed):
        areas = [
            _area(select(rows, left_out=name)) for name in rows["left_out"].unique().to_pylist()
        ]
        found.append(figures | {"area": float(np.mean(areas))})
    return found


def make_trust(step: StepInputs) -> None:
    """Make `TRUST` of every strategy, and its summary as JSON."""
    run, (table, metrics) = step.run, step.outputs
    rows = read_table(FEATURES, step.inputs["features"])
    measured = pa.concat_tables(
        measure_trust(rows, strategy, CLASSIFIER, run.recognition, run.seed)
        for strategy in run.probing.strategies
    )
    write_table(TRUST, measured, table)
    recognition = run.recognition
    found = summarise_trust(measured, recognition.best.coverage, recognition.intervals, run.seed)
    write_json(found, metrics)


def _without_class(
    sequences: TouchSequences,
    described: NDArray[np.float64],
    left_out: int,
    parameters: RecognitionParameters,
    generator: np.random.Generator,
) -> Iterator[dict[str, object]]:
    """Train without a class and without a fold of the others, and classify both."""
    members = objects_of_classes(sequences)
    others = [objects for place, objects in enumerate(members) if place != left_out]
    folds = grouped_folds(others, parameters.protocol.folds, generator)
    tested = folds[left_out % len(folds)]
    owners = sequences.object_index
    trained = ~np.isin(owners, (*tested, *members[left_out]))
    known = sequences.take(trained)
    training = (known.labels, known.object_index, len(known.classes), parameters)
    projection, fits = fit_best_classifiers(described[trained], *training, generator)
    calibration = fit_calibration(known, described[trained], parameters, projection, generator)
    if calibration is None:
        raise RecognitionError(
            f"Without class {sequences.classes[left_out]} and the tested objects no class has two "
            "training objects; at least three objects of one class are needed."
        )
    tuned = fits[0][1]
    most = int(np.bincount(owners).max())
    for place in (*tested, *members[left_out]):
        category, name = sequences.objects[place]
        label = sequences.classes.index(category)
        projected = projection.apply(described[owners == place])
        touches = sequences.features[owners == place]
        ballots = tuned.ballots(projected)
        for views in sorted({min(views, most) for views in VIEWS}):
            # An object with fewer views gives all.
            choices = spread_choices(len(projected), min(views, len(projected)))
            bag = choices[place % len(choices)]
            member = np.isin(np.arange(len(projected)), bag)
            answer = ballots.together(member[None])[0]
            of_bag = touches[bag].reshape(-1, touches.shape[2])
            sure = calibration.assess(
                tuned, projected[bag], of_bag, answer, parameters.best.coverage
            )
            yield {
                "class": category,
                "object": name,
                "left_out": sequences.classes[left_out],
                "known": label != left_out,
                "views": views,
                "correct": bool(answer.argmax() == label),
                "covered": bool(sure.candidates[label]),
                "covered_at": [
                    stated
                    for stated in STATED_COVERAGES
                    if calibration.prediction_set(answer, tuned.trained, len(bag), stated / 100)[
                        label
                    ]
                ],
                "candidates": int(sure.candidates.sum()),
                "strangeness": sure.strangeness,
                "evidence": sure.evidence,
                "unknown": sure.unknown,
            }


def _area(rows: pa.Table) -> float:
    """Give the area under the curve of a class left out against the known objects beside it."""
    from sklearn.metrics import roc_auc_score

    return float(roc_auc_score(pc.invert(rows["known"]).to_numpy(), rows["evidence"].to_numpy()))
