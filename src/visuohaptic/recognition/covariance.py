"""Discriminants where classes have fewer sequences than features.

This module imports scikit-learn (two seconds); import it where it is used.
"""

from __future__ import annotations

from typing import Literal, Self

import numpy as np
from numpy.typing import NDArray
from sklearn.base import BaseEstimator, ClassifierMixin
from sklearn.covariance import ledoit_wolf

VARIANCE_FLOOR = 1e-6
"""Least variance of a regularised covariance, as a share of the features' mean variance."""


class ShrunkCovariance(BaseEstimator):  # type: ignore[misc]
    """A covariance that can't be singular, for scikit-learn's discriminants.

    Parameters
    ----------
    shrinkage : float or "ledoit_wolf"
        Amount, or how to find it.
    target : str
        ``own_variances`` shrinks the correlations towards none, each feature
        keeping its variance (what scikit-learn's own ``shrinkage`` does);
        ``mean_variance`` shrinks towards one variance in every direction.
    floor : float
        Added to every variance, for rows that do not vary at all.
    """

    def __init__(
        self,
        shrinkage: float | Literal["ledoit_wolf"],
        target: Literal["own_variances", "mean_variance"],
        floor: float,
    ) -> None:
        self.shrinkage = shrinkage
        self.target = target
        self.floor = floor

    def fit(self, X: NDArray[np.float64]) -> Self:
        """Estimate the covariance of rows, shape (n, d)."""
        deviations = X - X.mean(axis=0)
        if self.target == "mean_variance":
            self.covariance_ = self._shrunk(deviations)
        else:
            spread = deviations.std(axis=0)
            scale = np.where(spread > 0, spread, 1)
            self.covariance_ = self._shrunk(deviations / scale) * np.outer(scale, scale)
            self.covariance_[:, spread == 0] = 0
            self.covariance_[spread == 0] = 0
        self.covariance_ += self.floor * np.eye(X.shape[1])
        return self

    def _shrunk(self, deviations: NDArray[np.float64]) -> NDArray[np.float64]:
        """Estimate the covariance of deviations from the mean, shrunk towards one variance."""
        if self.shrinkage == "ledoit_wolf":
            found: NDArray[np.float64] = ledoit_wolf(deviations, assume_centered=True)[0]
            return found
        return shrink(deviations.T @ deviations / len(deviations), self.shrinkage)


class PseudoQuadraticDiscriminant(ClassifierMixin, BaseEstimator):  # type: ignore[misc]
    """A quadratic discriminant that leaves out directions in which a class does not vary.

    The covariance of each class is inverted on the directions of its variance alone, and its
    determinant is the product of these variances; covariances divide by n - 1. That is how Matlab's documentation describes
    `pseudoquadratic`; its code was not read.
    """

    def fit(self, X: NDArray[np.float64], y: NDArray[np.int64]) -> Self:
        """Fit on rows X, shape (n, d), of classes y, shape (n,)."""
        self.classes_, counts = np.unique(y, return_counts=True)
        self._priors = np.log(counts / len(y))
        self._parts = [_principal_part(X[y == name]) for name in self.classes_]
        return self

    def decision_function(self, X: NDArray[np.float64]) -> NDArray[np.float64]:
        """Give the logarithm of each class's density times its share, shape (n, c)."""
        scores = [
            -(np.square((X - mean) @ directions / deviations).sum(axis=1)) / 2
            - np.log(deviations).sum()
            for mean, directions, deviations in self._parts
        ]
        return np.stack(scores, axis=1) + self._priors

    def predict(self, X: NDArray[np.float64]) -> NDArray[np.int64]:
        """Give the class of the highest score, shape (n,)."""
        found: NDArray[np.int64] = self.classes_[self.decision_function(X).argmax(axis=1)]
        return found


def _principal_part(
    rows: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Give the mean of rows, shape (n, d), the directions in which they vary, and their deviations."""
    mean = rows.mean(axis=0)
    _, scales, directions = np.linalg.svd(rows - mean, full_matrices=False)
    deviations = scales / np.sqrt(len(rows) - 1)
    # As numpy.linalg.matrix_rank: what is smaller is rounding.
    kept = scales > scales[:1].max(initial=0) * max(rows.shape) * np.finfo(np.float64).eps
    return mean, directions[kept].T, deviations[kept]


def variance_floor(features: NDArray[np.float64]) -> float:
    """Give the least variance of features, shape (n, d), that a regularised covariance has."""
    return VARIANCE_FLOOR * float(features.var(axis=0).mean())


def shrink(covariance: NDArray[np.float64], shrinkage: float) -> NDArray[np.float64]:
    """Shrink towards one variance in every direction.

    As scikit-learn's `shrunk_covariance`, number for number, but without its checks, which take ten
    times as long as the sums.
    """
    shrunk: NDArray[np.float64] = (1.0 - shrinkage) * covariance
    shrunk += shrinkage * (np.trace(covariance) / len(covariance)) * np.eye(len(covariance))
    return shrunk
