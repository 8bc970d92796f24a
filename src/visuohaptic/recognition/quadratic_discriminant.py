"""Quadratic discriminant analysis with shrinkage if the covariance of a class is singular.

scikit-learn's class has no Ledoit-Wolf shrinkage per class, and does not report singular covariances.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, Self

import numpy as np
from sklearn.base import BaseEstimator, ClassifierMixin
from sklearn.utils.multiclass import check_classification_targets
from sklearn.utils.validation import check_is_fitted, validate_data

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import RecognitionError

VARIANCE_FLOOR = 1e-6
"""Least variance of a regularised covariance, as a share of the features' mean variance."""

LEAST_PLAIN_VARIANCE = 1e-4
"""A covariance with a variance below this in any direction is treated as singular."""

Shrinkage = float | Literal["ledoit_wolf"]
Regularisation = Literal["where_singular", "always", "pseudo_inverse"]
Target = Literal["own_variances", "mean_variance"]
Whitening = tuple[FloatArray, float]
"""A matrix (d, d) that whitens the deviations of one class, and the log determinant of the class's covariance."""


class QuadraticDiscriminant(ClassifierMixin, BaseEstimator):  # type: ignore[misc]
    """Classify by a normal density per class, each with a covariance of its own.

    Parameters
    ----------
    shrinkage : float or "ledoit_wolf"
        Share of the target in a regularised covariance.
    regularisation : {"where_singular", "always", "pseudo_inverse"}
        Regularise all covariances if one is singular, or always. ``pseudo_inverse`` leaves out directions without
        variance, as Matlab's documentation describes ``pseudoquadratic``.
    target : {"own_variances", "mean_variance"}
        Shrink towards uncorrelated features of their own variances, or towards one variance in all directions.

    Attributes
    ----------
    classes_ : ndarray of shape (k,)
        Sorted classes.
    means_ : ndarray of shape (k, d)
        Mean of each class.
    directions_ : ndarray of shape (k, d, d)
        Whitening matrices: the norm of ``(x - mean) @ directions`` is the Mahalanobis distance.
    offsets_ : ndarray of shape (k,)
        Log share of each class in training, minus half the log determinant of its covariance.
    note_ : str or None
        States the shrinkage if covariances were shrunk because one was singular.
    """

    def __init__(
        self,
        shrinkage: Shrinkage = "ledoit_wolf",
        regularisation: Regularisation = "where_singular",
        target: Target = "own_variances",
    ) -> None:
        self.shrinkage = shrinkage
        self.regularisation = regularisation
        self.target = target

    def fit(self, X: Any, y: Any) -> Self:
        """Fit rows (n, d) of classes (n,).

        Raises `RecognitionError` if a class has one row, or no feature varies.
        """
        rows, y = validate_data(self, X, y, dtype=np.float64)
        check_classification_targets(y)
        self.classes_, labels = np.unique(y, return_inverse=True)
        _check_spread(rows, labels)
        self.note_: str | None = None
        if self.regularisation == "pseudo_inverse":
            return self._fit_densities(
                rows, labels, lambda deviations: _principal(deviations, len(deviations) - 1)
            )
        if self.regularisation == "where_singular":
            if self._fit_plain(rows, labels):
                return self
            amount = (
                "Ledoit-Wolf shrinkage"
                if self.shrinkage == "ledoit_wolf"
                else f"shrinkage {self.shrinkage:g}"
            )
            self.note_ = f"singular covariance: {amount} of every class"
        floor = VARIANCE_FLOOR * float(rows.var(axis=0).mean())
        return self._fit_densities(
            rows,
            labels,
            lambda deviations: _whiten(
                regularised_covariance(deviations, self.shrinkage, self.target, floor)
            ),
        )

    def decision_function(self, X: Any) -> FloatArray:
        """Compute the log density times the share of each class, up to a constant: (n, d) to (n, k).

        Of two classes, return the score of the second minus that of the first, (n,), as scikit-learn does.
        """
        scores = self._scores(X)
        return scores[:, 1] - scores[:, 0] if len(self.classes_) == 2 else scores

    def _scores(self, X: Any) -> FloatArray:
        check_is_fitted(self)
        rows = validate_data(self, X, dtype=np.float64, reset=False)
        deviations = (rows - self.means_[:, None]) @ self.directions_
        squares = np.einsum("knd,knd->nk", deviations, deviations)
        scores: FloatArray = self.offsets_ - squares / 2
        return scores

    def predict_log_proba(self, X: Any) -> FloatArray:
        """Compute log class probabilities: (n, d) to (n, k)."""
        scores = self._scores(X)
        scores -= scores.max(axis=1, keepdims=True)
        scores -= np.log(np.exp(scores).sum(axis=1, keepdims=True))
        return scores

    def predict_proba(self, X: Any) -> FloatArray:
        """Compute class probabilities: (n, d) to (n, k)."""
        return np.exp(self.predict_log_proba(X))

    def predict(self, X: Any) -> Any:
        """Predict the class of the highest score: (n, d) to (n,)."""
        scores = self._scores(X)
        return self.classes_[scores.argmax(axis=1)]

    def _fit_plain(self, rows: FloatArray, labels: IntArray) -> bool:
        """Fit covariances without shrinkage, and return whether all are far from singular."""
        if np.bincount(labels).min() <= rows.shape[1]:
            return False
        self._fit_densities(
            rows, labels, lambda deviations: _principal(deviations, len(deviations))
        )
        inverse_variances = np.square(self.directions_).sum(axis=1)
        return bool(
            np.all((inverse_variances > 0) & (inverse_variances < 1 / LEAST_PLAIN_VARIANCE))
        )

    def _fit_densities(
        self, rows: FloatArray, labels: IntArray, whiten: Callable[[FloatArray], Whitening]
    ) -> Self:
        """Fit the density of each class; `whiten` takes the deviations (n, d) of one class from its mean."""
        by_class = [rows[labels == index] for index in range(len(self.classes_))]
        self.means_ = np.stack([members.mean(axis=0) for members in by_class])
        fitted = [
            whiten(members - mean) for members, mean in zip(by_class, self.means_, strict=True)
        ]
        directions, log_determinants = zip(*fitted, strict=True)
        self.directions_ = np.stack(directions)
        self.offsets_ = np.log(np.bincount(labels) / len(labels)) - np.array(log_determinants) / 2
        return self


