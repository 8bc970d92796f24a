"""Pipeline `best`: projection, settings and probabilities, all chosen inside the training objects."""

from __future__ import annotations

import hashlib
import itertools
import logging
from collections import OrderedDict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from visuohaptic.errors import RecognitionError
from visuohaptic.recognition.arrays import Flags, Floats, Integers
from visuohaptic.recognition.classifiers import (
    CLASSIFIERS,
    ClassifierName,
    ClassifierParameters,
    draw_seed,
    fit_classifier,
    fit_each,
)
from visuohaptic.recognition.encoding import Standardiser, fit_standardiser
from visuohaptic.recognition.parameters import BestParameters, RecognitionParameters
from visuohaptic.recognition.pooling import (
    LEAST_SCORE,
    BagClassifier,
    Ballots,
    Combination,
    HeldOutBags,
    best_temperature,
    fit_bag_classifier,
    hold_out_bags,
    softmax,
)
from visuohaptic.recognition.splits import hold_out_objects

logger = logging.getLogger(__name__)

REMEMBERED_SEQUENCES = 20_000
"""Training sequences of inner folds whose fits are kept: some 100 MB."""


@dataclass(frozen=True)
class Projection:
    """Standardised descriptors, projected on principal components: orthonormal columns (d, q)."""

    scaling: Standardiser
    components: Floats

    def apply(self, descriptors: Floats) -> Floats:
        """Project descriptors: (n, d) to (n, q)."""
        return self.scaling.apply(descriptors) @ self.components


@dataclass(frozen=True)
class TunedClassifier:
    """A classifier, fitted on all training sequences, that gives probabilities of c classes.

    Its scores are divided by `temperature` before they become probabilities; a class that training
    lacked has probability 0. `setting` says what was chosen, such as ``svm_penalty 10``. Where
    `bags`, a classifier of bags, answers beside it, `combination` says how both answers become one.
    """

    estimator: Any
    parameters: ClassifierParameters
    temperature: float
    classes: int
    setting: str
    bags: BagClassifier | None = None
    combination: Combination | None = None

    @property
    def trained(self) -> Integers:
        """The classes that training had."""
        return self.estimator.classes_

    def scores(self, projected: Floats) -> Floats:
        """Give the classifier's scores, (n, p) to (n, c); it takes the first columns."""
        seen = projected[:, : self.estimator.n_features_in_]
        return class_scores(self.estimator, seen, self.classes)

    def ballots(self, projected: Floats) -> Ballots:
        """Give what is known of n sequences, (n, p), for one answer for any of them together."""
        found = softmax(self.scores(projected) / self.temperature)
        if self.bags is None:
            return Ballots(found)
        return Ballots(found, self.bags.scores(projected, self.classes), self.combination)


@dataclass(frozen=True)
class FoldFits:
    """What was fitted on training sequences, and is the same for all classifiers.

    They are `train` (n, q), projected, of classes `labels` (n,). The projection has as many
    components as `bags` sees, the classifier of bags; the others see the first of them. Fitted
    classifiers are by name and settings.
    """

    projection: Projection
    train: Floats
    labels: Integers
    bags: BagClassifier | None = None
    classifiers: dict[tuple[ClassifierName, ClassifierParameters], Any] = field(
        default_factory=dict
    )


@dataclass(frozen=True)
class InnerFold:
    """Fits on training sequences without some objects, and these objects' projected sequences.

    `projected` has the shape (m, p) and holds `held_out`, (m, q), as its first columns.
    """

    fits: FoldFits
    projected: Floats
    held_out_labels: Integers
    held_out_owners: Integers

    @property
    def held_out(self) -> Floats:
        """What classifiers see of the held-out sequences, (m, q)."""
        return self.projected[:, : self.fits.train.shape[1]]


class FitMemory:
    """Fits by a hash of their training data, so that none is made twice.

    With three objects a class, most inner folds of the 81 splits train on the same objects as an
    inner fold of another split. The key is the training data itself, so a fit can't be confused
    with another. So many training sequences are remembered at once, over all folds; the oldest go
    first.
    """

    def __init__(self, sequences: int = REMEMBERED_SEQUENCES) -> None:
        self._most = sequences
        self._held: OrderedDict[bytes, FoldFits] = OrderedDict()

    def fits(
        self, descriptors: Floats, labels: Integers, owners: Integers, parameters: BestParameters
    ) -> FoldFits:
        """Give the fits on sequences, (n, d), (n,) and (n,); a projection is fitted where new."""
        settings = (parameters.components, parameters.bags, parameters.bag_components)
        key = _digest(descriptors, labels, owners, settings)
        if key not in self._held:
            self._held[key] = fit_shared(descriptors, labels, owners, parameters)
            while len(self._held) > 1 and self._remembered() > self._most:
                self._held.popitem(last=False)
        self._held.move_to_end(key)
        return self._held[key]

    def _remembered(self) -> int:
        return sum(len(fits.labels) for fits in self._held.values())


