"""Classifiers that give every class a normal density: naive Bayes, and the discriminants.

They are a few sums and one decomposition each; a check of the arguments, as libraries do it at every
call, would take several times as long as the fit.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from visuohaptic.recognition.arrays import Floats, Integers
from visuohaptic.recognition.classifiers import ClassifierParameters, Fit
from visuohaptic.recognition.covariance import (
    check_spread,
    class_means,
    common_covariance,
    regularised_covariance,
    variance_floor,
)

LEAST_PLAIN_VARIANCE = 1e-4
"""A class that varies less than this in some direction has a covariance that counts as singular."""

Whitening = tuple[Floats, float]
"""Directions (d, d), by which deviations of one class get unit variances, and the log determinant of
its covariance."""


@dataclass(frozen=True)
class GaussianClassifier:
    """Classes with a normal density each.

    A deviation from one of `means` (k, d) times its `directions`, (k, d, d), or (1, d, d) for all,
    has the Mahalanobis distance as its length. `offsets` (k,) are logarithms of each class's share
    of the training rows, less half the logarithm of its covariance's determinant.
    """

    classes_: Integers
    means: Floats
    directions: Floats
    offsets: Floats

    @property
    def n_features_in_(self) -> int:
        """How many features a row has."""
        return self.means.shape[1]

    def decision_function(self, rows: Floats) -> Floats:
        """Give the logarithm of each class's density times its share, but for a constant: (n, d) to (n, k)."""
        deviations = (rows - self.means[:, None]) @ self.directions
        distances = np.einsum("knd,knd->nk", deviations, deviations)
        return self.offsets - distances / 2

    def predict_log_proba(self, rows: Floats) -> Floats:
        """Give the logarithm of each class's probability: (n, d) to (n, k)."""
        found = self.decision_function(rows)
        found -= found.max(axis=1, keepdims=True)
        found -= np.log(np.exp(found).sum(axis=1, keepdims=True))
        return found

    def predict(self, rows: Floats) -> Integers:
        """Give the class of the highest score: (n, d) to (n,)."""
        return self.classes_[self.decision_function(rows).argmax(axis=1)]


def fit_naive_bayes(
    parameters: ClassifierParameters, features: Floats, labels: Integers, _seed: int
) -> Fit:
    """Fit densities whose features are independent, of features (n, d) and labels (n,)."""
    floor = parameters.bayes_smoothing * float(features.var(axis=0).max())

    def whiten(deviations: Floats) -> Whitening:
        variances = np.square(deviations).mean(axis=0) + floor
        return np.diag(1 / np.sqrt(variances)), float(np.log(variances).sum())

    return _fit_each(features, labels, whiten), None


def fit_quadratic_discriminant(
    parameters: ClassifierParameters, features: Floats, labels: Integers, _seed: int
) -> Fit:
    """Fit a covariance of every class, of features (n, d) and labels (n,).

    Where a plain one is singular, all are shrunk, so that classes compare.
    """
    check_spread("quadratic_discriminant", features, labels)
    if parameters.discriminant_regularisation == "pseudo_inverse":
        return fit_pseudo_quadratic_discriminant(features, labels), None
    always = parameters.discriminant_regularisation == "always"
    if not always and (plain := fit_plain_discriminant(features, labels)):
        return plain, None
    shrinkage, target = parameters.discriminant_shrinkage, parameters.discriminant_target
    floor = variance_floor(features)
    shrunk = _fit_each(
        features,
        labels,
        lambda deviations: _whiten(regularised_covariance(deviations, shrinkage, target, floor)),
    )
    amount = "Ledoit-Wolf shrinkage" if shrinkage == "ledoit_wolf" else f"shrinkage {shrinkage:g}"
    return shrunk, None if always else f"singular covariance: {amount} of every class"


def fit_plain_discriminant(features: Floats, labels: Integers) -> GaussianClassifier | None:
    """Fit the covariance of every class as it is; None where one is singular."""
    _, counts = np.unique(labels, return_counts=True)
    if counts.min() <= features.shape[1]:
        return None
    fitted = _fit_each(features, labels, lambda deviations: _principal(deviations, len(deviations)))
    spread = np.square(fitted.directions).sum(axis=1)
    is_whole = np.all((spread > 0) & (spread < 1 / LEAST_PLAIN_VARIANCE))
    return fitted if is_whole else None


def fit_pseudo_quadratic_discriminant(features: Floats, labels: Integers) -> GaussianClassifier:
    """Fit the covariance of every class on the directions of its variance alone.

    Its determinant is the product of these variances; covariances divide by n - 1. That is how
    Matlab's documentation describes `pseudoquadratic`.
    """
    return _fit_each(
        features, labels, lambda deviations: _principal(deviations, len(deviations) - 1)
    )


def fit_linear_discriminant(
    parameters: ClassifierParameters, features: Floats, labels: Integers, _seed: int
) -> Fit:
    """Fit one covariance of all classes, shrunk towards one variance."""
    shrinkage = parameters.linear_shrinkage
    classes, counts, means, covariance = common_covariance(features, labels, shrinkage)
    directions, _ = _whiten(covariance)
    offsets = np.log(counts / len(labels))
    return GaussianClassifier(classes, means, directions[None], offsets), None


def _fit_each(
    features: Floats, labels: Integers, whiten: Callable[[Floats], Whitening]
) -> GaussianClassifier:
    classes, counts = np.unique(labels, return_counts=True)
    means = class_means(features, labels, classes)
    found = [
        whiten(features[labels == name] - mean) for name, mean in zip(classes, means, strict=True)
    ]
    directions, determinants = zip(*found, strict=True)
    offsets = np.log(counts / len(labels)) - np.array(determinants) / 2
    return GaussianClassifier(classes, means, np.stack(directions), offsets)


def _whiten(covariance: Floats) -> Whitening:
    """Whiten by the Cholesky factor of a covariance that is not singular."""
    factor = np.linalg.cholesky(covariance)
    directions = np.linalg.inv(factor).T
    return directions, 2 * float(np.log(np.diagonal(factor)).sum())


def _principal(deviations: Floats, count: int) -> Whitening:
    """Whiten on the directions in which deviations, (n, d), vary; their squares are divided by `count`."""
    _, scales, found = np.linalg.svd(deviations, full_matrices=False)
    spread = scales / np.sqrt(count)
    # As numpy.linalg.matrix_rank: what is smaller is rounding.
    kept = scales > scales[:1].max(initial=0) * max(deviations.shape) * np.finfo(np.float64).eps
    directions = np.zeros((deviations.shape[1],) * 2)
    directions[:, : kept.sum()] = found[kept].T / spread[kept]
    return directions, 2 * float(np.log(spread[kept]).sum())
