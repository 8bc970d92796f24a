"""Classifiers that give every class a normal density: naive Bayes, and the discriminants.

They are a few sums and one decomposition each; a check of the arguments, as libraries do it at every
call, would take several times as long as the fit.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import RecognitionError
from visuohaptic.recognition.classifier_parameters import ClassifierParameters, Fit

VARIANCE_FLOOR = 1e-6
"""Least variance of a regularised covariance, as a share of the features' mean variance."""

Shrinkage = float | Literal["ledoit_wolf"]
Target = Literal["own_variances", "mean_variance"]

LEAST_PLAIN_VARIANCE = 1e-4
"""A class that varies less than this in some direction has a covariance that counts as singular."""

Whitening = tuple[FloatArray, float]
"""Directions (d, d), by which deviations of one class get unit variances, and the log determinant of
its covariance."""


@dataclass(frozen=True)
class GaussianClassifier:
    """Classes with a normal density each.

    A deviation from one of `means` (k, d) times its `directions`, (k, d, d), or (1, d, d) for all,
    has the Mahalanobis distance as its length. `offsets` (k,) are logarithms of each class's share
    of the training rows, less half the logarithm of its covariance's determinant.
    """

    classes_: IntArray
    means: FloatArray
    directions: FloatArray
    offsets: FloatArray

    @property
    def n_features_in_(self) -> int:
        """How many features a row has."""
        return self.means.shape[1]

    def decision_function(self, rows: FloatArray) -> FloatArray:
        """Give the logarithm of each class's density times its share, but for a constant: (n, d) to (n, k)."""
        deviations = (rows - self.means[:, None]) @ self.directions
        distances = np.einsum("knd,knd->nk", deviations, deviations)
        return self.offsets - distances / 2

    def predict_log_proba(self, rows: FloatArray) -> FloatArray:
        """Give the logarithm of each class's probability: (n, d) to (n, k)."""
        found = self.decision_function(rows)
        found -= found.max(axis=1, keepdims=True)
        found -= np.log(np.exp(found).sum(axis=1, keepdims=True))
        return found

    def predict(self, rows: FloatArray) -> IntArray:
        """Give the class of the highest score: (n, d) to (n,)."""
        return self.classes_[self.decision_function(rows).argmax(axis=1)]


def fit_naive_bayes(
    parameters: ClassifierParameters, features: FloatArray, labels: IntArray, _seed: int
) -> Fit:
    """Fit densities whose features are independent, of features (n, d) and labels (n,)."""
    floor = parameters.bayes_smoothing * float(features.var(axis=0).max())

    def whiten(deviations: FloatArray) -> Whitening:
        variances = np.square(deviations).mean(axis=0) + floor
        return np.diag(1 / np.sqrt(variances)), float(np.log(variances).sum())

    return _fit_each(features, labels, whiten), None


