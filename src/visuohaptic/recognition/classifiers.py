"""The paper's five classifiers, by scikit-learn.

This module imports scikit-learn (two seconds); import it where it is used.
"""

from __future__ import annotations

from typing import Any, Literal, Self

import numpy as np
from numpy.typing import NDArray
from sklearn.base import BaseEstimator
from sklearn.covariance import ledoit_wolf, shrunk_covariance
from sklearn.discriminant_analysis import QuadraticDiscriminantAnalysis
from sklearn.naive_bayes import GaussianNB
from sklearn.neighbors import KNeighborsClassifier
from sklearn.svm import SVC
from sklearn.tree import DecisionTreeClassifier

from visuohaptic.recognition.parameters import ClassifierName, ClassifierParameters

VARIANCE_FLOOR = 1e-6
"""Least variance of a regularised covariance, as a share of the features' mean variance."""


class ShrunkCovariance(BaseEstimator):  # type: ignore[misc]
    """A covariance that can't be singular, for scikit-learn's quadratic discriminant.

    The class's correlations are shrunk towards none at all, each feature keeping
    its variance (the discriminant's own ``shrinkage`` does the same), and a floor
    is added to every variance for classes that do not vary at all.

    Parameters
    ----------
    shrinkage : float or "ledoit_wolf"
        Amount, or how to find it.
    floor : float
        Added to every variance.
    """

    def __init__(self, shrinkage: float | Literal["ledoit_wolf"], floor: float) -> None:
        self.shrinkage = shrinkage
        self.floor = floor

    def fit(self, X: NDArray[np.float64]) -> Self:
        """Estimate the covariance of rows, shape (n, d)."""
        deviations = X - X.mean(axis=0)
        scale = deviations.std(axis=0)
        scaled = deviations / np.where(scale > 0, scale, 1)
        if self.shrinkage == "ledoit_wolf":
            correlation, _ = ledoit_wolf(scaled, assume_centered=True)
        else:
            correlation = shrunk_covariance(scaled.T @ scaled / len(X), self.shrinkage)
        self.covariance_ = correlation * np.outer(scale, scale)
        self.covariance_ += self.floor * np.eye(len(scale))
        return self


def fit_classifier(
    name: ClassifierName,
    parameters: ClassifierParameters,
    features: NDArray[np.float64],
    labels: NDArray[np.int64],
    generator: np.random.Generator,
) -> tuple[Any, str | None]:
    """Fit one classifier.

    Parameters
    ----------
    name : str
        Which one.
    parameters : ClassifierParameters
        Its settings.
    features : numpy.ndarray
        Shape (n, d), float64: the training features.
    labels : numpy.ndarray
        Shape (n,), int64: the training classes.
    generator : numpy.random.Generator
        Breaks ties between splits of the decision tree.

    Returns
    -------
    object
        The fitted scikit-learn classifier.
    str or None
        What it needed to be fitted, such as regularised covariances.
    """
    if name == "quadratic_discriminant":
        return _fit_quadratic_discriminant(parameters, features, labels)
    neighbours = min(parameters.neighbours, len(labels))
    seed = int(generator.integers(2**31))
    makers: dict[str, Any] = {
        "k_nearest_neighbours": lambda: KNeighborsClassifier(
            neighbours, weights=parameters.neighbour_weights, algorithm="brute"
        ),
        "support_vector_machine": lambda: SVC(
            kernel=parameters.svm_kernel, C=parameters.svm_penalty
        ),
        "decision_tree": lambda: DecisionTreeClassifier(
            criterion=parameters.tree_criterion,
            min_samples_leaf=parameters.tree_leaf_sequences,
            random_state=seed,
        ),
        "naive_bayes": lambda: GaussianNB(var_smoothing=parameters.bayes_smoothing),
    }
    fitted = makers[name]().fit(features, labels)
    if neighbours < parameters.neighbours and name == "k_nearest_neighbours":
        return fitted, f"{neighbours} neighbours, for there are no more training sequences"
    return fitted, None


def _fit_quadratic_discriminant(
    parameters: ClassifierParameters,
    features: NDArray[np.float64],
    labels: NDArray[np.int64],
) -> tuple[Any, str | None]:
    """Fit plain covariances; where one is singular, shrink all, so that the classes compare."""
    if np.bincount(labels).min() > features.shape[1]:
        try:
            return QuadraticDiscriminantAnalysis().fit(features, labels), None
        except np.linalg.LinAlgError:
            pass  # a covariance is singular for another reason than few sequences
    shrinkage = parameters.discriminant_shrinkage
    floor = VARIANCE_FLOOR * float(features.var(axis=0).mean())
    regularised = QuadraticDiscriminantAnalysis(
        solver="eigen", covariance_estimator=ShrunkCovariance(shrinkage, floor), tol=0
    )
    amount = "Ledoit-Wolf shrinkage" if shrinkage == "ledoit_wolf" else f"shrinkage {shrinkage:g}"
    return regularised.fit(features, labels), f"singular covariance: {amount} of every class"
