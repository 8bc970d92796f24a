"""Compute the prediction set of a classified object, and whether the object belongs to a known class.

Both compare scores of the new object with scores of the training objects. The scores of a training object are from a
model that was fitted without the fold of the object (cross-conformal prediction: V. Vovk, "Cross-conformal
predictors", Annals of Mathematics and Artificial Intelligence 74, 2015). The scores of a new object are from the final
model, which was fitted on all training objects, so the coverage is approximate.

A view is one sequence of touches. Prepared descriptors are the output of all steps of the model before its classifier.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial.distance import cdist
from sklearn.covariance import LedoitWolf

from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.recognition.parameters import least_objects
from visuohaptic.recognition.pipelines import log_probabilities, pooled_log_probabilities
from visuohaptic.recognition.splits import RandomState, held_out_folds
from visuohaptic.recognition.touch_network import descriptors_of
from visuohaptic.recognition.voting import evenly_spaced_subsets

VIEW_COUNTS = (1, 2, 4, 8, 16)
"""Numbers of views from which the scores of the training objects are computed."""

FOLDS = 10
"""Default of the maximum number of folds of the training objects."""


@dataclass(frozen=True)
class Assessment:
    """Comparison of a classified object with the training objects.

    Attributes
    ----------
    candidates : ndarray of shape (c,), bool
        The prediction set: True for each class in the set.
    novelty : float
        Distance of the object from the nearest training object, by `Reference.novelty`.
    novelty_rank : float
        Share of objects with a lower novelty, among the n training objects and the new object: in [0, n / (n + 1)].
    unknown : bool
        Whether `novelty_rank` is at least the stated coverage.
    """

    candidates: BoolArray
    novelty: float
    novelty_rank: float
    unknown: bool


@dataclass(frozen=True)
class Reference:
    """Centres of the training objects in whitened space, where distances are Mahalanobis distances.

    The covariance of the distances is that of views around the centre of their object, pooled over all objects.

    Attributes
    ----------
    whitening : ndarray of shape (d, d)
        Maps prepared descriptors to whitened space: ``rows @ whitening``.
    centres : ndarray of shape (o, d)
        Mean of the views of each training object, in whitened space.
    """

    whitening: FloatArray
    centres: FloatArray

    def novelty(self, rows: FloatArray) -> float:
        """Compute the distance from the nearest centre to the mean of an object's prepared descriptors (v, d)."""
        return float(self.distances(rows.mean(axis=0, keepdims=True))[0])

    def distances(self, rows: FloatArray) -> FloatArray:
        """Compute the distance of each row of prepared descriptors from its nearest centre: (v, d) to (v,)."""
        nearest: FloatArray = cdist(rows @ self.whitening, self.centres).min(axis=1)
        return nearest


@dataclass(frozen=True)
class Certainty:
    """Scores of the held-out training objects, with which new objects are compared.

    Attributes
    ----------
    trained : ndarray of shape (t,)
        Indices of the classes with training objects, ascending. Other classes are never in a prediction set.
    labels : ndarray of shape (n,)
        Class index of each held-out training object.
    views : ndarray of shape (k,)
        Numbers of views, ascending.
    nonconformity : ndarray of shape (k, n)
        1 minus the probability of the true class, per number of views. An object with fewer views has the score from
        all its views.
    novelty : ndarray of shape (k, n)
        Distance from the nearest training object outside the fold of the object, by `Reference.novelty`, per number of
        views.
    reference : Reference
        All training objects, prepared by the final model.
    """

    trained: IntArray
    labels: IntArray
    views: IntArray
    nonconformity: FloatArray
    novelty: FloatArray
    reference: Reference

    def assess(self, rows: FloatArray, logs: FloatArray, coverage: float) -> Assessment:
        """Compare a new object with the training objects.

        Parameters
        ----------
        rows : ndarray of shape (v, d)
            Prepared descriptors of the object's v views, by the final model.
        logs : ndarray of shape (c,)
            Log probability of each class, by the final model from all views of the object. Element i is class index i.
        coverage : float
            Stated share of objects with their class in the prediction set, in (0, 1).

        Returns
        -------
        Assessment
            By the scores of the training objects from v views, or from the next smaller number in `views`.
        """
        index = self._index(len(rows))
        novelty = self.reference.novelty(rows)
        at_least_as_novel = 1 + int(np.sum(self.novelty[index] >= novelty))
        p_value = at_least_as_novel / (1 + len(self.labels))
        return Assessment(
            self.prediction_set(logs, len(rows), coverage),
            novelty,
            1 - p_value,
            p_value <= _significance_level(coverage),
        )

    def prediction_set(self, logs: FloatArray, views: int, coverage: float) -> BoolArray:
        """Return a mask of the trained classes with a conformal p value above 1 - coverage: (c,) to (c,).

        The parameters are those of `p_values`.
        """
        is_trained = np.isin(np.arange(len(logs)), self.trained)
        return is_trained & (self.p_values(logs, views, coverage) > _significance_level(coverage))

    def p_values(self, logs: FloatArray, views: int, coverage: float) -> FloatArray:
        """Compute the conformal p value of each class for a new object.

        The p value is (1 + m) / (1 + n). n is the number of compared training objects. m is the number of those with a
        probability of their true class that is at most the probability of this class for the new object.

        Parameters
        ----------
        logs : ndarray of shape (c,)
            Log probability of each class for the new object. Element i is class index i.
        views : int
            Number of views from which `logs` were computed.
        coverage : float
            Stated coverage. A class with `least_objects` training objects or more is compared with these only. Other
            classes are compared with all training objects.

        Returns
        -------
        ndarray of shape (c,)
        """
        same = self.labels[:, None] == np.arange(len(logs))
        compared = same | (same.sum(axis=0) < least_objects(coverage))
        scores = self.nonconformity[self._index(views)][:, None]
        no_better = compared & (scores >= 1 - np.exp(logs))
        p_values: FloatArray = (1 + no_better.sum(axis=0)) / (1 + compared.sum(axis=0))
        return p_values

    def _index(self, views: int) -> int:
        """Return the index in `self.views` of a number of views, or of the next smaller number."""
        return max(int(np.searchsorted(self.views, views, side="right")) - 1, 0)


