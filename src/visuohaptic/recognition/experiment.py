"""Train and test every split of a pipeline on the features of one strategy."""

from __future__ import annotations

import logging
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray
from sklearn import config_context
from sklearn.base import clone
from threadpoolctl import threadpool_limits

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import RecognitionError
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.pipelines import (
    RecognitionPipeline,
    fit_preparation,
    pipeline_of,
    pooled_log_probabilities,
)
from visuohaptic.recognition.sequences import TouchSequences, gather_pipeline
from visuohaptic.recognition.splits import Split, draw_splits
from visuohaptic.recognition.voting import vote_credit
from visuohaptic.tables.phases import PREDICTIONS, SCORES
from visuohaptic.tables.schema import build_rows, build_table

logger = logging.getLogger(__name__)

UNFIT = (RecognitionError, ValueError, np.linalg.LinAlgError)
"""Errors of classifiers that can't be fitted on some training sequences."""


@dataclass(frozen=True)
class SplitPrediction:
    """Predictions of one classifier in one split.

    Attributes
    ----------
    predicted : ndarray of shape (n,)
        Index of the predicted class per test sequence.
    log_probabilities : ndarray of shape (n, c), optional
        Log probability of each class per test sequence; None for pipelines without probabilities.
    note : str, optional
        A remark on the fit, such as a regularised covariance.
    """

    split: Split
    classifier: str
    predicted: IntArray
    log_probabilities: FloatArray | None = None
    note: str | None = None


def run_pipeline(
    features: pa.Table, parameters: RecognitionParameters, seed: int, pipeline: str = "paper"
) -> tuple[pa.Table, pa.Table]:
    """Train and test every split, classifier and repeat on the features of one strategy.

    Returns rows of `tables.SCORES` and of `tables.PREDICTIONS`. Splits depend on the seed, not on the strategy, so that
    strategies can be compared in pairs. Viewpoints with too few touches are left out, and so are classifiers that can't
    be fitted in a split; the log says which. Raises `RecognitionError` if the features don't allow the experiment.
    """
    sequences = gather_pipeline(features, parameters, pipeline, seed)
    strategy = features.column("strategy")[0].as_py()
    predictions = predict_splits(
        sequences,
        pipeline_of(pipeline, parameters, seed),
        draw_splits(sequences, parameters.protocol, seed),
        seed,
    )
    return prediction_tables(sequences, predictions, pipeline, strategy)


def predict_splits(
    sequences: TouchSequences,
    pipeline: RecognitionPipeline,
    splits: Iterable[Split],
    seed: int,
) -> Iterator[SplitPrediction]:
    """Fit a pipeline on the training sequences of every split and classify the test sequences.

    Yields one prediction per split and classifier.
    """
    rows = pipeline.rows(sequences)
    with one_thread():
        for split in splits:
            yield from predict_split(sequences, rows, pipeline, split, seed)


def predict_split(
    sequences: TouchSequences,
    rows: FloatArray,
    pipeline: RecognitionPipeline,
    split: Split,
    seed: int,
) -> list[SplitPrediction]:
    """Fit every classifier of a pipeline on one split; `rows` are the pipeline's, one per sequence.

    Classifiers that can't be fitted are left out, and the log says why. Raises the last error if none can be fitted.
    """
    labels, classes = sequences.labels[split.train], len(sequences.classes)
    predictions: list[SplitPrediction] = []
    failure: Exception | None = None
    generator = spawn_generator(seed, "recognition", pipeline.name, split.repeat, split.number)
    preparation = seeded(clone(pipeline.preparation), generator)
    train = fit_preparation(preparation, rows[split.train])
    test = preparation.transform(rows[split.test])
    for name, own_seed in pipeline.seeds(generator).items():
        try:
            model = seeded(clone(pipeline.classifiers[name]), own_seed).fit(train, labels)
            predicted = model.predict(test)
            logs = pipeline.log_probabilities(model, test, classes)
        except UNFIT as error:
            section = "" if pipeline.name == "paper" else f"{pipeline.name}."
            logger.warning(
                "%s is left out: %s; add objects or viewpoints, or take it out of recognition.%sclassifiers.",
                name, str(error).rstrip("."), section,
            )  # fmt: skip
            failure = error
            continue
        note = getattr(model, "note_", None)
        predictions.append(SplitPrediction(split, name, predicted, logs, note))
    if failure is not None and not predictions:
        if isinstance(failure, RecognitionError):
            raise failure
        raise RecognitionError(f"No classifier can be fitted: {failure}") from failure
    return predictions


