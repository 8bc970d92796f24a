"""The one engine of all studies: features of a condition, and how well it classifies objects."""

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
    """Predictions of every split and classifier for some sequences, and the processor seconds of all."""

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
    """Measure a block of a study's conditions: `tables.STUDY`.

    `conditions` are as `describe_conditions` gives them; the others are as `features_by_key` has them.
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
    for (key, _), alike in groupby(planned, key=training_key):
        parts += measure_conditions(study, list(alike), of_key(key or None), run.seed)
    write_table(STUDY, pa.concat_tables(parts), output)


def features_by_key(
    features: Paths, made: Mapping[str, str | Path], objects: Collection[str] | None
) -> Callable[[str | None], pa.Table | str]:
    """Read features as conditions name them, or why they were refused: the run's (None), or made for some conditions.

    `objects`, ``class/name``, are those of the run's features that count; None for all. One table is held
    at a time, as conditions with the same features are neighbours.
    """

    @lru_cache(maxsize=1)
    def read(key: str | None) -> pa.Table | str:
        if key is None:
            return of_objects(read_table(FEATURES, features), objects)
        error = (pq.read_schema(made[key]).metadata or {}).get(ERROR)
        return read_table(FEATURES, made[key]) if error is None else error.decode("utf-8")

    return read


def condition_features(planned: Planned, features: pa.Table | str, strategy: str) -> pa.Table:
    """Take a condition's rows, of one strategy, of features that others share; `RecognitionError` if there is none.

    Viewpoints without a whole sequence by the strategy, and classes with a single object, are left out.
    Features may be the sentence by which they were refused.
    """
    if isinstance(features, str):
        raise RecognitionError(features)
    parameters = planned.parameters
    made = pc.less(features.column("touch"), touches_needed(parameters))
    return take_strategy(features.filter(made), strategy, parameters.recognition.touches)[0]


def measure_conditions(
    study: str, alike: Sequence[Planned], features: pa.Table | str, seed: int
) -> Iterator[pa.Table]:
    """Train once, and test conditions that differ only in their votes.

    A condition that can't be run has one row per classifier with the reason. `features` may be the sentence by which
    they were refused. Yields `tables.STUDY` of each pipeline, strategy and condition.
    """
    first = alike[0]
    recognition = first.parameters.recognition
    for pipeline, strategy in product(recognition.pipelines, first.parameters.probing.strategies):
        predict = cache(partial(predict_condition, first, features, strategy, pipeline, seed))
        for one in alike:
            key = (study, one.condition.name, pipeline, strategy)
            try:
                yield from cell_rows(key, predict(), one.condition.votes)
            except REFUSALS as refusal:
                paper = pipeline == "paper"
                names = recognition.classifiers if paper else recognition.order_free.classifiers
                yield error_rows(key, names, str(refusal))


def predict_condition(
    planned: Planned, features: pa.Table | str, strategy: str, pipeline: str, seed: int
) -> Predictions:
    """Train and test every split of one pipeline on a condition's touches by one strategy."""
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

    With `votes`, every evenly spaced choice of so many viewpoints of an object is one recognition; without, each
    sequence. Raises `RecognitionError` if there are fewer viewpoints.
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
    """Return `tables.STUDY` of a condition that can't be run: one row per classifier with the reason."""
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
    """Return the tested objects, and how many of how many sequences of each are correctly classified."""
    test = prediction.split.test
    owners, row = np.unique(sequences.object_index[test], return_inverse=True)
    correct = prediction.predicted == sequences.labels[test]
    right = np.bincount(row, weights=correct).astype(np.float64)
    return owners, right, np.bincount(row).astype(np.int64)


def _vote(
    sequences: TouchSequences, prediction: SplitPrediction, votes: int
) -> tuple[IntArray, FloatArray, IntArray]:
    """Return the tested objects, the share of choices of `votes` viewpoints that classify each correctly, and ones."""
    test, viewpoints = prediction.split.test, np.unique(sequences.viewpoint)
    if votes > len(viewpoints):
        raise RecognitionError(f"{votes} viewpoints can't vote, for the run has {len(viewpoints)}.")
    owners, row = np.unique(sequences.object_index[test], return_inverse=True)
    if votes > 1 and np.isin(sequences.object_index, owners).sum() > len(test):
        raise RecognitionError(
            "Objects are tested from some of their viewpoints only, so not all of these can vote; "
            "choose a protocol that tests whole objects."
        )
    choices = viewpoints[evenly_spaced_subsets(len(viewpoints), votes)]
    chosen = (sequences.viewpoint[test] == choices[..., None]).any(axis=1)
    members = (row == np.arange(len(owners))[:, None])[:, None] & chosen
    # An object may have no whole sequence from any viewpoint of a choice.
    voting = members.any(axis=2)
    true_class = np.broadcast_to(sequences.class_of_object[owners][:, None], voting.shape)
    credit = np.zeros(voting.shape)
    credit[voting] = group_credit(prediction, members[voting], true_class[voting])
    return owners, credit.sum(axis=1) / voting.sum(axis=1), np.ones(len(owners), dtype=np.int64)


def group_credit(
    prediction: SplitPrediction, members: BoolArray, true_class: IntArray
) -> FloatArray:
    """Return the credit of groups of test sequences: by log probabilities if there are any, else by majority vote.

    Parameters
    ----------
    members : ndarray of shape (m, n), bool
        The test sequences of each group.
    true_class : ndarray of shape (m,)
        The class of each group's object.

    Returns
    -------
    ndarray of shape (m,)
        1 for a correct classification, and 1/k if k classes share the most votes.
    """
    if prediction.log_probabilities is None:
        group, sequence = np.nonzero(members)
        return vote_credit(group, prediction.predicted[sequence], true_class)[1]
    pooled = pooled_log_probabilities(prediction.log_probabilities, members)
    return (pooled.argmax(axis=1) == true_class).astype(np.float64)
