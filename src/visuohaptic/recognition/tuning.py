"""Pipeline `best`: projection, settings and probabilities, all chosen inside the training objects."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.base.errors import RecognitionError
from visuohaptic.recognition.classifier_parameters import ClassifierParameters
from visuohaptic.recognition.classifiers import (
    CLASSIFIERS,
    ClassifierName,
    draw_seed,
    fit_classifier,
    fit_each,
)
from visuohaptic.recognition.encoding import Standardiser, fit_standardiser
from visuohaptic.recognition.memory import REMEMBERED_SEQUENCES, FitMemory
from visuohaptic.recognition.parameters import BestParameters, RecognitionParameters
from visuohaptic.recognition.pooling import (
    BAG_WEIGHT,
    LEAST_SCORE,
    BagClassifier,
    Ballots,
    Combination,
    best_temperature,
    fit_bag_classifier,
    fit_combination,
    softmax,
)
from visuohaptic.recognition.splits import hold_out_objects

logger = logging.getLogger(__name__)

BAG_COMPONENTS = 256
"""Principal components that the classifier of bags sees, at most: more than the others, as its covariance is shrunk."""

INNER_FOLDS = 2
"""Folds of training objects that choose settings and temperature: the paper's set leaves two of a class to train on."""


@dataclass(frozen=True)
class Projection:
    """Standardised descriptors, projected on principal components: orthonormal columns (d, q)."""

    scaling: Standardiser
    components: FloatArray

    def apply(self, descriptors: FloatArray) -> FloatArray:
        """Project descriptors: (n, d) to (n, q)."""
        return self.scaling.apply(descriptors) @ self.components


@dataclass(frozen=True)
class TunedClassifier:
    """A classifier, fitted on all training sequences, that gives probabilities of c classes.

    Its scores are divided by `temperature` before they become probabilities. `setting` says what
    was chosen, such as ``svm_penalty 10``. Where `bags`, a classifier of bags, answers beside it,
    `combination` says how both answers become one.
    """

    estimator: Any
    parameters: ClassifierParameters
    temperature: float
    classes: int
    setting: str
    bags: BagClassifier | None = None
    combination: Combination | None = None

    @property
    def trained(self) -> IntArray:
        """The classes that training had."""
        return self.estimator.classes_

    def scores(self, projected: FloatArray) -> FloatArray:
        """Give the classifier's scores, (n, p) to (n, c)."""
        seen = projected[:, : self.estimator.n_features_in_]
        return class_scores(self.estimator, seen, self.classes)

    def ballots(self, projected: FloatArray) -> Ballots:
        """Give what is known of n sequences, (n, p), for one answer for any of them together."""
        found = softmax(self.scores(projected) / self.temperature)
        if self.bags is None:
            return Ballots(found)
        return Ballots(found, self.bags.scores(projected, self.classes), self.combination)


@dataclass(frozen=True)
class FoldFits:
    """What was fitted on training sequences: `train` (n, q), projected, of classes `labels` (n,).

    The projection has as many components as `bags` sees, the classifier of bags; the others see the
    first of them.
    """

    projection: Projection
    train: FloatArray
    labels: IntArray
    bags: BagClassifier | None = None
    classifiers: dict[tuple[ClassifierName, ClassifierParameters], Any] = field(
        default_factory=dict
    )


@dataclass(frozen=True)
class InnerFold:
    """Fits on training sequences without some objects, and these objects' sequences, (m, p)."""

    fits: FoldFits
    projected: FloatArray
    held_out_labels: IntArray
    held_out_owners: IntArray

    @property
    def held_out(self) -> FloatArray:
        """What classifiers see of the held-out sequences, (m, q)."""
        return self.projected[:, : self.fits.train.shape[1]]


def fit_projection(descriptors: FloatArray, components: int) -> Projection:
    """Fit scaling and at most so many principal components of training descriptors (n, d)."""
    scaling = fit_standardiser(descriptors, "standardise")
    spread, directions = _principal_directions(scaling.apply(descriptors))
    rank = max(int(np.sum(spread > 1e-7 * max(spread[0], 1e-300))), 1)
    kept = directions[: min(components, rank)]
    # The signs are arbitrary; make the largest loading positive.
    largest = np.argmax(np.abs(kept), axis=1)
    signs = np.sign(kept[np.arange(len(kept)), largest])
    return Projection(scaling, np.ascontiguousarray((kept * signs[:, None]).T))