@contextmanager
def one_thread() -> Iterator[None]:
    """Run the block on one thread, so that sums have one order, and without scikit-learn's checks of input."""
    checks = config_context(assume_finite=True, skip_parameter_validation=True)
    with threadpool_limits(limits=1), checks:
        yield


def prediction_tables(
    sequences: TouchSequences,
    predictions: Iterable[SplitPrediction],
    pipeline: str,
    strategy: str,
) -> tuple[pa.Table, pa.Table]:
    """Return rows of `tables.SCORES` and `tables.PREDICTIONS` for the predictions of all splits.

    Classifiers that lack a split are left out. Raises `RecognitionError` if none is left.
    """
    twins = _twins_note(sequences)
    results: list[tuple[dict[str, object], dict[str, NDArray[np.generic]]]] = []
    for prediction in predictions:
        split = prediction.split
        key: dict[str, object] = {
            "pipeline": pipeline,
            "strategy": strategy,
            "classifier": prediction.classifier,
            "split": split.number,
            "seed": split.repeat,
        }
        voted, credit = _vote(sequences, prediction)
        figures = {
            "accuracy": float((prediction.predicted == sequences.labels[split.test]).mean()),
            "object_accuracy": float(credit.mean()),
            "sequences": len(split.test),
            "note": "; ".join(filter(None, (prediction.note, twins))) or None,
        }
        repeated = {name: np.full(len(split.test), value) for name, value in key.items()}
        columns = repeated | _prediction_columns(sequences, prediction, voted)
        results.append((key | figures, columns))
    # Drop classifiers that failed in a split. Their mean would cover other splits than that of the rest.
    splits = len({(score["split"], score["seed"]) for score, _ in results})
    predicted = Counter(score["classifier"] for score, _ in results)
    kept = [result for result in results if predicted[result[0]["classifier"]] == splits]
    if not kept:
        raise RecognitionError("No classifier can be fitted in every split; see the log.")
    scores, blocks = zip(*kept, strict=True)
    columns = {name: np.concatenate([block[name] for block in blocks]) for name in blocks[0]}
    return build_rows(SCORES, list(scores)), build_table(PREDICTIONS, columns)


def seeded(estimator: Any, random_state: Any) -> Any:
    """Set the `random_state` of an estimator that has this parameter, and return the estimator."""
    if "random_state" in estimator.get_params(deep=False):
        estimator.set_params(random_state=random_state)
    return estimator


def _vote(sequences: TouchSequences, prediction: SplitPrediction) -> tuple[IntArray, FloatArray]:
    """Return the voted class of each test sequence's object (-1 without probabilities), and the credit of each object."""
    owners = sequences.object_index[prediction.split.test]
    true_class = sequences.class_of_object
    if prediction.log_probabilities is None:
        _, credit = vote_credit(owners, prediction.predicted, true_class)
        return np.full(len(owners), -1), credit
    present, row = np.unique(owners, return_inverse=True)
    pooled = pooled_log_probabilities(prediction.log_probabilities, owners == present[:, None])
    voted = pooled.argmax(axis=1)
    return voted[row], (voted == true_class[present]).astype(np.float64)


def _prediction_columns(
    sequences: TouchSequences, prediction: SplitPrediction, voted: IntArray
) -> dict[str, NDArray[np.generic]]:
    """Return the columns of predictions that differ between test sequences."""
    test = prediction.split.test
    names = np.array(sequences.objects, dtype=object)[sequences.object_index[test]]
    classes = np.array([*sequences.classes, None], dtype=object)
    probability = np.full(len(test), None, dtype=object)
    if prediction.log_probabilities is not None:
        probability = np.exp(prediction.log_probabilities.max(axis=1)).astype(object)
    return {
        "class": names[:, 0],
        "object": names[:, 1],
        "viewpoint": sequences.viewpoint[test],
        "predicted": classes[prediction.predicted],
        "probability": probability,
        "voted": classes[voted],
    }


def _twins_note(sequences: TouchSequences) -> str | None:
    """Return a note that names pairs of objects with identical touches; None if there is no pair."""
    name_of_content: dict[bytes, str] = {}
    pairs = []
    for index, owner in enumerate(sequences.objects):
        name, content = "/".join(owner), sequences.features[sequences.object_index == index]
        first_name = name_of_content.setdefault(content.tobytes(), name)
        if first_name != name:
            pairs.append(f"{first_name} and {name}")
    if not pairs:
        return None
    return f"touches are identical for {', '.join(pairs)}, so a test may meet what training saw"
