"""Protocol `new_touches`: train on touches of all objects in some turns, test touches of the same objects in another turn.

An object is a class here, and each turn of the object is an object of the class. So the grouped folds of `recognition`
keep every turn of an object whole, in training or in the test, and so do the folds that fit the temperature.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray

from known_objects.study import MOST_TOUCHES, PIPELINE, STRATEGIES, STUDY
from known_objects.summary import summarise
from known_objects.tables import KNOWN_OBJECTS
from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import RecognitionError
from visuohaptic.geometry.turning import draw_rotation
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.descriptors import describe_all
from visuohaptic.recognition.experiment import one_thread
from visuohaptic.recognition.parameters import ProtocolParameters, RecognitionParameters
from visuohaptic.recognition.pipelines import fit_calibrated, log_probabilities, make_order_free
from visuohaptic.recognition.sequences import TouchSequences, gather_pipeline, whole_sequences
from visuohaptic.recognition.splits import Split, draw_splits
from visuohaptic.studies.conditions import HEADLINE_CLASSIFIERS, plan_study
from visuohaptic.studies.figures import write_json
from visuohaptic.studies.measuring import features_by_key
from visuohaptic.studies.study import StepInputs
from visuohaptic.tables.phases import POINT_NAMES, keys_of
from visuohaptic.tables.schema import build_table, matrix, write_table

logger = logging.getLogger(__name__)

LEAST_TURNS = 3
"""One turn is tested; of the others one trains and one fits the temperature."""

SAME_POINT = 1e-6
"""Distance below which two touches are at one point of the object, in object radii. Turned vertices are rounded to
float32, which moves a point by some 1e-7."""


@dataclass(frozen=True)
class Turned:
    """Touches of the objects in one turn: rows of `tables.FEATURES`, and the parameters that made the rows."""

    features: pa.Table
    parameters: ExperimentParameters


def make_known_objects(step: StepInputs) -> None:
    """Write `KNOWN_OBJECTS`, and its summary as JSON."""
    read = features_by_key((), step.recomputed_features, None)
    turned = []
    for planned in plan_study(STUDY, step.run).conditions:
        features = read(planned.key)
        if isinstance(features, str):
            raise RecognitionError(features)
        turned.append(Turned(features, planned.parameters))
    parts = [answer_new_touches(turned, strategy, step.run.seed) for strategy in STRATEGIES]
    table, metrics = step.outputs
    answers = pa.concat_tables(parts)
    write_table(KNOWN_OBJECTS, answers, table)
    write_json(summarise(answers, step.run.recognition.intervals), metrics)


def answer_new_touches(turned: Sequence[Turned], strategy: str, seed: int) -> pa.Table:
    """Return `KNOWN_OBJECTS`: the answer to each view of a strategy after 1 to `MOST_TOUCHES` touches.

    Each turn of an object is tested once, by models that learnt the other turns. Views with fewer than `MOST_TOUCHES`
    touches are left out. Raises `RecognitionError` if there is one object, an object has fewer than `LEAST_TURNS` turns,
    or two turns of an object were touched at the same point.
    """
    made = [
        replace(one, features=first_touches(one.features, strategy, MOST_TOUCHES)) for one in turned
    ]
    if not any(one.features.num_rows for one in made):
        raise RecognitionError(f"No view of any object has {MOST_TOUCHES} touches by {strategy}.")
    for key in sorted({key for one in made for key in keys_of(one.features).to_pylist()}):
        check_new_points(key, strategy, made)
    recognition = turned[0].parameters.recognition
    table = mark_turns([one.features for one in made])
    sequences = gather_pipeline(table, recognition, PIPELINE, seed)
    check_turns(sequences, strategy)
    splits = split_turns(sequences, seed)
    probabilities = classify_splits(sequences, splits, recognition, seed)
    return _answers(sequences, probabilities, strategy)


def mark_turns(features: Sequence[pa.Table]) -> pa.Table:
    """Join the features of all turns; class becomes the object ``class/name``, and object the turn, such as ``3``."""
    marked = []
    for turn, table in enumerate(features):
        columns = {
            "class": keys_of(table),
            "object": pa.array([str(turn)] * table.num_rows, pa.string()),
        }
        for name, values in columns.items():
            index = table.column_names.index(name)
            table = table.set_column(index, table.schema.field(index), values)  # noqa: PLW2901
        marked.append(table)
    # Tables that lost views have columns that may be null.
    return pa.concat_tables(marked, promote_options="default")


def check_turns(sequences: TouchSequences, strategy: str) -> None:
    """Raise `RecognitionError` if there is one object, or an object has fewer than `LEAST_TURNS` turns."""
    if len(sequences.classes) < 2:
        raise RecognitionError(
            f"There is one object ({', '.join(sequences.classes)}); new_touches needs at least two."
        )
    counts = np.bincount(sequences.class_of_object)
    for name, turns in zip(sequences.classes, counts.tolist(), strict=True):
        if turns < LEAST_TURNS:
            raise RecognitionError(
                f"{name} has touches by {strategy} in {turns} turn{'' if turns == 1 else 's'}; "
                f"new_touches needs at least {LEAST_TURNS}."
            )


def check_new_points(key: str, strategy: str, turned: Sequence[Turned]) -> None:
    """Raise `RecognitionError` if an object was touched at the same point in two turns.

    The touches are turned back to the object's own pose.
    """
    from scipy.spatial import cKDTree

    points, turns = [], []
    for turn, one in enumerate(turned):
        rows = one.features.filter(pc.equal(keys_of(one.features), key))
        meshes = one.parameters.meshes
        rotation = draw_rotation(meshes.turns, key, one.parameters.seed, meshes.turn_draw)
        points.append(matrix(rows, POINT_NAMES) @ rotation)
        turns += [turn] * rows.num_rows
    pairs = cKDTree(np.concatenate(points)).query_pairs(SAME_POINT, output_type="ndarray")
    first, second = np.array(turns)[pairs].T
    if (first != second).any():
        repeated = (first != second).argmax()
        raise RecognitionError(
            f"{key} was touched by {strategy} at the same point in turns {first[repeated]} and "
            f"{second[repeated]}; each turn needs a seed of its own."
        )


def split_turns(sequences: TouchSequences, seed: int) -> list[Split]:
    """Divide sequences of `mark_turns` into folds; each fold tests one turn of each object."""
    turns = int(np.bincount(sequences.class_of_object).max())
    return draw_splits(sequences, ProtocolParameters(protocol="grouped_folds", folds=turns), seed)


def classify_splits(
    sequences: TouchSequences,
    splits: Sequence[Split],
    parameters: RecognitionParameters,
    seed: int,
) -> FloatArray:
    """Compute calibrated probabilities after each touch: (t, s, c) for t touches, s sequences and c objects.

    Sequences that no split tests have NaN.
    """
    touches = sequences.features.shape[1]
    found = np.full((touches, len(sequences.labels), len(sequences.classes)), np.nan)
    for count in range(1, touches + 1):
        shorter = replace(sequences, features=sequences.features[:, :count])
        described = describe_all(shorter, parameters, seed)
        with one_thread():
            for split in splits:
                found[count - 1, split.test] = _classify(sequences, described, split)
    return found


def _classify(sequences: TouchSequences, described: FloatArray, split: Split) -> FloatArray:
    """Fit on the training sequences of a split, and return the probabilities of its test sequences."""
    pipeline = make_order_free(HEADLINE_CLASSIFIERS[PIPELINE])
    train, test = split.train, split.test
    preparation = pipeline[:-1].fit(described[train])
    rows, labels = preparation.transform(described[train]), sequences.labels[train]
    fitted = fit_calibrated(pipeline[-1], rows, labels, sequences.object_index[train])
    logs = log_probabilities(fitted, preparation.transform(described[test]), len(sequences.classes))
    probabilities: FloatArray = np.exp(logs)
    return probabilities


def first_touches(features: pa.Table, strategy: str, touches: int) -> pa.Table:
    """Return the first touches of the views of a strategy that have enough, and log the views without."""
    made = pc.and_(
        pc.equal(features.column("strategy"), strategy), pc.less(features.column("touch"), touches)
    )
    whole, left_out = whole_sequences(features.filter(made), touches)
    for sentence in left_out:
        logger.warning("%s", sentence)
    return whole


def _answers(sequences: TouchSequences, probabilities: FloatArray, strategy: str) -> pa.Table:
    """Return the rows of `KNOWN_OBJECTS`, touch by touch."""
    touches, count, _ = probabilities.shape
    predicted = probabilities.argmax(axis=2)
    names = np.array(sequences.classes, dtype=object)
    keys, turns = np.array(sequences.objects, dtype=object)[sequences.object_index].T
    categories, objects = np.array([key.split("/", 1) for key in keys], dtype=object).T
    of_view: Mapping[str, NDArray[Any]] = {
        "turn": turns.astype(np.int64),
        "class": categories,
        "object": objects,
        "viewpoint": sequences.viewpoint,
    }
    return build_table(
        KNOWN_OBJECTS,
        {
            "strategy": [strategy] * (touches * count),
            **{name: np.tile(values, touches) for name, values in of_view.items()},
            "touches": np.repeat(np.arange(1, touches + 1), count),
            "answer": names[predicted].ravel(),
            "probability": probabilities.max(axis=2).ravel(),
            "correct": (predicted == sequences.labels).ravel(),
        },
    )