def fit_projection(descriptors: Floats, components: int) -> Projection:
    """Fit scaling and principal components of training descriptors (n, d), float64.

    There are at most `components`; directions without variance are left out.
    """
    scaling = fit_standardiser(descriptors, "standardise")
    spread, directions = _principal_directions(scaling.apply(descriptors))
    rank = max(int(np.sum(spread > 1e-7 * max(spread[0], 1e-300))), 1)
    kept = directions[: min(components, rank)]
    # The signs are arbitrary; make the largest loading positive.
    largest = np.argmax(np.abs(kept), axis=1)
    signs = np.sign(kept[np.arange(len(kept)), largest])
    return Projection(scaling, np.ascontiguousarray((kept * signs[:, None]).T))


def fit_shared(
    descriptors: Floats, labels: Integers, owners: Integers, parameters: BestParameters
) -> FoldFits:
    """Fit what all classifiers share on training descriptors (n, d) of classes and objects (n,).

    There is no classifier of bags where none are wanted or no covariance can be taken of them.
    """
    most = max(parameters.components, parameters.bag_components if parameters.bags else 0)
    projection, bags = fit_projection(descriptors, most), None
    projected = projection.apply(descriptors)
    if parameters.bags:
        try:
            bags = fit_bag_classifier(projected, labels, owners, parameters.bags)
        except RecognitionError as error:
            logger.warning("the classifier of bags is left out: %s", error)
    seen = np.ascontiguousarray(projected[:, : parameters.components])
    return FoldFits(projection, seen, labels, bags)


def _principal_directions(rows: Floats) -> tuple[Floats, Floats]:
    """Give singular values, descending, and right singular vectors as rows, of (n, d)."""
    if len(rows) < rows.shape[1]:
        return _directions_of_few(rows)
    # Several times faster for many rows, and exact enough to drop what is empty.
    squares, vectors = np.linalg.eigh(rows.T @ rows)
    return np.sqrt(np.maximum(squares[::-1], 0)), vectors[:, ::-1].T


def _directions_of_few(rows: Floats) -> tuple[Floats, Floats]:
    """Give the same of fewer rows than columns: by the Gram matrix, where rounding can't be taken for spread."""
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
    descriptors: Floats,
    labels: Integers,
    owners: Integers,
    parameters: BestParameters,
    generator: np.random.Generator,
    memory: FitMemory | None = None,
) -> list[InnerFold]:
    """Hold out folds of whole training objects, each with a projection of the others.

    There is none where every class has a single training object. A held-out sequence whose class
    the fold's training lacks is left out. `descriptors` are (n, d), `labels` and `owners` (n,)
    class and object of each. `memory` holds fits of other splits of the same run; it changes no
    number.
    """
    memory = memory or FitMemory()
    folds = []
    for train, objects in hold_out_objects(labels, owners, parameters.inner_folds, generator):
        fits = memory.fits(descriptors[train], labels[train], owners[train], parameters)
        tested = np.isin(owners, objects)
        projected = fits.projection.apply(descriptors[tested])
        folds.append(InnerFold(fits, projected, labels[tested], owners[tested]))
    return folds


def fit_tuned_classifier(
    name: ClassifierName,
    parameters: ClassifierParameters,
    fits: FoldFits,
    folds: Sequence[InnerFold],
    classes: int,
    generator: np.random.Generator,
    held_out: HeldOutBags | None = None,
) -> tuple[TunedClassifier, str | None]:
    """Choose a classifier's setting and temperature by the inner folds, then fit it.

    Also gives a note on what it needed. The setting with the least log loss over the held-out
    sequences wins, each at its own best temperature (C. Guo et al., "On calibration of modern
    neural networks", ICML 2017); the simpler one where two are equal, or where there is no inner
    fold. `parameters` hold what the grid does not vary; `classes` counts also those that training
    lacks. `fits` are those on all training sequences, whose classifier of bags answers beside this
    one, and `held_out` its answers of the inner folds.
    """
    parameters = parameters.model_copy(
        update={"discriminant_target": "mean_variance", "discriminant_regularisation": "always"}
    )
    trials = []
    for setting in _settings(name):
        tried = parameters.model_copy(update=setting)
        scores, labels = _held_out_scores(name, tried, folds, classes, generator)
        loss, temperature = best_temperature(scores, labels) if folds else (0.0, 1.0)
        trials.append((loss, temperature, setting, scores))
    _, temperature, setting, scores = min(trials, key=lambda trial: trial[0])
    chosen = parameters.model_copy(update=setting)
    fitted, note = fit_classifier(name, chosen, fits.train, fits.labels, generator)
    words = ", ".join(f"{key} {value}" for key, value in setting.items())
    combination = None
    if held_out is not None:
        combination = held_out.combine(softmax(scores / temperature))
    return TunedClassifier(
        fitted, chosen, temperature, classes, words, fits.bags, combination
    ), note


