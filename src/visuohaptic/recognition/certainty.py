"""Compute how sure an answer is: prediction sets, and whether the object belongs to a known class.

Both compare a new object with the training objects. Each training object was classified by a model of the other folds,
which did not learn it (cross-conformal prediction: V. Vovk, "Cross-conformal predictors", Annals of Mathematics and
Artificial Intelligence 74, 2015). The final model learnt from all objects, so that the coverage is approximate.
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
from visuohaptic.recognition.voting import evenly_spaced_subsets

VIEWS = (1, 2, 4, 8, 16)
"""Numbers of views for which training objects are compared."""

FOLDS = 10
"""Folds of training objects, at most."""


@dataclass(frozen=True)
class Assessment:
    """How sure an answer is.

    Attributes
    ----------
    candidates : ndarray of shape (c,), bool
        The prediction set.
    novelty : float
        Distance of the object from the nearest training object, as computed by `Reference`.
    strangeness : float
        Share of the training objects with a lower novelty score, in [0, 1].
    unknown : bool
        Whether the strangeness is at least the stated coverage.
    """

    candidates: BoolArray
    novelty: float
    strangeness: float
    unknown: bool


@dataclass(frozen=True)
class Reference:
    """Training objects as points, in a space where views of one object differ by one unit in every direction.

    Distances there are Mahalanobis distances by the common covariance of views within objects.

    Attributes
    ----------
    whitening : ndarray of shape (d, d)
        Maps prepared descriptors to this space.
    centres : ndarray of shape (n, d)
        Mean of the views of each training object, in this space.
    """

    whitening: FloatArray
    centres: FloatArray

    def novelty(self, rows: FloatArray) -> float:
        """Compute the distance of an object, the mean of its prepared rows (v, d), from the nearest centre."""
        return float(self.distances(rows.mean(axis=0, keepdims=True))[0])

    def distances(self, rows: FloatArray) -> FloatArray:
        """Compute the distance of each prepared row from the nearest centre: (n, d) to (n,)."""
        nearest: FloatArray = cdist(rows @ self.whitening, self.centres).min(axis=1)
        return nearest


@dataclass(frozen=True)
class Certainty:
    """Held-out training objects, with which new objects are compared.

    Attributes
    ----------
    trained : ndarray of shape (t,)
        Classes with training objects.
    labels : ndarray of shape (n,)
        Class of each training object that was held out.
    views : ndarray of shape (k,)
        Numbers of views, ascending.
    nonconformity : ndarray of shape (k, n)
        1 minus the probability of the true class, from so many views of the object.
    novelty : ndarray of shape (k, n)
        Novelty score from so many views of the object.
    reference : Reference
        The training objects by the final model.
    """

    trained: IntArray
    labels: IntArray
    views: IntArray
    nonconformity: FloatArray
    novelty: FloatArray
    reference: Reference

    def assess(self, rows: FloatArray, logs: FloatArray, coverage: float) -> Assessment:
        """Compare an object with the training objects.

        Parameters
        ----------
        rows : ndarray of shape (v, d)
            Prepared descriptors of the object's views.
        logs : ndarray of shape (c,)
            Log probabilities of the object's classes.
        coverage : float
            Stated share of objects with their class in the prediction set, in (0, 1).
        """
        index = self._index(len(rows))
        score = self.reference.novelty(rows)
        stranger = 1 + int(np.sum(self.novelty[index] >= score))
        share = stranger / (1 + len(self.labels))
        return Assessment(
            self.prediction_set(logs, len(rows), coverage),
            score,
            1 - share,
            share <= _least_share(coverage),
        )

    def prediction_set(self, logs: FloatArray, views: int, coverage: float) -> BoolArray:
        """Return the classes whose conformal p value is above 1 - coverage: (c,) to (c,)."""
        is_trained = np.isin(np.arange(len(logs)), self.trained)
        return is_trained & (self.p_values(logs, views, coverage) > _least_share(coverage))

    def p_values(self, logs: FloatArray, views: int, coverage: float) -> FloatArray:
        """Compute the conformal p value of each class from log probabilities: (c,) to (c,).

        The p value is the share of training objects that fit their class no better than the new object fits the
        class; the new object counts as one of them. If a class has enough training objects for the coverage, only these
        are compared.
        """
        same = self.labels[:, None] == np.arange(len(logs))
        compared = same | (same.sum(axis=0) < least_objects(coverage))
        scores = self.nonconformity[self._index(views)][:, None]
        no_better = compared & (scores >= 1 - np.exp(logs))
        p_values: FloatArray = (1 + no_better.sum(axis=0)) / (1 + compared.sum(axis=0))
        return p_values

    def _index(self, views: int) -> int:
        """Return the index of `views`, or of the next smaller number."""
        return max(int(np.searchsorted(self.views, views, side="right")) - 1, 0)


def fit_certainty(
    fit: Callable[[FloatArray, IntArray, IntArray], Any],
    final: Any,
    rows: FloatArray,
    labels: IntArray,
    owners: IntArray,
    random_state: RandomState = 0,
    touched: BoolArray | None = None,
) -> Certainty | None:
    """Classify each training object by a model that was fitted without the object.

    Training objects that are the only one of their class, or have no sequence in `touched`, are left out.

    Parameters
    ----------
    fit : callable
        ``fit(rows, labels, owners)`` returns a fitted scikit-learn pipeline with a classifier as the last step.
    final : Pipeline
        Pipeline that was fitted on all training sequences.
    rows : ndarray of shape (s, d)
        Descriptors of the training sequences.
    labels, owners : ndarray of shape (s,)
        Class (index from 0) and object of each training sequence.
    random_state : int, Generator or None
        Draws the folds.
    touched : ndarray of shape (s,), bool, optional
        Sequences of the strategy that touches the new objects, without it all sequences. The models of the folds
        learn from all strategies.

    Returns
    -------
    Certainty or None
        None if every class has only one training object.
    """
    if touched is None:
        touched = np.ones(len(rows), dtype=bool)
    divided = held_out_folds(labels, owners, FOLDS, random_state)
    folds = [(train, held_out[touched[held_out]]) for train, held_out in divided]
    folds = [fold for fold in folds if touched[fold[0]].any() and len(fold[1])]
    if not folds:
        return None
    objects, first = np.unique(owners[touched], return_index=True)
    of_object = labels[touched][first]
    nonconformity = np.zeros((len(VIEWS), len(objects)))
    novelty = np.zeros_like(nonconformity)
    for train, held_out in folds:
        model = fit(rows[train], labels[train], owners[train])
        prepared = model[:-1].transform(rows[held_out])
        logs = log_probabilities(model[-1], prepared, int(labels.max()) + 1)
        known = train[touched[train]]
        reference = fit_reference(model[:-1].transform(rows[known]), owners[known])
        for owner in np.unique(owners[held_out]):
            index = int(np.searchsorted(objects, owner))
            views_of_object = np.flatnonzero(owners[held_out] == owner)
            for number, chosen in enumerate(_views_of(len(views_of_object), index)):
                pooled = pooled_log_probabilities(logs[views_of_object], chosen[None])[0]
                nonconformity[number, index] = 1 - np.exp(pooled[of_object[index]])
                novelty[number, index] = reference.novelty(prepared[views_of_object][chosen])
    reference = fit_reference(final[:-1].transform(rows[touched]), owners[touched])
    compared = np.isin(objects, owners[np.concatenate([held_out for _, held_out in folds])])
    return Certainty(
        np.unique(labels),
        of_object[compared],
        np.array(VIEWS),
        nonconformity[:, compared],
        novelty[:, compared],
        reference,
    )


def fit_reference(rows: FloatArray, owners: IntArray) -> Reference:
    """Fit the reference from prepared descriptors (s, d) of the training objects `owners` (s,).

    If every object has one view, there is no covariance within objects, and distances are Euclidean.
    """
    _, index = np.unique(owners, return_inverse=True)
    means = np.stack([rows[index == number].mean(axis=0) for number in range(index.max() + 1)])
    deviations = rows - means[index]
    whitening = np.eye(rows.shape[1])
    if deviations.any():
        fitted = LedoitWolf(assume_centered=True).fit(deviations)
        whitening = np.linalg.inv(np.linalg.cholesky(fitted.covariance_)).T
    return Reference(whitening, means @ whitening)


def _views_of(total: int, turn: int) -> Sequence[BoolArray]:
    """Return one evenly spaced group of views, a mask (total,), per number of views; `turn` selects the group."""
    chosen = []
    for count in VIEWS:
        groups = evenly_spaced_subsets(total, min(count, total))
        chosen.append(np.isin(np.arange(total), groups[turn % len(groups)]))
    return chosen


def _least_share(coverage: float) -> float:
    return 1 - coverage + 1e-12  # one rounding error above
