"""Covariances of classes with fewer sequences than features."""

from __future__ import annotations

from typing import Literal

import numpy as np

from visuohaptic.recognition.arrays import Floats

VARIANCE_FLOOR = 1e-6
"""Least variance of a regularised covariance, as a share of the features' mean variance."""

Shrinkage = float | Literal["ledoit_wolf"]
"""How much a covariance is shrunk, 0 to 1, or that it is found from the rows."""

Target = Literal["own_variances", "mean_variance"]
"""What a covariance is shrunk towards."""


def regularised_covariance(
    deviations: Floats, shrinkage: Shrinkage, target: Target, floor: float
) -> Floats:
    """Estimate a covariance (d, d) that can't be singular, of deviations (n, d) from the mean.

    Target ``own_variances`` shrinks the correlations towards none, each feature keeping its
    variance; ``mean_variance`` shrinks towards one variance in every direction. `floor` is added to
    every variance, for rows that do not vary at all.
    """
    if target == "mean_variance":
        found = _shrunk(deviations, shrinkage)
    else:
        spread = deviations.std(axis=0)
        scale = np.where(spread > 0, spread, 1)
        found = _shrunk(deviations / scale, shrinkage) * np.outer(spread, spread)
    return found + floor * np.eye(len(found))


def variance_floor(features: Floats) -> float:
    """Give the least variance of features, shape (n, d), that a regularised covariance has."""
    return VARIANCE_FLOOR * float(features.var(axis=0).mean())


def shrink(covariance: Floats, shrinkage: float) -> Floats:
    """Shrink towards one variance in every direction."""
    shrunk: Floats = (1.0 - shrinkage) * covariance
    shrunk += shrinkage * (np.trace(covariance) / len(covariance)) * np.eye(len(covariance))
    return shrunk


def ledoit_wolf_shrinkage(deviations: Floats, covariance: Floats) -> float:
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


def _shrunk(deviations: Floats, shrinkage: Shrinkage) -> Floats:
    plain = deviations.T @ deviations / len(deviations)
    if shrinkage == "ledoit_wolf":
        return shrink(plain, ledoit_wolf_shrinkage(deviations, plain))
    return shrink(plain, shrinkage)
