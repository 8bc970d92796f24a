"""Any classifier on the experiment's own protocol: the report's figure for it, with its interval."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa
from joblib import Parallel, delayed
from tqdm import tqdm

from visuohaptic.base.errors import ParameterError, RecognitionError, TableError, VisuohapticError
from visuohaptic.evaluation.summary import summarise
from visuohaptic.recognition.classifiers import CLASSIFIERS, Classifier
from visuohaptic.recognition.experiment import (
    SplitPrediction,
    one_thread,
    predict_split,
    prediction_tables,
)
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.pipelines import PaperPipeline
from visuohaptic.recognition.sequences import gather_pipeline, take_strategy
from visuohaptic.recognition.splits import draw_splits
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table, take_table

_PIPELINE = "paper"


@dataclass(frozen=True, eq=False)
class Evaluation:
    """How often test sequences are correctly classified; it is equal to itself alone.

    Attributes
    ----------
    accuracy : float
        Mean over splits of the share of test sequences that are correctly classified.
    low, high : float or None
        Its interval over objects, as the report's; None where there is no such end.
    by_object : mapping of str to float
        The same of each object, `class/name`.
    splits : int
        How often the objects were divided into training and test objects.
    predictions : pyarrow.Table
        `tables.PREDICTIONS`: a row for each tested sequence of each split.
    """

    accuracy: float
    low: float | None
    high: float | None
    by_object: Mapping[str, float]
    splits: int
    predictions: pa.Table

    def __repr__(self) -> str:
        ends = ("none" if end is None else f"{100 * end:.1f}" for end in (self.low, self.high))
        return (
            f"<Evaluation: {100 * self.accuracy:.1f} % correctly classified ({' to '.join(ends)}), "
            f"{len(self.by_object)} objects, {self.splits} splits>"
        )


def evaluate(
    estimator: Any,
    features: Any,
    parameters: RecognitionParameters | None = None,
    strategy: str = "fixation",
    seed: int = 2018,
    n_jobs: int = 1,
) -> Evaluation:
    """Train and test a classifier on every split of the experiment, as the report does.

    Parameters
    ----------
    estimator : object or str
        An unfitted scikit-learn classifier, of which each split fits a copy, or the name of a
        registered one, such as ``support_vector_machine``. It sees the paper's features of a sequence of
        touches, scaled as `parameters` say; all that is fitted sees training objects alone.
    features : pyarrow.Table, data frame, mapping of arrays or path
        Rows of `tables.FEATURES`: a run's ``results/features``, `Exploration.features` of several
        objects, or an exported data set's ``features``. Other columns are left out.
    parameters : RecognitionParameters, optional
        The protocol, the sequences, and their encoding; without it those of the default run.
    strategy : str
        How the touches were chosen.
    seed : int
        The experiment's seed, which draws the splits; by default that of the default run.
    n_jobs : int
        Processes that share the splits, -1 for one per processor. The result does not depend on the number.

    Returns
    -------
    Evaluation
        The accuracy and its interval.

    Raises
    ------
    RecognitionError
        If the features do not allow the experiment, or the classifier can't be fitted.
    """
    if parameters is None:
        parameters = RecognitionParameters()
    if not isinstance(parameters, RecognitionParameters):
        raise ParameterError(
            f"parameters is of type {type(parameters).__name__}; RecognitionParameters are needed."
        )
    if not isinstance(estimator, str):
        check_classifier(estimator)
    table, _ = take_strategy(_as_table(features), strategy, parameters.touches)
    if isinstance(estimator, str):
        classifier = CLASSIFIERS[estimator]
    else:
        classifier = Classifier.of("estimator", estimator)
    sequences = gather_pipeline(table, parameters, _PIPELINE, seed)
    pipeline = PaperPipeline.of(parameters, {classifier.name: classifier})
    rows, splits = pipeline.rows(sequences), draw_splits(sequences, parameters.protocol, seed)
    parts = Parallel(n_jobs, return_as="generator")(
        delayed(_predict_split)(sequences, rows, pipeline, split, seed) for split in splits
    )
    progress = tqdm(parts, "evaluating", len(splits), leave=False, disable=None, unit="split")
    try:
        predicted = [prediction for part in progress for prediction in part]
    # An estimator may fail in any way.
    except Exception as error:
        if isinstance(error, VisuohapticError) and error.__cause__ is None:
            raise
        cause = error.__cause__ or error
        reason = " ".join(str(cause).split()) or type(cause).__name__
        raise RecognitionError(
            f"{_short(estimator)} can't be fitted or tested on the sequences: {reason.rstrip('.')}."
        ) from error
    scores, predictions = prediction_tables(sequences, predicted, _PIPELINE, strategy)
    summary = summarise(scores, predictions, parameters.intervals)
    ((found,),) = (one.values() for one in summary["results"][_PIPELINE].values())
    accuracy = found["accuracy"]
    return Evaluation(
        accuracy["mean"], accuracy["low"], accuracy["high"],
        {key: mean for key, (mean, _) in found["by_object"].items()}, found["splits"], predictions,
    )  # fmt: skip


@one_thread()
def _predict_split(*arguments: Any) -> list[SplitPrediction]:
    return predict_split(*arguments)


def check_classifier(estimator: Any) -> None:
    """Raise `RecognitionError`, which says what it is instead, unless an object is a scikit-learn classifier."""
    from sklearn.utils import get_tags

    if isinstance(estimator, type):
        raise RecognitionError(
            f"{estimator.__name__} is a class; an object of it is needed, such as {estimator.__name__}()."
        )
    missing = [name for name in ("get_params", "fit") if not hasattr(estimator, name)]
    kind = "of another kind"
    if not missing and hasattr(estimator, "__sklearn_tags__"):
        tagged = get_tags(estimator).estimator_type
        if tagged == "classifier":
            return
        kind = f"of the kind {tagged.replace('_', ' ')}" if tagged else "no estimator of classes"
    elif not missing and hasattr(estimator, "predict"):
        return
    raise RecognitionError(
        f"{_short(estimator)} is {kind if not missing else f'without {missing[0]}'}; a scikit-learn classifier is needed."
    )


def _short(estimator: Any) -> str:
    text = " ".join(repr(estimator).split())
    return text if len(text) <= 100 else f"{text[:100]}…"


def _as_table(features: Any) -> pa.Table:
    try:
        if isinstance(features, str | Path):
            return read_table(FEATURES, features)
        return take_table(FEATURES, features)
    except TableError as error:
        raise RecognitionError(f"The features can't be used: {error}") from error
