"""Measure conditions: read their features, train and test classifiers, and write accuracies. Used by all studies."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache, partial
from itertools import groupby, product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
from numpy.typing import NDArray

from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.base.errors import RecognitionError
from visuohaptic.recognition.experiment import SplitPrediction, predict_splits
from visuohaptic.recognition.pipelines import pipeline_of, pooled_log_probabilities
from visuohaptic.recognition.sequences import TouchSequences, gather_pipeline, take_strategy
from visuohaptic.recognition.splits import draw_splits
from visuohaptic.recognition.voting import evenly_spaced_subsets, vote_credit
from visuohaptic.studies.conditions import (
    Planned,
    touches_needed,
    training_key,
    with_changes,
)
from visuohaptic.studies.refusals import ERROR, REFUSALS
from visuohaptic.studies.study import Condition
from visuohaptic.tables.phases import FEATURES, of_objects
from visuohaptic.tables.schema import build_table, read_table, write_table
from visuohaptic.tables.studies import STUDY

if TYPE_CHECKING:
    from visuohaptic.parameters import ExperimentParameters

Paths = Sequence[str | Path]


@dataclass(frozen=True)
class Predictions:
    """Predictions of all splits and classifiers for some sequences, and their processor seconds in sum."""

    sequences: TouchSequences
    splits: Sequence[SplitPrediction]
    seconds: float


def make_study_block(
    study: str,
    conditions: Sequence[Mapping[str, Any]],
    features: Paths,
    made: Mapping[str, str | Path],
    output: str | Path,
    run: ExperimentParameters,
    objects: Collection[str] | None = None,
) -> None:
    """Measure a block of conditions and write `tables.STUDY`.

    Parameters
    ----------
    study : str
        The study's name.
    conditions : sequence of mappings
        The conditions as `conditions.describe_conditions` returns them.
    features, made, objects
        Files of features, as for `features_by_key`.
    output : path
        The file to write.
    run : ExperimentParameters
        The parameters of the run.
    """
    planned = [
        Planned(
            Condition(row["name"], row["changes"], votes=row["votes"]),
            with_changes(run, row["changes"]),
            row["key"],
        )
        for row in conditions
    ]
    of_key = features_by_key(features, made, objects)
    parts: list[pa.Table] = []
    for (key, _), same_training in groupby(planned, key=training_key):
        parts += measure_conditions(study, list(same_training), of_key(key or None), run.seed)
    write_table(STUDY, pa.concat_tables(parts), output)


def features_by_key(
    features: Paths, made: Mapping[str, str | Path], objects: Collection[str] | None
) -> Callable[[str | None], pa.Table | str]:
    """Return a function that reads features by the key of a condition.

    Parameters
    ----------
    features : sequence of paths
        The run's files of `tables.FEATURES`, for key None.
    made : mapping of str to path
        Files of recomputed features by key.
    objects : collection of str, optional
        Objects, ``class/name``, to take from the run's features. The default is all objects.

    Returns
    -------
    callable
        Takes a key. Returns a table, or an error message if the features could not be computed. Only the last table
        is cached, because conditions with the same key are contiguous.
    """

    @lru_cache(maxsize=1)
    def read(key: str | None) -> pa.Table | str:
        if key is None:
            return of_objects(read_table(FEATURES, features), objects)
        error = (pq.read_schema(made[key]).metadata or {}).get(ERROR)
        return read_table(FEATURES, made[key]) if error is None else error.decode("utf-8")

    return read


def condition_features(planned: Planned, features: pa.Table | str, strategy: str) -> pa.Table:
    """Select the rows of a condition and strategy from features that several conditions share.

    Viewpoints without a whole sequence, and classes with a single object, are left out. Raises `RecognitionError` if
    no row is left, or if `features` is an error message.
    """
    if isinstance(features, str):
        raise RecognitionError(features)
    parameters = planned.parameters
    is_needed = pc.less(features.column("touch"), touches_needed(parameters))
    return take_strategy(features.filter(is_needed), strategy, parameters.recognition.touches)[0]


def measure_conditions(
    study: str, conditions: Sequence[Planned], features: pa.Table | str, seed: int
) -> Iterator[pa.Table]:
    """Train once, and test conditions that differ only in their votes.

    Yields `tables.STUDY` per pipeline, strategy and condition. A refused condition has one row per classifier with
    the reason. `features` may be an error message instead of a table.
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
                paper = pipeline == "paper"
                names = recognition.classifiers if paper else recognition.order_free.classifiers
                yield error_rows(key, names, str(refusal))


def predict_condition(
    planned: Planned, features: pa.Table | str, strategy: str, pipeline: str, seed: int
) -> Predictions:
    """Train and test a pipeline on every split of a condition's touches by one strategy."""
    recognition = planned.parameters.recognition
    rows = condition_features(planned, features, strategy)
    sequences = gather_pipeline(rows, recognition, pipeline, seed)
    splits = draw_splits(sequences, recognition.protocol, seed)
    started = time.process_time()
    parts = pipeline_of(pipeline, recognition, seed)
    predictions = list(predict_splits(sequences, parts, splits, seed))
    return Predictions(sequences, predictions, time.process_time() - started)


Key = tuple[str, str, str, str]
_KEY = ("study", "condition", "pipeline", "strategy")


def cell_rows(key: Key, predictions: Predictions, votes: int | None = None) -> Iterator[pa.Table]:
    """Yield `tables.STUDY` of each classifier: one row per object, split and repeat.

    Parameters
    ----------
    key : tuple of str
        Study, condition, pipeline and strategy.
    predictions : Predictions
        The predictions of all splits and classifiers.
    votes : int, optional
        The number of viewpoints that vote. Each evenly spaced choice of `votes` viewpoints is one recognition. The
        default is that each sequence is one recognition.

    Raises
    ------
    RecognitionError
        If the run has fewer viewpoints than `votes`.
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
    """Return the tested objects, and the number of correct sequences and of all sequences of each object."""
    test = prediction.split.test
    owners, row = np.unique(sequences.object_index[test], return_inverse=True)
    correct = prediction.predicted == sequences.labels[test]
    right = np.bincount(row, weights=correct).astype(np.float64)
    return owners, right, np.bincount(row).astype(np.int64)


def _vote(
    sequences: TouchSequences, prediction: SplitPrediction, votes: int
) -> tuple[IntArray, FloatArray, IntArray]:
    """Return the tested objects, each object's share of correct votes of `votes` viewpoints, and ones."""
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
    """Return the credit of m groups of n test sequences: by pooled log probabilities if given, else by majority vote.

    Parameters
    ----------
    prediction : SplitPrediction
        Predictions for the n test sequences of a split.
    members : ndarray of shape (m, n), bool
        True for the test sequences of each group.
    true_class : ndarray of shape (m,), int64
        Class index of each group's object.

    Returns
    -------
    ndarray of shape (m,), float64
        1 for a correct classification; 1/k if k classes, the true class included, have the most votes; else 0.
    """
    if prediction.log_probabilities is None:
        group, sequence = np.nonzero(members)
        return vote_credit(group, prediction.predicted[sequence], true_class)[1]
    pooled = pooled_log_probabilities(prediction.log_probabilities, members)
    return (pooled.argmax(axis=1) == true_class).astype(np.float64)
