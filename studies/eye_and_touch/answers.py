"""What a sense answers in every split, tested and held out, and one answer of two senses."""

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
    """Class probabilities of one split, and how strange each sequence is.

    Attributes
    ----------
    tested : ndarray of shape (k, n, c)
        Of the n test sequences in each of k conditions of the test.
    held_out : ndarray of shape (m, c)
        Of the m training sequences, by models that learnt from other objects.
    indices : ndarray of shape (m,)
        Which sequences were held out.
    strange : ndarray of shape (k, n)
        Distance of each test sequence from the nearest training object.
    held_out_strange : ndarray of shape (m,)
        Distance of each held-out sequence from the nearest object of its model's training.
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

    `described` holds per split the descriptors of all s sequences, (s, d), in each condition of the test; the first
    condition is learnt. Raises `RecognitionError` if no training object can be held out.
    """
    with one_thread():
        return [
            _answer_split(split, own, sequences)
            for split, own in zip(splits, described, strict=True)
        ]


def _answer_split(
    split: Split, described: Sequence[np.ndarray], sequences: TouchSequences
) -> Answered:
    labels, owners = sequences.labels, sequences.object_index
    folds = held_out_folds(labels[split.train], owners[split.train], CALIBRATION_FOLDS)
    if not folds:
        raise RecognitionError(
            "Every class has one training object; two are needed to know how sure answers are."
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
    tests = [one[split.test] for one in described]
    return Answered(
        np.stack([softmax(sense.answer(one) / temperature, axis=1) for one in tests]),
        softmax(held_out_logs / temperature, axis=1),
        index,
        np.stack([sense.strangeness(one) for one in tests]),
        np.concatenate(strange),
    )


@dataclass(frozen=True)
class Sense:
    """A classifier of descriptors, fitted on some sequences.

    Attributes
    ----------
    model : sklearn.pipeline.Pipeline
        As `make_order_free` makes it.
    centres : ndarray of shape (o, d)
        Mean of the scaled descriptors of each training object.
    classes : int
        Number of classes, also of those without training objects.
    """

    model: Pipeline
    centres: FloatArray
    classes: int

    @classmethod
    def learn(cls, described: np.ndarray, train: IntArray, sequences: TouchSequences) -> Sense:
        """Fit on the sequences with the indices `train` (n,), of which `described` (s, d) has the descriptors."""
        rows = described[train].astype(np.float64)
        model = make_order_free(HEADLINE_CLASSIFIERS["order_free"])
        model.fit(rows, sequences.labels[train])
        scaled = model.named_steps["scaling"].transform(rows)
        owners = sequences.object_index[train]
        centres = np.stack([scaled[owners == one].mean(axis=0) for one in np.unique(owners)])
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
    """Replace answers by equal probabilities where a sequence is stranger than `FAMILIAR` of those held out."""
    limit = np.quantile(answered.held_out_strange, FAMILIAR)
    none = 1 / answered.tested.shape[2]
    return replace(
        answered,
        tested=np.where((answered.strange > limit)[..., None], none, answered.tested),
        held_out=np.where((answered.held_out_strange > limit)[:, None], none, answered.held_out),
    )


def multiply(first: Answered, second: Answered, labels: IntArray, owners: IntArray) -> Answered:
    """Return the product of two calibrated answers; the second was tested in one condition.

    Two senses that err alike make the product too sure, so it has a temperature, which is fitted on
    held-out training sequences. `labels` and `owners` are of all sequences, shape (s,).
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
    # That all of n objects were right doesn't make the next one certain: the rule of succession.
    return float(1 / (len(np.unique(owners)) + 2))


def _log(probabilities: FloatArray) -> FloatArray:
    logs: FloatArray = np.log(np.maximum(probabilities, np.exp(LEAST_LOG_PROBABILITY)))
    return logs