def regularised_covariance(
    deviations: FloatArray, shrinkage: Shrinkage, target: Target, floor: float
) -> FloatArray:
    """Estimate a covariance (d, d) that is not singular from deviations (n, d) from the mean.

    `floor` is added to every variance, for features that do not vary.
    """
    if target == "mean_variance":
        covariance = _shrunk(deviations, shrinkage)
    else:
        spread = deviations.std(axis=0)
        scale = np.where(spread > 0, spread, 1)
        covariance = _shrunk(deviations / scale, shrinkage) * np.outer(spread, spread)
    return covariance + floor * np.eye(len(covariance))


def ledoit_wolf_shrinkage(deviations: FloatArray, covariance: FloatArray) -> float:
    """Compute the shrinkage with the least expected squared error.

    Source: O. Ledoit and M. Wolf, "A well-conditioned estimator for large-dimensional covariance matrices",
    J. Multivariate Analysis 88, 2004, section 3.2.

    Parameters
    ----------
    deviations : ndarray of shape (n, d)
        Rows minus their mean.
    covariance : ndarray of shape (d, d)
        Covariance of the rows.
    """
    count, columns = deviations.shape
    mean_variance = np.trace(covariance) / columns
    squares = np.square(covariance).sum()
    dispersion = squares / columns - mean_variance**2
    fourth = np.square(np.square(deviations).sum(axis=1)).sum() / count
    error = min((fourth - squares) / (count * columns), dispersion)
    return float(error / dispersion) if error > 0 else 0.0


def _shrunk(deviations: FloatArray, shrinkage: Shrinkage) -> FloatArray:
    plain = deviations.T @ deviations / len(deviations)
    if shrinkage == "ledoit_wolf":
        shrinkage = ledoit_wolf_shrinkage(deviations, plain)
    shrunk: FloatArray = (1.0 - shrinkage) * plain
    shrunk += shrinkage * (np.trace(plain) / len(plain)) * np.eye(len(plain))
    return shrunk


def _whiten(covariance: FloatArray) -> Whitening:
    """Whiten by the Cholesky factor of a covariance that is not singular."""
    factor = np.linalg.cholesky(covariance)
    return np.linalg.inv(factor).T, 2 * float(np.log(np.diagonal(factor)).sum())


def _principal(deviations: FloatArray, divisor: int) -> Whitening:
    """Whiten in the directions in which deviations (n, d) vary; variances are sums of squares over `divisor`."""
    _, scales, components = np.linalg.svd(deviations, full_matrices=False)
    spread = scales / np.sqrt(divisor)
    # The threshold of numpy.linalg.matrix_rank: smaller singular values are rounding.
    kept = scales > scales[:1].max(initial=0) * max(deviations.shape) * np.finfo(np.float64).eps
    directions = np.zeros((deviations.shape[1],) * 2)
    directions[:, : kept.sum()] = components[kept].T / spread[kept]
    return directions, 2 * float(np.log(spread[kept]).sum())


def _check_spread(rows: FloatArray, labels: IntArray) -> None:
    fewest = np.bincount(labels).min()
    if fewest < 2:
        raise RecognitionError(
            f"quadratic_discriminant fits covariances, and the smallest class has {fewest} training sequence; "
            "at least 2 are needed."
        )
    if not np.ptp(rows, axis=0).any():
        raise RecognitionError(
            f"quadratic_discriminant fits covariances, and all {len(labels)} training sequences are equal; "
            "features that vary are needed."
        )