def fit_certainty(
    fit: Callable[[FloatArray, IntArray, IntArray], Any],
    final: Any,
    rows: FloatArray,
    labels: IntArray,
    owners: IntArray,
    random_state: RandomState = 0,
    same_strategy: BoolArray | None = None,
    folds: int = FOLDS,
) -> Certainty | None:
    """Compute the nonconformity and novelty of each training object by a model that was fitted without the object.

    Both are computed per number of views. Nonconformity is 1 minus the probability of the object's class; novelty is
    `Reference.novelty`. Training objects that are the only object of their class, or have no sequence in `same_strategy`,
    get no scores. They still train the models.

    Parameters
    ----------
    fit : callable
        ``fit(rows, labels, owners)`` returns a fitted scikit-learn pipeline with a classifier as the last step.
    final : Pipeline
        Pipeline that was fitted on all training sequences.
    rows : ndarray of shape (s, d), or (s,) with fields
        Rows of a pipeline for the training sequences, not prepared.
    labels, owners : ndarray of shape (s,)
        Class (index from 0) and object (integer) of each training sequence.
    random_state : int, Generator or None
        Draws the folds.
    same_strategy : ndarray of shape (s,), bool, optional
        Sequences of the strategy by which new objects will be touched; None for all sequences. Scores are computed
        only from these sequences. The models are fitted on the sequences of all strategies.
    folds : int
        Maximum number of folds of the training objects.

    Returns
    -------
    Certainty or None
        None if no training object has scores, for example if every class has only one object.
    """
    if same_strategy is None:
        same_strategy = np.ones(len(rows), dtype=bool)
    divided = held_out_folds(labels, owners, folds, random_state)
    parts = [(train, held_out[same_strategy[held_out]]) for train, held_out in divided]
    parts = [part for part in parts if same_strategy[part[0]].any() and len(part[1])]
    if not parts:
        return None
    objects, first = np.unique(owners[same_strategy], return_index=True)
    class_of_object = labels[same_strategy][first]
    nonconformity = np.zeros((len(VIEW_COUNTS), len(objects)))
    novelty = np.zeros_like(nonconformity)
    for train, held_out in parts:
        model = fit(rows[train], labels[train], owners[train])
        prepared = model[:-1].transform(rows[held_out])
        descriptors = descriptors_of(prepared)
        logs = log_probabilities(model[-1], prepared, int(labels.max()) + 1)
        reference_rows = train[same_strategy[train]]
        without_held_out = fit_reference(
            descriptors_of(model[:-1].transform(rows[reference_rows])), owners[reference_rows]
        )
        for owner in np.unique(owners[held_out]):
            index = int(np.searchsorted(objects, owner))
            views_of_object = np.flatnonzero(owners[held_out] == owner)
            for row, chosen in enumerate(_view_masks(len(views_of_object), index)):
                pooled = pooled_log_probabilities(logs[views_of_object], chosen[None])[0]
                nonconformity[row, index] = 1 - np.exp(pooled[class_of_object[index]])
                novelty[row, index] = without_held_out.novelty(descriptors[views_of_object][chosen])
    reference = fit_reference(
        descriptors_of(final[:-1].transform(rows[same_strategy])), owners[same_strategy]
    )
    has_scores = np.isin(objects, owners[np.concatenate([held_out for _, held_out in parts])])
    return Certainty(
        np.unique(labels),
        class_of_object[has_scores],
        np.array(VIEW_COUNTS),
        nonconformity[:, has_scores],
        novelty[:, has_scores],
        reference,
    )


def fit_reference(rows: FloatArray, owners: IntArray) -> Reference:
    """Fit whitening and centres.

    The covariance of views around the centre of their object is shrunk by the method of Ledoit and Wolf. If every
    object has only one view, `whitening` is the identity, and distances are Euclidean.

    Parameters
    ----------
    rows : ndarray of shape (s, d)
        Prepared descriptors of the training sequences.
    owners : ndarray of shape (s,)
        Object of each sequence. `Reference.centres` are in ascending order of these.
    """
    _, index = np.unique(owners, return_inverse=True)
    means = np.stack([rows[index == number].mean(axis=0) for number in range(index.max() + 1)])
    deviations = rows - means[index]
    whitening = np.eye(rows.shape[1])
    if deviations.any():
        fitted = LedoitWolf(assume_centered=True).fit(deviations)
        whitening = np.linalg.inv(np.linalg.cholesky(fitted.covariance_)).T
    return Reference(whitening, means @ whitening)


def _view_masks(total: int, turn: int) -> Sequence[BoolArray]:
    """Return a mask (total,) of evenly spaced views per entry of `VIEW_COUNTS`; `turn` selects the first view."""
    masks = []
    for count in VIEW_COUNTS:
        subsets = evenly_spaced_subsets(total, min(count, total))
        masks.append(np.isin(np.arange(total), subsets[turn % len(subsets)]))
    return masks


def _significance_level(coverage: float) -> float:
    """Return the largest p value that is rejected: 1 - coverage, plus a margin for rounding."""
    return 1 - coverage + 1e-12
