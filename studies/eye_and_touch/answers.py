"""Compute the answers of a sense in every split, tested and held out, and combine two senses."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.distance import cdist
from scipy.special import softmax
from sklearn.pipeline import Pipeline

from touch_curves.temperature import fit_temperature
from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import RecognitionError
from visuohaptic.recognition.experiment import one_thread
from visuohaptic.recognition.pipelines import (
    CALIBRATION_FOLDS,
    LEAST_LOG_PROBABILITY,
    log_probabilities,
    make_order_free,
)
from visuohaptic.recognition.sequences import TouchSequences
from visuohaptic.recognition.splits import Split, held_out_folds
from visuohaptic.studies.conditions import HEADLINE_CLASSIFIERS

FAMILIAR = 0.95
"""Share of held-out training views that count as familiar."""


@dataclass(frozen=True)
class Answered:
    """Class probabilities of one split, and the distance of each sequence from the training objects.

    Attributes
    ----------
    tested : ndarray of shape (k, n, c)
        Probabilities of the n test sequences in each of k conditions of the test.
    held_out : ndarray of shape (m, c)
        Probabilities of m training sequences, by models that were fitted on other objects.
    indices : ndarray of shape (m,)
        Indices of the held-out sequences.
    strange : ndarray of shape (k, n)
        Distance of each test sequence from the nearest training object.
    held_out_strange : ndarray of shape (m,)
        Distance of each held-out sequence from the nearest training object of its model.
    """

    tested: FloatArray
    held_out: FloatArray
    indices: IntArray
    strange: FloatArray
    held_out_strange: FloatArray


def answer_splits(
    splits: Sequence[Split],
    described: Iterable[Sequence[np.ndarray]],
    sequences: TouchSequences,
) -> list[Answered]:
    """Train and test the headline classifier of pipeline `order_free` in every split.

    `described` has, per split, one array of descriptors of all sequences, (s, d), per condition of the test. Training
    uses the first condition. Raises `RecognitionError` if no training object can be held out.
    """
    with one_thread():
        return [
            _answer_split(split, conditions, sequences)
            for split, conditions in zip(splits, described, strict=True)
        ]


def _answer_split(
    split: Split, described: Sequence[np.ndarray], sequences: TouchSequences
) -> Answered:
    labels, owners = sequences.labels, sequences.object_index
    folds = held_out_folds(labels[split.train], owners[split.train], CALIBRATION_FOLDS)
    if not folds:
        raise RecognitionError(
            "Every class has one training object; two objects of a class are needed to calibrate answers."
        )
    learnt = described[0]
    logs, strange, indices = [], [], []
    for train, held_out in folds:
        indices.append(split.train[held_out])
        sense = Sense.learn(learnt, split.train[train], sequences)
        logs.append(sense.answer(learnt[indices[-1]]))
        strange.append(sense.strangeness(learnt[indices[-1]]))
    held_out_logs, index = np.concatenate(logs), np.concatenate(indices)
    temperature = fit_temperature(held_out_logs, labels[index], _doubt(owners[index]))
    sense = Sense.learn(learnt, split.train, sequences)
    tests = [condition[split.test] for condition in described]
    return Answered(
        np.stack([softmax(sense.answer(rows) / temperature, axis=1) for rows in tests]),
        softmax(held_out_logs / temperature, axis=1),
        index,
        np.stack([sense.strangeness(rows) for rows in tests]),
        np.concatenate(strange),
    )


@dataclass(frozen=True)
class Sense:
    """A classifier of descriptors that is fitted on training sequences.

    Attributes
    ----------
    model : sklearn.pipeline.Pipeline
        Fitted pipeline of `make_order_free`.
    centres : ndarray of shape (o, d)
        Mean of the scaled descriptors of each training object.
    classes : int
        Number of classes, including classes without training objects.
    """

    model: Pipeline
    centres: FloatArray
    classes: int

    @classmethod
    def learn(cls, described: np.ndarray, train: IntArray, sequences: TouchSequences) -> Sense:
        """Fit on the sequences with the indices `train` (n,); `described` (s, d) has the descriptors of all sequences."""
        rows = described[train].astype(np.float64)
        model = make_order_free(HEADLINE_CLASSIFIERS["order_free"])
        model.fit(rows, sequences.labels[train])
        scaled = model.named_steps["scaling"].transform(rows)
        owners = sequences.object_index[train]
        centres = np.stack([scaled[owners == owner].mean(axis=0) for owner in np.unique(owners)])
        return cls(model, centres, len(sequences.classes))

    def answer(self, described: np.ndarray) -> FloatArray:
        """Compute log probabilities without a temperature: (n, d) to (n, c)."""
        return log_probabilities(self.model, described.astype(np.float64), self.classes)

    def strangeness(self, described: np.ndarray) -> FloatArray:
        """Compute the distance from the nearest training object, after scaling: (n, d) to (n,)."""
        scaled = self.model.named_steps["scaling"].transform(described.astype(np.float64))
        nearest: FloatArray = cdist(scaled, self.centres).min(axis=1)
        return nearest


def ask_if_familiar(answered: Answered) -> Answered:
    """Return answers with equal probabilities for unfamiliar sequences.

    A sequence is unfamiliar if its distance is above the quantile `FAMILIAR` of the held-out sequences.
    """
    limit = np.quantile(answered.held_out_strange, FAMILIAR)
    equal = 1 / answered.tested.shape[2]
    return replace(
        answered,
        tested=np.where((answered.strange > limit)[..., None], equal, answered.tested),
        held_out=np.where((answered.held_out_strange > limit)[:, None], equal, answered.held_out),
    )


def multiply(first: Answered, second: Answered, labels: IntArray, owners: IntArray) -> Answered:
    """Return the product of two calibrated answers, normalised; `second` was tested in one condition.

    If two senses make the same errors, the product is too sure. A temperature, fitted on held-out training sequences,
    corrects the product. `labels` and `owners` are the class and object of all sequences, shape (s,).
    """
    held_out = _log(first.held_out) + _log(second.held_out)
    tested = _log(first.tested) + _log(second.tested)
    temperature = fit_temperature(held_out, labels[first.indices], _doubt(owners[first.indices]))
    return replace(
        first,
        tested=softmax(tested / temperature, axis=-1),
        held_out=softmax(held_out / temperature, axis=-1),
    )


def _doubt(owners: IntArray) -> float:
    # Label smoothing 1 / (n + 2), the rule of succession: n correct objects do not give probability 1.
    return float(1 / (len(np.unique(owners)) + 2))


def _log(probabilities: FloatArray) -> FloatArray:
    logs: FloatArray = np.log(np.maximum(probabilities, np.exp(LEAST_LOG_PROBABILITY)))
    return logs