def fit_best_classifiers(
    descriptors: Floats,
    labels: Integers,
    owners: Integers,
    classes: int,
    parameters: RecognitionParameters,
    generator: np.random.Generator,
    memory: FitMemory | None = None,
) -> tuple[Projection, list[tuple[ClassifierName, TunedClassifier, str | None]]]:
    """Fit the projection and every classifier of pipeline `best`.

    `descriptors` (n, d) are those of the training sequences, and no others; `labels` and `owners`
    (n,) are their classes and objects; `classes` counts also those that training lacks. `memory`
    holds fits of other splits of the same run; it changes no number. Gives each classifier's name,
    its fit, and what it needed; without those that can't be fitted. Raises `RecognitionError` if no
    descriptor varies over the training sequences, or no classifier can be fitted.
    """
    if not np.ptp(descriptors, axis=0).any():
        raise RecognitionError(
            "Every descriptor has one and the same value for all training sequences; "
            "the classes can't be distinguished."
        )
    folds = make_inner_folds(descriptors, labels, owners, parameters.best, generator, memory)
    fits = fit_shared(descriptors, labels, owners, parameters.best)
    known = np.isin(np.arange(classes), labels)
    held_out = None if fits.bags is None else _hold_out_bags(folds, parameters.best, known)
    found = fit_each(
        parameters.best.classifiers,
        lambda name: fit_tuned_classifier(
            name, parameters.classifier, fits, folds, classes, generator, held_out
        ),
    )
    return fits.projection, [(name, fitted, note) for name, (fitted, note) in found]


def class_scores(estimator: Any, projected: Floats, classes: int) -> Floats:
    """Give a score a class, (n, q) to (n, c): log probabilities, or what a support vector machine has.

    `estimator` was fitted on int labels below `classes`; a class that it was not trained with has
    `LEAST_SCORE`. All are finite.
    """
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


def _held_out_scores(
    name: ClassifierName,
    parameters: ClassifierParameters,
    folds: Sequence[InnerFold],
    classes: int,
    generator: np.random.Generator,
) -> tuple[Floats, Integers]:
    """Give the scores (m, c) and classes (m,) of all held-out sequences."""
    scores = [np.zeros((0, classes))]
    labels = [np.zeros(0, dtype=np.int64)]
    for fold in folds:
        fitted = _fit_in_fold(name, parameters, fold.fits, generator)
        scores.append(class_scores(fitted, fold.held_out, classes))
        labels.append(fold.held_out_labels)
    return np.concatenate(scores), np.concatenate(labels)


def _hold_out_bags(folds: Sequence[InnerFold], best: BestParameters, known: Flags) -> HeldOutBags:
    """Score the held-out sequences of all folds, or none where a fold lacks a classifier of bags."""
    scored = [(fold, fold.fits.bags) for fold in folds if fold.fits.bags is not None]
    scores = [np.zeros((0, len(known)))]
    labels, owners = [np.zeros(0, dtype=np.int64)], [np.zeros(0, dtype=np.int64)]
    if len(scored) == len(folds):
        for fold, bags in scored:
            scores.append(bags.scores(fold.projected, len(known)))
            labels.append(fold.held_out_labels)
            owners.append(fold.held_out_owners)
    return hold_out_bags(
        np.concatenate(scores),
        np.concatenate(labels),
        np.concatenate(owners),
        best.bags,
        known,
        best.bag_weight,
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


def _digest(
    descriptors: Floats, labels: Integers, owners: Integers, settings: tuple[Any, ...]
) -> bytes:
    content = hashlib.blake2b(repr((descriptors.shape, settings)).encode())
    for array in (descriptors, labels, owners):
        content.update(np.ascontiguousarray(array).tobytes())
    return content.digest()


def _settings(name: ClassifierName) -> Iterator[dict[str, Any]]:
    grid = CLASSIFIERS[name].grid
    for values in itertools.product(*grid.values()):
        yield dict(zip(grid, values, strict=True))
