"""Train and test every split of a pipeline on the features of one strategy."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import RecognitionError
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.recognition.classifiers import (
    CLASSIFIERS,
    Classifier,
    ClassifierName,
    fit_classifier,
    fit_each,
)
from visuohaptic.recognition.descriptors import describe_all
from visuohaptic.recognition.encoding import fit_sequence_encoder
from visuohaptic.recognition.memory import REMEMBERED_SEQUENCES, FitMemory
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.sequences import (
    TouchSequences,
    gather_sequences,
    shuffle_touches,
    spread_contact_states,
    turn_objects,
)
from visuohaptic.recognition.splits import Split, make_splits
from visuohaptic.recognition.tuning import fit_best_classifiers
from visuohaptic.recognition.voting import vote_credit
from visuohaptic.tables.phases import (
    CONTOURLET_FEATURES,
    KINESTHETIC_FEATURES,
    PREDICTIONS,
    SCORES,
)
from visuohaptic.tables.schema import build_rows, build_table

if TYPE_CHECKING:
    from visuohaptic.recognition.pooling import Ballots

AnswerSplit = Callable[[Split, np.random.Generator], Iterator["Answer"]]
"""Trains on a split's training sequences and classifies its test sequences."""


@dataclass(frozen=True)
class Answer:
    """What one classifier predicted in one split: the class of each test sequence, (n,).

    There are `ballots` where the pipeline gives probabilities.
    """

    classifier: ClassifierName
    predicted: IntArray
    note: str | None
    ballots: Ballots | None = None


def run_pipeline(
    features: pa.Table, parameters: RecognitionParameters, seed: int, pipeline: str = "paper"
) -> tuple[pa.Table, pa.Table]:
    """Train and test every split, classifier and repeat on one strategy's features.

    Gives rows of `tables.SCORES` and of `tables.PREDICTIONS`. Splits depend on the seed and not on
    the strategy, so strategies compare in pairs. A classifier that can't be fitted in a split has
    no row at all, and the log says why. Raises `RecognitionError` if the features don't allow the
    experiment.
    """
    strategy = features.column("strategy")[0].as_py() if len(features) else ""
    sequences = gather_pipeline(features, parameters, pipeline, seed)
    return run_sequences(sequences, strategy, parameters, seed, pipeline)


def run_sequences(
    sequences: TouchSequences,
    strategy: str,
    parameters: RecognitionParameters,
    seed: int,
    pipeline: str,
    answer_split: AnswerSplit | None = None,
) -> tuple[pa.Table, pa.Table]:
    """Train and test every split, classifier and repeat on gathered sequences.

    `strategy` names the rows alone; `answer_split` is as in `answer_splits`. Gives what
    `run_pipeline` does.
    """
    # Votes are counted as the answers come, while sums are still taken on one thread.
    answers = answer_splits(sequences, parameters, seed, pipeline, answer_split)
    twins = _twins_note(sequences)
    found: list[tuple[dict[str, object], dict[str, NDArray[np.generic]]]] = []
    for split, repeat, answer in answers:
        key: dict[str, object] = {
            "pipeline": pipeline,
            "strategy": strategy,
            "classifier": answer.classifier,
            "split": split.number,
            "seed": repeat,
        }
        voted, credit = _vote(sequences, split, answer)
        figures = {
            "accuracy": float((answer.predicted == sequences.labels[split.test]).mean()),
            "object_accuracy": float(credit.mean()),
            "sequences": len(split.test),
            "note": "; ".join(filter(None, (answer.note, twins))) or None,
        }
        repeated = {name: np.full(len(split.test), value) for name, value in key.items()}
        predicted = repeated | _predicted(sequences, split, answer, voted)
        found.append((key | figures, predicted))
    # Whom a split lacks is left out: its mean over the others would compare with no one's.
    splits = len({(score["split"], score["seed"]) for score, _ in found})
    answered = Counter(score["classifier"] for score, _ in found)
    kept = [pair for pair in found if answered[pair[0]["classifier"]] == splits]
    if not kept:
        raise RecognitionError("No classifier can be fitted in every split; see the log.")
    scores, blocks = zip(*kept, strict=True)
    columns = {name: np.concatenate([block[name] for block in blocks]) for name in blocks[0]}
    return build_rows(SCORES, list(scores)), build_table(PREDICTIONS, columns)


