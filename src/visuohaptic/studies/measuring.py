"""Measure conditions of any study: read their features, train and test classifiers, and write accuracies."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache, partial
from itertools import groupby, product
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
from numpy.typing import NDArray

from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.base.errors import RecognitionError
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.experiment import SplitPrediction, predict_splits
from visuohaptic.recognition.pipelines import pipeline_of, pooled_log_probabilities
from visuohaptic.recognition.sequences import TouchSequences, gather_pipeline, take_strategy
from visuohaptic.recognition.splits import draw_splits
from visuohaptic.recognition.voting import evenly_spaced_subsets, vote_credit
from visuohaptic.studies.conditions import Planned, touches_needed, training_key
from visuohaptic.studies.refusals import ERROR, REFUSALS, REFUSED_POLICIES
from visuohaptic.studies.study import Condition
from visuohaptic.tables.phases import FEATURES, of_objects
from visuohaptic.tables.schema import build_table, read_table, write_table
from visuohaptic.tables.studies import STUDY

Paths = Sequence[str | Path]


@dataclass(frozen=True)
class Predictions:
    """Predictions of one pipeline.

    Attributes
    ----------
    sequences : TouchSequences
        All sequences, of training and test objects.
    splits : sequence of SplitPrediction
        One prediction per split and classifier.
    seconds : float
        Processor seconds for training and testing, summed over all splits and classifiers.
    """

    sequences: TouchSequences
    splits: Sequence[SplitPrediction]
    seconds: float


def make_study_block(
    study: str,
    conditions: Sequence[Mapping[str, Any]],
    features: Paths,
    recomputed_features: Mapping[str, str | Path],
    output: str | Path,
    seed: int,
    objects: Collection[str] | None = None,
) -> None:
    """Measure a block of conditions and write `tables.STUDY`.

    Parameters
    ----------
    study : str
        The study's name.
    conditions : sequence of mappings
        The conditions as `conditions.describe_conditions` returns them, in the order of `conditions.make_blocks`.
    features, recomputed_features, objects
        Files of features, and objects to measure, as for `features_by_key`.
    output : path
        The file to write.
    seed : int
        The seed of the run.
    """
    planned = [
        Planned(
            Condition(row["name"], votes=row["votes"]),
            ExperimentParameters.from_mapping(row["parameters"], f"study {study}: {row['name']}"),
            row["key"],
        )
        for row in conditions
    ]
    of_key = features_by_key(features, recomputed_features, objects)
    parts: list[pa.Table] = []
    for (key, _), same_training in groupby(planned, key=training_key):
        parts += measure_conditions(study, list(same_training), of_key(key or None), seed)
    write_table(STUDY, pa.concat_tables(parts), output)


def features_by_key(
    features: Paths, recomputed_features: Mapping[str, str | Path], objects: Collection[str] | None
) -> Callable[[str | None], pa.Table | str]:
    """Return a function that reads features by the key of a condition.

    Parameters
    ----------
    features : sequence of paths
        The run's files of `tables.FEATURES`, for key None.
    recomputed_features : mapping of str to path
        Files of recomputed features by key.
    objects : collection of str, optional
        Objects, ``class/name``, to select from the run's features; None for all. Files of recomputed
        features are read whole.

    Returns
    -------
    callable
        Takes a key. Returns `tables.FEATURES`, or an error message if the features could not be computed. Only the
        last table is cached, so call the function in the order of the keys.
    """

    @lru_cache(maxsize=1)
    def read(key: str | None) -> pa.Table | str:
        if key is None:
            return of_objects(read_table(FEATURES, features), objects)
        metadata = pq.read_schema(recomputed_features[key]).metadata or {}
        if ERROR in metadata:
            return metadata[ERROR].decode("utf-8")
        table = read_table(FEATURES, recomputed_features[key])
        if REFUSED_POLICIES not in metadata:
            return table
        return table.replace_schema_metadata({REFUSED_POLICIES: metadata[REFUSED_POLICIES]})

    return read


def condition_features(planned: Planned, features: pa.Table | str, strategy: str) -> pa.Table:
    """Select the rows of a condition and strategy from features that several conditions share.

    Drops viewpoints with fewer touches than `recognition.touches`, or than the longest sequence if that is None. Then
    drops classes with a single object. Keeps the first `touches_needed` touches per sequence, which can be more than
    `recognition.touches`.

    Parameters
    ----------
    planned : Planned
        The condition.
    features : pyarrow.Table or str
        `tables.FEATURES` of the condition's key, or the error message of `features_by_key`.
    strategy : str
        A probing strategy.

    Returns
    -------
    pyarrow.Table
        Rows of `tables.FEATURES`.

    Raises
    ------
    RecognitionError
        If the strategy has no touches or is a refused policy, no viewpoint has enough touches, or `features` is an
        error message.
    """
    if isinstance(features, str):
        raise RecognitionError(features)
    refused = json.loads((features.schema.metadata or {}).get(REFUSED_POLICIES, "{}"))
    if strategy in refused:
        raise RecognitionError(refused[strategy])
    parameters = planned.parameters
    is_needed = pc.less(features.column("touch"), touches_needed(parameters))
    return take_strategy(features.filter(is_needed), strategy, parameters.recognition.touches)[0]


def measure_conditions(
    study: str, conditions: Sequence[Planned], features: pa.Table | str, seed: int
) -> Iterator[pa.Table]:
    """Train each pipeline and strategy once, and compute the accuracies of conditions with equal training keys.

    Parameters
    ----------
    study : str
        The study's name.
    conditions : sequence of Planned
        Conditions that differ only in name and votes. Their `conditions.training_key` must be equal, because only the
        parameters of the first condition are read.
    features : pyarrow.Table or str
        `tables.FEATURES` of the conditions' key, or an error message, which refuses all conditions.
    seed : int
        The seed of the run.

    Yields
    ------
    pyarrow.Table
        `tables.STUDY` for a pipeline, strategy, condition and classifier. If an error of `REFUSALS` refuses the
        condition, one table instead has one row per classifier, with the error message.
    """
    first = conditions[0]
    recognition = first.parameters.recognition
    for pipeline, strategy in product(recognition.pipelines, first.parameters.probing.strategies):
        predict = cache(partial(predict_condition, first, features, strategy, pipeline, seed))
        for planned in conditions:
            key = (study, planned.condition.name, pipeline, strategy)
            try:
                yield from cell_rows(key, predict(), planned.condition.votes)
            except REFUSALS as refusal:
                yield error_rows(key, recognition.classifiers_of(pipeline), str(refusal))


def predict_condition(
    planned: Planned, features: pa.Table | str, strategy: str, pipeline: str, seed: int
) -> Predictions:
    """Train and test the classifiers of a pipeline in every split, on a condition's touches by one strategy.

    `features` is as for `condition_features`. Raises an error of `REFUSALS` if the features do not suffice.
    """
    recognition = planned.parameters.recognition
    rows = condition_features(planned, features, strategy)
    sequences = gather_pipeline(rows, recognition, pipeline, seed)
    splits = draw_splits(sequences, recognition.protocol, seed)
    started = time.process_time()
    parts = pipeline_of(pipeline, recognition, seed)
    predictions = list(predict_splits(sequences, parts, splits, seed))
    return Predictions(sequences, predictions, time.process_time() - started)


Key = tuple[str, str, str, str]
"""Study, condition, pipeline and strategy."""

_KEY = ("study", "condition", "pipeline", "strategy")


def cell_rows(key: Key, predictions: Predictions, votes: int | None = None) -> Iterator[pa.Table]:
    """Yield `tables.STUDY` of each classifier, with one row per test object, split and repeat.

    Parameters
    ----------
    key : tuple of str
        Study, condition, pipeline and strategy.
    predictions : Predictions
        The predictions of all splits and classifiers.
    votes : int, optional
        The number of viewpoints that vote on an object. The default is no vote: the accuracy is the share of an
        object's test sequences that is correctly classified, and column ``sequences`` is their number. With votes, the
        accuracy is the mean of `group_credit` over all choices of `evenly_spaced_subsets`, and ``sequences`` is 1.
        Choices without a test sequence of the object do not count.

    Raises
    ------
    RecognitionError
        If the sequences have fewer viewpoints than `votes`, or if `votes` exceeds 1 and the protocol tests objects
        from only some of their viewpoints.
    """
    sequences = predictions.sequences
    by_classifier: dict[str, list[tuple[NDArray[Any], ...]]] = {}
    for prediction in predictions.splits:
        owners, right, counts = (
            _count_correct(sequences, prediction)
            if votes is None
            else _vote(sequences, prediction, votes)
        )
        split = prediction.split
        numbers = (np.full(len(owners), number) for number in (split.number, split.repeat))
        part = (owners, *numbers, counts, right)
        by_classifier.setdefault(prediction.classifier, []).append(part)
    objects = np.array(sequences.objects, dtype=object)
    for classifier, parts in by_classifier.items():
        owners, splits, repeats, counts, right = map(np.concatenate, zip(*parts, strict=True))
        yield build_table(
            STUDY,
            {
                **dict(zip(_KEY, key, strict=True)),
                "classifier": classifier,
                "class": objects[owners, 0],
                "object": objects[owners, 1],
                "split": splits,
                "repeat": repeats,
                "sequences": counts,
                "accuracy": right / counts,
                "seconds": predictions.seconds,
                "error": [None] * len(owners),
            },
        )


def error_rows(key: Key, classifiers: Sequence[str], error: str) -> pa.Table:
    """Return `tables.STUDY` of a refused condition: one row per classifier with the error message."""
    empty = ("class", "object", "split", "repeat", "sequences", "accuracy", "seconds")
    return build_table(
        STUDY,
        {
            **dict(zip(_KEY, key, strict=True)),
            "classifier": list(classifiers),
            **{name: [None] * len(classifiers) for name in empty},
            "error": error,
        },
    )


def _count_correct(
    sequences: TouchSequences, prediction: SplitPrediction
) -> tuple[IntArray, FloatArray, IntArray]:
    """Return the indices of the test objects, and per object the number of correct and of all test sequences."""
    test = prediction.split.test
    owners, row = np.unique(sequences.object_index[test], return_inverse=True)
    correct = prediction.predicted == sequences.labels[test]
    right = np.bincount(row, weights=correct).astype(np.float64)
    return owners, right, np.bincount(row).astype(np.int64)


def _vote(
    sequences: TouchSequences, prediction: SplitPrediction, votes: int
) -> tuple[IntArray, FloatArray, IntArray]:
    """Return the indices of the test objects, and per object the mean credit of its votes and the weight 1."""
    test, viewpoints = prediction.split.test, np.unique(sequences.viewpoint)
    if votes > len(viewpoints):
        raise RecognitionError(
            f"{votes} viewpoints can't vote; at most {len(viewpoints)}, the run's viewpoints, are allowed."
        )
    owners, row = np.unique(sequences.object_index[test], return_inverse=True)
    if votes > 1 and np.isin(sequences.object_index, owners).sum() > len(test):
        raise RecognitionError(
            "The protocol tests objects from only some of their viewpoints; votes of several viewpoints need a "
            "protocol that tests whole objects."
        )
    choices = viewpoints[evenly_spaced_subsets(len(viewpoints), votes)]
    chosen = (sequences.viewpoint[test] == choices[..., None]).any(axis=1)
    members = (row == np.arange(len(owners))[:, None])[:, None] & chosen
    # An object may have no whole sequence from the viewpoints of a choice.
    voting = members.any(axis=2)
    true_class = np.broadcast_to(sequences.class_of_object[owners][:, None], voting.shape)
    credit = np.zeros(voting.shape)
    credit[voting] = group_credit(prediction, members[voting], true_class[voting])
    return owners, credit.sum(axis=1) / voting.sum(axis=1), np.ones(len(owners), dtype=np.int64)


def group_credit(
    prediction: SplitPrediction, members: BoolArray, true_class: IntArray
) -> FloatArray:
    """Classify m groups of test sequences, and return the credit of each group.

    A prediction with log probabilities classifies a group by the largest mean log probability, without ties.
    Otherwise the sequences of the group vote by majority.

    Parameters
    ----------
    prediction : SplitPrediction
        Predictions for the n test sequences of a split.
    members : ndarray of shape (m, n), bool
        ``members[i, j]`` is True if test sequence j is in group i. Each group needs a sequence.
    true_class : ndarray of shape (m,), int64
        Class index of each group's object.

    Returns
    -------
    ndarray of shape (m,), float64
        1 for the true class, 0 for another class. In a majority vote, 1/k if k classes, one of them the true class,
        share the most votes.
    """
    if prediction.log_probabilities is None:
        group, sequence = np.nonzero(members)
        return vote_credit(group, prediction.predicted[sequence], true_class)[1]
    pooled = pooled_log_probabilities(prediction.log_probabilities, members)
    return (pooled.argmax(axis=1) == true_class).astype(np.float64)
