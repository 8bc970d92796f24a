"""Covariances of classes with fewer sequences than features."""

from __future__ import annotations

from typing import Literal

import numpy as np

from visuohaptic.errors import RecognitionError
from visuohaptic.recognition.arrays import Floats, Integers

VARIANCE_FLOOR = 1e-6
"""Least variance of a regularised covariance, as a share of the features' mean variance."""

Shrinkage = float | Literal["ledoit_wolf"]
Target = Literal["own_variances", "mean_variance"]


def regularised_covariance(
    deviations: Floats, shrinkage: Shrinkage, target: Target, floor: float
) -> Floats:
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


def variance_floor(features: Floats) -> float:
    """Give the least variance of features, shape (n, d), that a regularised covariance has."""
    return VARIANCE_FLOOR * float(features.var(axis=0).mean())


def common_covariance(
    rows: Floats, labels: Integers, shrinkage: float
) -> tuple[Integers, Integers, Floats, Floats]:
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


def class_means(rows: Floats, labels: Integers, classes: Integers) -> Floats:
    """Give the mean of each class's rows: (n, d) to (k, d)."""
    return np.stack([rows[labels == name].mean(axis=0) for name in classes])


def check_spread(name: str, features: Floats, labels: Integers) -> None:
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
    """Shrink the covariance of deviations towards one variance in every direction."""
    plain = deviations.T @ deviations / len(deviations)
    if shrinkage == "ledoit_wolf":
        shrinkage = ledoit_wolf_shrinkage(deviations, plain)
    shrunk: Floats = (1.0 - shrinkage) * plain
    shrunk += shrinkage * (np.trace(plain) / len(plain)) * np.eye(len(plain))
    return shrunk