def answer_splits(
    sequences: TouchSequences,
    parameters: RecognitionParameters,
    seed: int,
    pipeline: str,
    answer_split: AnswerSplit | None = None,
) -> Iterator[tuple[Split, int, Answer]]:
    """Train and test every split, classifier and repeat, and give the answers one by one.

    `answer_split` trains and tests a split; without it the pipeline does.
    """
    answer_split = answer_split or split_runner(sequences, parameters, seed, pipeline)
    with fitting():
        for split, repeat in draw_splits(sequences, parameters, seed):
            generator = spawn_generator(seed, "recognition", pipeline, repeat, split.number)
            for answer in answer_split(split, generator):
                yield split, repeat, answer


def draw_splits(
    sequences: TouchSequences, parameters: RecognitionParameters, seed: int
) -> Iterator[tuple[Split, int]]:
    """Divide sequences into training and test: every split of every repeat, with its number."""
    for repeat in range(parameters.protocol.repeats):
        drawing = spawn_generator(seed, "recognition", "splits", repeat)
        for split in make_splits(sequences, parameters.protocol, drawing):
            yield split, repeat


@contextmanager
def fitting() -> Iterator[None]:
    """Fit on one thread, so that sums are taken in one order, and without scikit-learn's checks."""
    from sklearn import config_context
    from threadpoolctl import threadpool_limits

    checks = config_context(assume_finite=True, skip_parameter_validation=True)
    with threadpool_limits(limits=1), checks:
        yield


def gather_pipeline(
    features: pa.Table, parameters: RecognitionParameters, pipeline: str, seed: int = 0
) -> TouchSequences:
    """Gather the columns that a pipeline uses from rows of one strategy.

    ``paper`` takes the paper's 22 features; ``best`` also columns ``imprint_…``, ``sensor_size``
    and ``contact_state`` where there are any. Raises `RecognitionError` if there is no such
    pipeline, or the features don't allow it.
    """
    bands = _described(features)
    features = turn_objects(features, parameters.protocol.turns)
    if pipeline == "paper":
        names = bands if "cutaneous" in parameters.cues else []
        names = [*names, *(KINESTHETIC_FEATURES if "kinesthetic" in parameters.cues else ())]
    elif pipeline == "best":
        features = spread_contact_states(features)
        extra = [
            name
            for name in features.column_names
            if name.startswith(("imprint_", "contact_")) or name == "sensor_size"
        ]
        names = [*bands, *KINESTHETIC_FEATURES, *extra]
    else:
        raise RecognitionError(f"There is no pipeline {pipeline}; paper and best are allowed.")
    sequences = gather_sequences(features, names, parameters.touches)
    return sequences if parameters.order == "kept" else shuffle_touches(sequences, seed)


def _described(features: pa.Table) -> list[str]:
    """Name the columns ``contourlet_…`` that the descriptor of the imprint fills; the others are 0."""
    present = [name for name in CONTOURLET_FEATURES if name in features.column_names]
    # A band may be 0 by chance; only those after the last filled one are not the descriptor's.
    places = enumerate(present, start=1)
    filled = [place for place, name in places if features.column(name).to_numpy().any()]
    return present[: max(filled, default=len(present))]


def split_runner(
    sequences: TouchSequences,
    parameters: RecognitionParameters,
    seed: int,
    pipeline: str,
    maps: FitMemory | None = None,
) -> AnswerSplit:
    """Give what trains and tests a split by a pipeline; `maps` of other runs change no number."""
    if pipeline == "paper":
        return partial(run_paper_split, sequences, parameters, memory=maps)
    described = describe_all(sequences, parameters.best, seed)
    memory = FitMemory(REMEMBERED_SEQUENCES)
    return partial(run_best_split, sequences, described, parameters, memory=memory)