def fit_quadratic_discriminant(
    parameters: ClassifierParameters, features: FloatArray, labels: IntArray, _seed: int
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


def fit_plain_discriminant(features: FloatArray, labels: IntArray) -> GaussianClassifier | None:
    """Fit the covariance of every class as it is; None where one is singular."""
    _, counts = np.unique(labels, return_counts=True)
    if counts.min() <= features.shape[1]:
        return None
    fitted = _fit_each(features, labels, lambda deviations: _principal(deviations, len(deviations)))
    spread = np.square(fitted.directions).sum(axis=1)
    is_whole = np.all((spread > 0) & (spread < 1 / LEAST_PLAIN_VARIANCE))
    return fitted if is_whole else None


def fit_pseudo_quadratic_discriminant(features: FloatArray, labels: IntArray) -> GaussianClassifier:
    """Fit the covariance of every class on the directions of its variance alone.

    Its determinant is the product of these variances; covariances divide by n - 1. That is how
    Matlab's documentation describes `pseudoquadratic`.
    """
    return _fit_each(
        features, labels, lambda deviations: _principal(deviations, len(deviations) - 1)
    )


def fit_linear_discriminant(
    parameters: ClassifierParameters, features: FloatArray, labels: IntArray, _seed: int
) -> Fit:
    """Fit one covariance of all classes, shrunk towards one variance."""
    shrinkage = parameters.linear_shrinkage
    classes, counts, means, covariance = common_covariance(features, labels, shrinkage)
    directions, _ = _whiten(covariance)
    offsets = np.log(counts / len(labels))
    return GaussianClassifier(classes, means, directions[None], offsets), None


def _fit_each(
    features: FloatArray, labels: IntArray, whiten: Callable[[FloatArray], Whitening]
) -> GaussianClassifier:
    classes, counts = np.unique(labels, return_counts=True)
    means = class_means(features, labels, classes)
    found = [
        whiten(features[labels == name] - mean) for name, mean in zip(classes, means, strict=True)
    ]
    directions, determinants = zip(*found, strict=True)
    offsets = np.log(counts / len(labels)) - np.array(determinants) / 2
    return GaussianClassifier(classes, means, np.stack(directions), offsets)


def _whiten(covariance: FloatArray) -> Whitening:
    """Whiten by the Cholesky factor of a covariance that is not singular."""
    factor = np.linalg.cholesky(covariance)
    directions = np.linalg.inv(factor).T
    return directions, 2 * float(np.log(np.diagonal(factor)).sum())


def _principal(deviations: FloatArray, count: int) -> Whitening:
    """Whiten on the directions in which deviations, (n, d), vary; their squares are divided by `count`."""
    _, scales, found = np.linalg.svd(deviations, full_matrices=False)
    spread = scales / np.sqrt(count)
    # As numpy.linalg.matrix_rank: what is smaller is rounding.
    kept = scales > scales[:1].max(initial=0) * max(deviations.shape) * np.finfo(np.float64).eps
    directions = np.zeros((deviations.shape[1],) * 2)
    directions[:, : kept.sum()] = found[kept].T / spread[kept]
    return directions, 2 * float(np.log(spread[kept]).sum())


def regularised_covariance(
    deviations: FloatArray, shrinkage: Shrinkage, target: Target, floor: float
) -> FloatArray:
    """Estimate a covariance (d, d) that can't be singular, of deviations (n, d) from the mean.

    Target ``own_variances`` shrinks the correlations alone; ``mean_variance`` shrinks towards one
    variance in every direction. `floor` is added to every variance, for rows that do not vary.
    """
    if target == "mean_variance":
        found = _shrunk(deviations, shrinkage)
    else:
        spread = deviations.std(axis=0)
        scale = np.where(spread > 0, spread, 1)
        found = _shrunk(deviations / scale, shrinkage) * np.outer(spread, spread)
    return found + floor * np.eye(len(found))


def variance_floor(features: FloatArray) -> float:
    """Give the least variance of features, shape (n, d), that a regularised covariance has."""
    return VARIANCE_FLOOR * float(features.var(axis=0).mean())


def common_covariance(
    rows: FloatArray, labels: IntArray, shrinkage: float
) -> tuple[IntArray, IntArray, FloatArray, FloatArray]:
    """Give the classes (k,), their rows' number (k,) and means (k, d), and one covariance (d, d) of all.

    Raises `RecognitionError` if there is nothing to take a covariance of.
    """
    check_spread("linear_discriminant", rows, labels)
    classes, places, counts = np.unique(labels, return_inverse=True, return_counts=True)
    means = class_means(rows, labels, classes)
    covariance = regularised_covariance(
        rows - means[places], shrinkage, "mean_variance", variance_floor(rows)
    )
    return classes, counts, means, covariance


def class_means(rows: FloatArray, labels: IntArray, classes: IntArray) -> FloatArray:
    """Give the mean of each class's rows: (n, d) to (k, d)."""
    return np.stack([rows[labels == name].mean(axis=0) for name in classes])


def check_spread(name: str, features: FloatArray, labels: IntArray) -> None:
    """Refuse features (n, d) of classes (n,) that a discriminant can't take a covariance of."""
    _, counts = np.unique(labels, return_counts=True)
    lonely = counts.min() < 2 if name == "quadratic_discriminant" else counts.max() < 2
    if lonely:
        raise RecognitionError(
            f"{name} takes covariances and the smallest class has {counts.min()} training sequence; "
            "at least 2 are needed."
        )
    if not np.ptp(features, axis=0).any():
        raise RecognitionError(
            f"{name} takes covariances and all {len(labels)} training sequences are alike; "
            "features that vary are needed."
        )


def ledoit_wolf_shrinkage(deviations: FloatArray, covariance: FloatArray) -> float:
    """Find how much to shrink the covariance, (d, d), of deviations from the mean, (n, d).

    The expected squared error of the shrunk covariance is least (O. Ledoit and M. Wolf, "A
    well-conditioned estimator for large-dimensional covariance matrices", J. Multivariate Analysis
    88, 2004, section 3.2).
    """
    count, columns = deviations.shape
    mean_variance = np.trace(covariance) / columns
    squares = np.square(covariance).sum()
    dispersion = squares / columns - mean_variance**2
    fourth = np.square(np.square(deviations).sum(axis=1)).sum() / count
    error = min((fourth - squares) / (count * columns), dispersion)
    return float(error / dispersion) if error > 0 else 0.0


def _shrunk(deviations: FloatArray, shrinkage: Shrinkage) -> FloatArray:
    """Shrink the covariance of deviations towards one variance in every direction."""
    plain = deviations.T @ deviations / len(deviations)
    if shrinkage == "ledoit_wolf":
        shrinkage = ledoit_wolf_shrinkage(deviations, plain)
    shrunk: FloatArray = (1.0 - shrinkage) * plain
    shrunk += shrinkage * (np.trace(plain) / len(plain)) * np.eye(len(plain))
    return shrunk
