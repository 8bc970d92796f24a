"""What a sense answers in every split, tested and held out, and one answer of two senses."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.errors import RecognitionError
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.recognition.classifiers import fit_classifier
from visuohaptic.recognition.experiment import fitting
from visuohaptic.recognition.memory import REMEMBERED_SEQUENCES, FitMemory
from visuohaptic.recognition.pooling import LEAST_SCORE, best_temperature, softmax
from visuohaptic.recognition.tuning import fit_best_classifiers, make_inner_folds

if TYPE_CHECKING:
    from visuohaptic.recognition.parameters import RecognitionParameters
    from visuohaptic.recognition.sequences import TouchSequences
    from visuohaptic.recognition.splits import Split
    from visuohaptic.recognition.tuning import InnerFold, Projection, TunedClassifier

FAMILIAR = 0.95
"""Share of held-out training views that count as familiar."""

Trial = tuple["Split", int]
"""A split and its repeat, as `recognition.experiment.draw_splits` gives them."""

Descriptors = NDArray[np.floating]


@dataclass(frozen=True)
class Answered:
    """Class probabilities of one split, and how strange each sequence is: how far from what was learnt.

    `tested` (k, n, c) are of the n test sequences in each of k conditions of the test; `held_out` (m, c)
    of the training sequences `places` (m,), by models that learnt from other objects.
    """

    tested: NDArray[np.float64]
    held_out: NDArray[np.float64]
    places: NDArray[np.int64]
    strange: NDArray[np.float64]
    held_out_strange: NDArray[np.float64]


def answer_trials(
    trials: Sequence[Trial],
    described: Iterable[Sequence[Descriptors]],
    sequences: TouchSequences,
    parameters: RecognitionParameters,
    seed: int,
) -> list[Answered]:
    """Train and test pipeline `best` with its first classifier in every trial, by recognition's own draws.

    `described` holds for each trial the descriptors of all s sequences, (s, d), in each condition of the
    test; the first is learnt. Raises `RecognitionError` if no training object can be held out.
    """
    memory = FitMemory(REMEMBERED_SEQUENCES)
    with fitting():
        return [
            _answer_trial(trial, own, sequences, parameters, seed, memory)
            for trial, own in zip(trials, described, strict=True)
        ]


def _answer_trial(
    trial: Trial,
    described: Sequence[Descriptors],
    sequences: TouchSequences,
    parameters: RecognitionParameters,
    seed: int,
    memory: FitMemory,
) -> Answered:
    split, repeat = trial
    draws = partial(spawn_generator, seed, "recognition", "best", repeat, split.number)
    training = np.asarray(described[0][split.train], dtype=np.float64)
    labels, owners = sequences.labels[split.train], sequences.object_index[split.train]
    learnt = (training, labels, owners)
    projection, fits = fit_best_classifiers(
        *learnt, len(sequences.classes), parameters, draws(), memory
    )
    name, classifier, _ = fits[0]
    # The first draws are those of the folds, so these are the same folds.
    folds = make_inner_folds(*learnt, parameters.best, draws(), memory)
    if not folds:
        raise RecognitionError(
            "Every class has one training object; two are needed to know how sure answers are."
        )
    tests = [one[split.test].astype(np.float64) for one in described]
    members = [np.isin(owners, fold.held_out_owners) for fold in folds]
    strange = [
        strangeness(fold.fits.projection, training[member])
        for fold, member in zip(folds, members, strict=True)
    ]
    return Answered(
        np.stack([classifier.ballots(projection.apply(one)).alone() for one in tests]),
        np.concatenate([_without(name, classifier, fold, draws()) for fold in folds]),
        np.concatenate([split.train[member] for member in members]),
        np.stack([strangeness(projection, one) for one in tests]),
        np.concatenate(strange),
    )


def _without(
    name: str, classifier: TunedClassifier, fold: InnerFold, generator: np.random.Generator
) -> NDArray[np.float64]:
    """Give the answers for a fold's held-out sequences, (m, c), by what learnt from the others."""
    fits = fold.fits
    fitted, _ = fit_classifier(name, classifier.parameters, fits.train, fits.labels, generator)
    bags = None if classifier.bags is None else fits.bags
    return replace(classifier, estimator=fitted, bags=bags).ballots(fold.projected).alone()


def strangeness(projection: Projection, described: NDArray[np.float64]) -> NDArray[np.float64]:
    """Give how far descriptors (n, d) are from the space that the training ones span: (n,).

    The squared distance after scaling: what principal components do not reconstruct.
    """
    scaled = projection.scaling.apply(described)
    kept = scaled @ projection.components
    return np.einsum("nd,nd->n", scaled, scaled) - np.einsum("nq,nq->n", kept, kept)


def ask_if_familiar(answered: Answered) -> Answered:
    """Take any class for equally likely where a sequence is stranger than `FAMILIAR` of those held out."""
    limit = np.quantile(answered.held_out_strange, FAMILIAR)
    none = 1 / answered.tested.shape[2]
    return replace(
        answered,
        tested=np.where((answered.strange > limit)[..., None], none, answered.tested),
        held_out=np.where((answered.held_out_strange > limit)[:, None], none, answered.held_out),
    )


def multiply(
    first: Answered, second: Answered, labels: NDArray[np.int64], owners: NDArray[np.int64]
) -> Answered:
    """Take the product of two calibrated answers, of which the second was tested in one condition.

    Two senses that err alike make the product too sure, so it has a temperature, which is fitted on
    held-out training sequences. `labels` and `owners` are of all sequences, shape (s,).
    """
    held_out = _log(first.held_out) + _log(second.held_out)
    tested = _log(first.tested) + _log(second.tested)
    # That all of n objects were right doesn't make the next one certain: the rule of succession.
    doubt = 1 / (len(np.unique(owners[first.places])) + 2)
    _, temperature = best_temperature(held_out, labels[first.places], doubt)
    return replace(
        first, tested=softmax(tested / temperature), held_out=softmax(held_out / temperature)
    )


def _log(probabilities: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.log(np.maximum(probabilities, np.exp(LEAST_SCORE)))