def fit_shared(
    descriptors: FloatArray, labels: IntArray, owners: IntArray, parameters: BestParameters
) -> FoldFits:
    """Fit what all classifiers share on training descriptors (n, d) of classes and objects (n,).

    There is no classifier of bags where none are wanted or no covariance can be taken of them.
    """
    most = max(parameters.components, BAG_COMPONENTS if parameters.bags else 0)
    projection, bags = fit_projection(descriptors, most), None
    projected = projection.apply(descriptors)
    if parameters.bags:
        try:
            bags = fit_bag_classifier(projected, labels, owners, parameters.bags)
        except RecognitionError as error:
            logger.warning("the classifier of bags is left out: %s", error)
    seen = np.ascontiguousarray(projected[:, : parameters.components])
    return FoldFits(projection, seen, labels, bags)


def _principal_directions(rows: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Give singular values, descending, and right singular vectors as rows, of (n, d)."""
    if len(rows) < rows.shape[1]:
        return _directions_of_few(rows)
    # Several times faster for many rows, and exact enough to drop what is empty.
    squares, vectors = np.linalg.eigh(rows.T @ rows)
    return np.sqrt(np.maximum(squares[::-1], 0)), vectors[:, ::-1].T


def _directions_of_few(rows: FloatArray) -> tuple[FloatArray, FloatArray]:
    # By the Gram matrix, where rounding can't be taken for spread.
    squares, vectors = np.linalg.eigh(rows @ rows.T)
    spread = np.sqrt(np.maximum(squares[::-1], 0))
    clear = spread > 1e-4 * spread[0]
    if clear.sum() < np.sum(spread > 3e-7 * spread[0]):
        _, spread, directions = np.linalg.svd(rows, full_matrices=False)
        return spread, directions
    directions = vectors[:, ::-1].T @ rows
    directions[clear] /= spread[clear, None]
    spread[~clear] = 0.0
    return spread, directions


def make_inner_folds(
    descriptors: FloatArray,
    labels: IntArray,
    owners: IntArray,
    parameters: BestParameters,
    generator: np.random.Generator,
    memory: FitMemory | None = None,
) -> list[InnerFold]:
    """Hold out folds of whole training objects, as `hold_out_objects` does.

    `descriptors` are (n, d), `labels` and `owners` (n,) class and object of each. `memory` holds
    fits of other splits and changes no number.
    """
    memory = memory or FitMemory(REMEMBERED_SEQUENCES)
    settings = (parameters.components, parameters.bags)
    folds = []
    for train, objects in hold_out_objects(labels, owners, INNER_FOLDS, generator):
        learnt = (descriptors[train], labels[train], owners[train])
        # With three objects a class, most inner folds of the 81 splits are those of another split.
        fits = memory.recall(
            (*learnt, settings), partial(fit_shared, *learnt, parameters), len(learnt[1])
        )
        tested = np.isin(owners, objects)
        projected = fits.projection.apply(descriptors[tested])
        folds.append(InnerFold(fits, projected, labels[tested], owners[tested]))
    return folds


def fit_tuned_classifier(
    name: ClassifierName,
    parameters: RecognitionParameters,
    fits: FoldFits,
    folds: Sequence[InnerFold],
    classes: int,
    generator: np.random.Generator,
) -> tuple[TunedClassifier, str | None]:
    """Choose a classifier's setting and temperature by the inner folds, then fit it.

    Also gives a note on what it needed. The setting with the least log loss over the held-out
    sequences wins, each at its own best temperature (C. Guo et al., "On calibration of modern
    neural networks", ICML 2017); the simplest where there is no inner fold. `fits` are those on all
    training sequences; `classes` counts also those that training lacks.
    """
    from sklearn.model_selection import ParameterGrid

    fixed = parameters.classifier.model_copy(
        update={"discriminant_target": "mean_variance", "discriminant_regularisation": "always"}
    )
    labels = [fold.held_out_labels for fold in folds]
    trials = []
    for setting in ParameterGrid(dict(CLASSIFIERS[name].grid)):
        tried = fixed.model_copy(update=setting)
        found = [
            class_scores(_fit_in_fold(name, tried, fold.fits, generator), fold.held_out, classes)
            for fold in folds
        ]
        scores = np.concatenate([np.zeros((0, classes)), *found])
        loss, temperature = (0.0, 1.0)
        if folds:
            loss, temperature = best_temperature(scores, np.concatenate(labels))
        trials.append((loss, temperature, setting, scores))
    _, temperature, setting, scores = min(trials, key=lambda trial: trial[0])
    chosen = fixed.model_copy(update=setting)
    fitted, note = fit_classifier(name, chosen, fits.train, fits.labels, generator)
    words = ", ".join(f"{key} {value}" for key, value in setting.items())
    combination = None
    if fits.bags is not None:
        known = np.isin(np.arange(classes), fits.labels)
        combination = _combine(softmax(scores / temperature), folds, known, parameters.best)
    return TunedClassifier(
        fitted, chosen, temperature, classes, words, fits.bags, combination
    ), note


def fit_best_classifiers(
    descriptors: FloatArray,
    labels: IntArray,
    owners: IntArray,
    classes: int,
    parameters: RecognitionParameters,
    generator: np.random.Generator,
    memory: FitMemory | None = None,
) -> tuple[Projection, list[tuple[ClassifierName, TunedClassifier, str | None]]]:
    """Fit the projection and every classifier of pipeline `best`.

    `descriptors` (n, d), `labels` and `owners` (n,) are of the training sequences; `classes` counts
    also those that training lacks. `memory` holds fits of other splits and changes no number. Gives
    the name, the fit and the note of each classifier that can be fitted. Raises `RecognitionError`
    if there is none, or no descriptor varies.
    """
    if not np.ptp(descriptors, axis=0).any():
        raise RecognitionError(
            "Every descriptor has one and the same value for all training sequences; "
            "the classes can't be distinguished."
        )
    folds = make_inner_folds(descriptors, labels, owners, parameters.best, generator, memory)
    fits = fit_shared(descriptors, labels, owners, parameters.best)
    found = fit_each(
        parameters.best.classifiers,
        lambda name: fit_tuned_classifier(name, parameters, fits, folds, classes, generator),
    )
    return fits.projection, [(name, fitted, note) for name, (fitted, note) in found]


def class_scores(estimator: Any, projected: FloatArray, classes: int) -> FloatArray:
    """Give a finite score a class, (n, q) to (n, c), `LEAST_SCORE` to one that training lacked."""
    if hasattr(estimator, "predict_log_proba"):
        with np.errstate(divide="ignore"):  # a tree's leaf may hold a single class
            found = np.maximum(estimator.predict_log_proba(projected), LEAST_SCORE)
    elif hasattr(estimator, "predict_proba"):
        found = np.log(np.maximum(estimator.predict_proba(projected), np.exp(LEAST_SCORE)))
    else:
        found = estimator.decision_function(projected)
    if found.ndim == 1:
        found = np.column_stack([-found, found])
    scores = np.full((len(projected), classes), LEAST_SCORE)
    scores[:, estimator.classes_] = found
    return scores


def _combine(
    probabilities: FloatArray, folds: Sequence[InnerFold], known: BoolArray, best: BestParameters
) -> Combination:
    """Combine with the folds' classifiers of bags; where one is missing, without held-out sequences."""
    scored = [(fold, fold.fits.bags) for fold in folds if fold.fits.bags is not None]
    if not scored or len(scored) < len(folds):
        return Combination((1.0, 1.0 / BAG_WEIGHT), np.ones(1), np.ones(1), known)
    return fit_combination(
        probabilities,
        np.concatenate([bags.scores(fold.projected, len(known)) for fold, bags in scored]),
        np.concatenate([fold.held_out_labels for fold in folds]),
        np.concatenate([fold.held_out_owners for fold in folds]),
        known,
        best,
    )


def _fit_in_fold(
    name: ClassifierName,
    parameters: ClassifierParameters,
    fits: FoldFits,
    generator: np.random.Generator,
) -> Any:
    if (name, parameters) in fits.classifiers:
        # Keep the random generator in the same state as after a fit.
        draw_seed(generator)
        return fits.classifiers[name, parameters]
    fitted, _ = fit_classifier(name, parameters, fits.train, fits.labels, generator)
    if CLASSIFIERS[name].deterministic:
        fits.classifiers[name, parameters] = fitted
    return fitted
