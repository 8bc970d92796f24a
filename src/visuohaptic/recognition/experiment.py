"""Train and test every split of a pipeline on the features of one strategy."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.recognition.encoding import fit_sequence_encoder
from visuohaptic.recognition.parameters import ClassifierName, RecognitionParameters
from visuohaptic.recognition.sequences import (
    TouchSequences,
    gather_sequences,
    identical_objects,
)
from visuohaptic.recognition.splits import Split, make_splits
from visuohaptic.recognition.voting import vote_credit
from visuohaptic.seeds import spawn_generator
from visuohaptic.tables import (
    CONTOURLET_FEATURES,
    KINESTHETIC_FEATURES,
    PREDICTIONS,
    SCORES,
    build_table,
)

PAPER_FEATURES = (*CONTOURLET_FEATURES, *KINESTHETIC_FEATURES)
"""The paper's 16 cutaneous and 6 kinesthetic features of a touch."""


@dataclass(frozen=True)
class Answer:
    """What one classifier named in one split.

    Attributes
    ----------
    classifier : str
        The classifier.
    predicted : numpy.ndarray
        Shape (n,), int64: the class named for each test sequence.
    note : str or None
        What the classifier needed to be fitted.
    """

    classifier: ClassifierName
    predicted: NDArray[np.int64]
    note: str | None


def run_pipeline(
    features: pa.Table, parameters: RecognitionParameters, seed: int, pipeline: str = "paper"
) -> tuple[pa.Table, pa.Table]:
    """Train and test every split, classifier and repeat on one strategy's features.

    Everything that is fitted (scalings, map, classifier) sees the training
    sequences of its split alone.

    Parameters
    ----------
    features : pyarrow.Table
        Rows of `tables.FEATURES` of one strategy; their order changes nothing.
    parameters : RecognitionParameters
        Every choice on the way.
    seed : int
        The experiment's seed. The splits, and the generator of each, depend on
        it and not on the strategy, so strategies compare in pairs.
    pipeline : str
        Which pipeline.

    Returns
    -------
    scores : pyarrow.Table
        `tables.SCORES`, a row for each classifier, split and repeat.
    predictions : pyarrow.Table
        `tables.PREDICTIONS`, a row for each tested sequence of each.

    Raises
    ------
    RecognitionError
        If the features don't allow the experiment; the sentence says why.
    """
    from sklearn import config_context
    from threadpoolctl import threadpool_limits

    sequences = gather_sequences(features, PAPER_FEATURES, parameters.touches)
    strategy = features.column("strategy")[0].as_py()
    record = _Record(pipeline, strategy, sequences)
    # One thread, so that sums are taken in one order on every machine; finite numbers were
    # checked when the sequences were gathered.
    with threadpool_limits(limits=1), config_context(assume_finite=True):
        for repeat in range(parameters.protocol.repeats):
            drawing = spawn_generator(seed, "recognition", "splits", repeat)
            for split in make_splits(sequences, parameters.protocol, drawing):
                generator = spawn_generator(seed, "recognition", pipeline, repeat, split.number)
                for answer in run_paper_split(sequences, split, parameters, generator):
                    record.add(split, repeat, answer)
    return record.scores(), record.predictions()


def run_paper_split(
    sequences: TouchSequences,
    split: Split,
    parameters: RecognitionParameters,
    generator: np.random.Generator,
) -> Iterator[Answer]:
    """Fit the paper's pipeline on a split's training sequences and name its test sequences.

    Parameters
    ----------
    sequences : TouchSequences
        All sequences; the test ones are only encoded and named.
    split : Split
        Which train and which are tested.
    parameters : RecognitionParameters
        Every choice on the way.
    generator : numpy.random.Generator
        For the map and the classifiers.

    Yields
    ------
    Answer
        One for each classifier.
    """
    from visuohaptic.recognition.classifiers import fit_classifier

    labels = sequences.labels[split.train]
    encoder = fit_sequence_encoder(sequences.features[split.train], parameters, generator)
    training = encoder.encode(sequences.features[split.train])
    tested = encoder.encode(sequences.features[split.test])
    for name in parameters.classifiers:
        fitted, note = fit_classifier(name, parameters.classifier, training, labels, generator)
        yield Answer(name, fitted.predict(tested), note)


class _Record:
    """The rows of both tables as the answers come in."""

    def __init__(self, pipeline: str, strategy: str, sequences: TouchSequences) -> None:
        self._key = {"pipeline": pipeline, "strategy": strategy}
        self._sequences = sequences
        self._twins = _twins_note(sequences)
        self._scores: list[dict[str, object]] = []
        self._predictions: list[dict[str, NDArray[np.generic]]] = []

    def add(self, split: Split, repeat: int, answer: Answer) -> None:
        sequences = self._sequences
        owners = sequences.object_index[split.test]
        right = answer.predicted == sequences.labels[split.test]
        _, credit = vote_credit(owners, answer.predicted, sequences.class_of_object)
        key: dict[str, object] = {
            **self._key,
            "classifier": answer.classifier,
            "split": split.number,
            "seed": repeat,
        }
        notes = [note for note in (answer.note, self._twins) if note]
        figures = {
            "accuracy": float(right.mean()),
            "object_accuracy": float(credit.mean()),
            "sequences": len(owners),
            "note": "; ".join(notes) or None,
        }
        self._scores.append({**key, **figures})
        names = np.array(sequences.objects, dtype=object)[owners]
        columns = {
            "class": names[:, 0],
            "object": names[:, 1],
            "viewpoint": sequences.viewpoint[split.test],
            "predicted": np.array(sequences.classes, dtype=object)[answer.predicted],
        }
        repeated = {name: np.full(len(owners), value) for name, value in key.items()}
        self._predictions.append({**repeated, **columns})

    def scores(self) -> pa.Table:
        names = self._scores[0]
        return build_table(SCORES, {name: [row[name] for row in self._scores] for name in names})

    def predictions(self) -> pa.Table:
        names = self._predictions[0]
        columns = {
            name: np.concatenate([block[name] for block in self._predictions]) for name in names
        }
        return build_table(PREDICTIONS, columns)


def _twins_note(sequences: TouchSequences) -> str | None:
    pairs = identical_objects(sequences)
    if not pairs:
        return None
    named = ", ".join(f"{first} and {second}" for first, second in pairs)
    return f"touches are identical for {named}, so a test may meet what training saw"