def run_paper_split(
    sequences: TouchSequences,
    parameters: RecognitionParameters,
    split: Split,
    generator: np.random.Generator,
    memory: FitMemory | None = None,
    classifiers: Iterable[Classifier] = (),
) -> Iterator[Answer]:
    """Fit the paper's pipeline on a split's training sequences and classify its test sequences.

    `memory` holds maps of other runs and changes no number; `classifiers` replace those of the
    parameters. Yields an answer for each classifier that can be fitted.
    """
    entries = {entry.name: entry for entry in classifiers}
    entries = entries or {name: CLASSIFIERS[name] for name in parameters.classifiers}
    labels = sequences.labels[split.train]
    encoder = fit_sequence_encoder(sequences.features[split.train], parameters, generator, memory)
    training = encoder.encode(sequences.features[split.train])
    tested = encoder.encode(sequences.features[split.test])
    for name, (fitted, note) in fit_each(
        entries,
        lambda name: fit_classifier(
            entries[name], parameters.classifier, training, labels, generator
        ),
    ):
        yield Answer(name, fitted.predict(tested), note)


def run_best_split(
    sequences: TouchSequences,
    described: FloatArray,
    parameters: RecognitionParameters,
    split: Split,
    generator: np.random.Generator,
    memory: FitMemory | None = None,
) -> Iterator[Answer]:
    """Fit pipeline `best` on a split's training sequences and classify its test sequences.

    `described` (s, d) are all sequences' descriptors; `memory` holds fits of other splits and
    changes no number. Yields an answer with probabilities for each classifier that can be fitted.
    """
    training = described[split.train]
    labels, owners = sequences.labels[split.train], sequences.object_index[split.train]
    projection, fits = fit_best_classifiers(
        training, labels, owners, len(sequences.classes), parameters, generator, memory
    )
    tested = projection.apply(described[split.test])
    for name, classifier, note in fits:
        ballots = classifier.ballots(tested)
        chosen = f"chosen by inner folds: {classifier.setting}"
        notes = "; ".join(filter(None, (chosen, note)))
        yield Answer(name, ballots.alone().argmax(axis=1), notes, ballots)


def _vote(sequences: TouchSequences, split: Split, answer: Answer) -> tuple[IntArray, FloatArray]:
    """Give the class voted for each sequence's object (-1 without probabilities), and credits."""
    owners, true_class = sequences.object_index[split.test], sequences.class_of_object
    if answer.ballots is None:
        _, credit = vote_credit(owners, answer.predicted, true_class)
        return np.full(len(owners), -1), credit
    present, row = np.unique(owners, return_inverse=True)
    voted = answer.ballots.together(owners == present[:, None]).argmax(axis=1)
    return voted[row], (voted == true_class[present]).astype(np.float64)


def _predicted(
    sequences: TouchSequences, split: Split, answer: Answer, voted: IntArray
) -> dict[str, NDArray[np.generic]]:
    """Give the columns of predictions that differ from one test sequence to another."""
    names = np.array(sequences.objects, dtype=object)[sequences.object_index[split.test]]
    classes = np.array([*sequences.classes, None], dtype=object)
    probability = np.full(len(split.test), None, dtype=object)
    if answer.ballots is not None:
        probability = answer.ballots.alone().max(axis=1).astype(object)
    return {
        "class": names[:, 0],
        "object": names[:, 1],
        "viewpoint": sequences.viewpoint[split.test],
        "predicted": classes[answer.predicted],
        "probability": probability,
        "voted": classes[voted],
    }


def _twins_note(sequences: TouchSequences) -> str | None:
    """Name the pairs of objects whose touches are the same number for number."""
    first: dict[bytes, str] = {}
    pairs = []
    for place, owner in enumerate(sequences.objects):
        name, content = "/".join(owner), sequences.features[sequences.object_index == place]
        known = first.setdefault(content.tobytes(), name)
        if known != name:
            pairs.append(f"{known} and {name}")
    if not pairs:
        return None
    return f"touches are identical for {', '.join(pairs)}, so a test may meet what training saw"
