"""A covariance that can't be singular, for scikit-learn's discriminants.

This module imports scikit-learn (two seconds); import it where it is used.
"""

from __future__ import annotations

from typing import Literal, Self

import numpy as np
from numpy.typing import NDArray
from sklearn.base import BaseEstimator
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
        spread = deviations.std(axis=0)
        scale = np.where(spread > 0, spread, 1)
        if self.target == "mean_variance":
            scale = np.ones_like(scale)
        scaled = deviations / scale
        if self.shrinkage == "ledoit_wolf":
            covariance, _ = ledoit_wolf(scaled, assume_centered=True)
        else:
            covariance = _shrink(scaled.T @ scaled / len(X), self.shrinkage)
        self.covariance_ = covariance * np.outer(scale, scale)
        if self.target == "own_variances":
            self.covariance_[:, spread == 0] = 0
            self.covariance_[spread == 0] = 0
        self.covariance_ += self.floor * np.eye(len(scale))
        return self


def variance_floor(features: NDArray[np.float64]) -> float:
    """Give the least variance of features, shape (n, d), that a regularised covariance has."""
    return VARIANCE_FLOOR * float(features.var(axis=0).mean())


def _shrink(covariance: NDArray[np.float64], shrinkage: float) -> NDArray[np.float64]:
    """Shrink towards one variance in every direction.

    As scikit-learn's `shrunk_covariance`, number for number, but without its checks, which take ten
    times as long as the sums.
    """
    shrunk: NDArray[np.float64] = (1.0 - shrinkage) * covariance
    shrunk += shrinkage * (np.trace(covariance) / len(covariance)) * np.eye(len(covariance))
    return shrunk
