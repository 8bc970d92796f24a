"""Any classifier on the experiment's own protocol: the report's figure for it, with its interval."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa
from joblib import Parallel, delayed
from tqdm import tqdm

from visuohaptic.base.errors import RecognitionError
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
from visuohaptic.tables.schema import build_table, read_table

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
    features : pyarrow.Table, pandas.DataFrame or path
        Rows of `tables.FEATURES`: a run's ``results/features``, `Exploration.features` of several
        objects, or an exported data set's ``features``.
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
    parameters = parameters or RecognitionParameters()
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
    predicted = [prediction for part in progress for prediction in part]
    scores, predictions = prediction_tables(sequences, predicted, _PIPELINE, strategy)
    summary = summarise(scores, predictions, parameters.intervals, seed)
    ((found,),) = (one.values() for one in summary["results"][_PIPELINE].values())
    accuracy = found["accuracy"]
    return Evaluation(
        accuracy["mean"], accuracy["low"], accuracy["high"],
        {key: mean for key, (mean, _) in found["by_object"].items()}, found["splits"], predictions,
    )  # fmt: skip


@one_thread()
def _predict_split(*arguments: Any) -> list[SplitPrediction]:
    return predict_split(*arguments)


def _as_table(features: Any) -> pa.Table:
    if isinstance(features, pa.Table):
        return features
    if isinstance(features, str | Path):
        return read_table(FEATURES, features)
    missing = [column.name for column in FEATURES.columns if column.name not in features]
    if missing:
        raise RecognitionError(
            f"The features have no column {missing[0]}; the columns of table `features` are needed."
        )
    return build_table(FEATURES, {name: features[name].to_numpy() for name in features.columns})
