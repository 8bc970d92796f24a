"""Prediction sets and the answer `unknown`, measured with whole classes left out."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray

from visuohaptic.errors import RecognitionError
from visuohaptic.recognition.certainty import fit_calibration, one_classifier
from visuohaptic.recognition.descriptors import describe_all
from visuohaptic.recognition.experiment import fitting, gather_pipeline
from visuohaptic.recognition.intervals import plain_interval, rate_interval
from visuohaptic.recognition.pooling import spread_choices
from visuohaptic.recognition.sequences import take_strategy
from visuohaptic.recognition.splits import grouped_folds, objects_of_classes
from visuohaptic.recognition.summary import select
from visuohaptic.recognition.tuning import fit_best_classifiers
from visuohaptic.seeds import spawn_generator
from visuohaptic.studies.conditions import CLASSIFIER
from visuohaptic.studies.figures import rows_by, write_json
from visuohaptic.studies.study import Given, Step, Study
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import build_rows, read_table, write_table
from visuohaptic.tables.studies import CERTAINTY, STATED_COVERAGES

if TYPE_CHECKING:
    from visuohaptic.recognition.parameters import IntervalParameters, RecognitionParameters
    from visuohaptic.recognition.sequences import TouchSequences

VIEWS = (1, 4, 16)
"""Numbers of views from which objects are classified, as far as they have them."""

CERTAINTY_STUDY = Study(
    "certainty",
    "How sure answers are",
    steps=(
        Step(
            "certainty",
            "visuohaptic.studies.certainty:make_certainty",
            ("results/certainty.parquet", "reports/certainty.json"),
            takes=("features",),
            needs={
                "include": {"seed": True, "probing": {"strategies"}, "recognition": True},
                "exclude": {"recognition": {"pipelines"}},
            },
        ),
    ),
    has_figures=False,
)
"""Prediction sets at their stated coverage, and objects of classes that a model does not know."""


def measure_certainty(
    features: pa.Table,
    strategy: str,
    classifier: str,
    parameters: RecognitionParameters,
    seed: int,
) -> pa.Table:
    """Classify known and unknown objects by models that lack one whole class each: `tables.CERTAINTY`.

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
    return build_rows(CERTAINTY, [{**key, **row} for row in rows])


def summarise_certainty(
    table: pa.Table, coverage: float, intervals: IntervalParameters, seed: int
) -> list[dict[str, Any]]:
    """Sum up `tables.CERTAINTY` by strategy and number of views: what `sum_up_answers` gives, and ``area``.

    That is under the curve that tells unknown objects from known ones, a mean over the classes left out.
    """
    found = []
    for figures, rows in sum_up_answers(table, coverage, intervals, seed):
        areas = [
            _area(select(rows, left_out=name)) for name in rows["left_out"].unique().to_pylist()
        ]
        found.append(figures | {"area": float(np.mean(areas))})
    return found


def sum_up_answers(
    table: pa.Table, coverage: float, intervals: IntervalParameters, seed: int
) -> Iterator[tuple[dict[str, Any], pa.Table]]:
    """Give by strategy and number of views shares with intervals over objects, the sets' mean size, and the rows.

    Any table will do that says of each answer whether the object's class is `known`, and whether the
    answer is `correct`, `covered` and `unknown`. What there are no objects for is left out.
    """
    for strategy in table.column("strategy").unique().to_pylist():
        for views in table.column("views").unique().to_pylist():
            rows = select(table, strategy=strategy, views=views)
            known = select(rows, known=True)
            figures: dict[str, Any] = {"strategy": strategy, "views": views, "stated": coverage}
            for name, of, column in (
                ("accuracy", known, "correct"),
                ("coverage", known, "covered"),
                ("false_unknown", known, "unknown"),
                ("found_unknown", select(rows, known=False), "unknown"),
            ):
                if len(of):
                    means, counts = _by_object(of, column)
                    generator = spawn_generator(seed, "certainty", strategy, views, name)
                    interval = rate_interval(means, counts, intervals, generator)
                    figures[name] = list(plain_interval(interval).values())
            figures["set_size"] = float(np.mean(known["candidates"].to_numpy()))
            yield figures, rows


def make_certainty(given: Given) -> None:
    """Make `tables.CERTAINTY` of every strategy, and its summary as JSON."""
    run, (table, metrics) = given.run, given.outputs
    rows = read_table(FEATURES, given.inputs["features"])
    measured = pa.concat_tables(
        measure_certainty(rows, strategy, CLASSIFIER, run.recognition, run.seed)
        for strategy in run.probing.strategies
    )
    write_table(CERTAINTY, measured, table)
    recognition = run.recognition
    found = summarise_certainty(
        measured, recognition.best.coverage, recognition.intervals, run.seed
    )
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


def _by_object(rows: pa.Table, column: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Give each object's mean of a column, and how often it was tested."""
    parts = rows_by(rows, ("class", "object")).values()
    means = np.array([np.mean(part[column].to_numpy()) for part in parts])
    return means, np.array([len(part) for part in parts], dtype=np.float64)


def _area(rows: pa.Table) -> float:
    """Give the area under the curve of a class left out against the known objects beside it."""
    from sklearn.metrics import roc_auc_score

    return float(roc_auc_score(pc.invert(rows["known"]).to_numpy(), rows["evidence"].to_numpy()))
