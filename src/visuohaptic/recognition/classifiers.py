"""The paper's five classifiers and two more, by scikit-learn.

This module imports scikit-learn (two seconds); import it where it is used.
"""

from __future__ import annotations

from typing import Any, Literal, Self, get_args

import numpy as np
from numpy.typing import NDArray
from sklearn.base import BaseEstimator
from sklearn.covariance import ledoit_wolf
from sklearn.discriminant_analysis import (
    LinearDiscriminantAnalysis,
    QuadraticDiscriminantAnalysis,
)
from sklearn.linear_model import LogisticRegression
from sklearn.naive_bayes import GaussianNB
from sklearn.neighbors import KNeighborsClassifier
from sklearn.svm import SVC
from sklearn.tree import DecisionTreeClassifier

from visuohaptic.errors import RecognitionError
from visuohaptic.recognition.parameters import ClassifierName, ClassifierParameters

NAMES: tuple[str, ...] = get_args(ClassifierName)

CHANCELESS = frozenset(NAMES) - {"decision_tree"}
"""Classifiers that the same rows always give, whatever the generator."""

_DISCRIMINANTS = ("quadratic_discriminant", "linear_discriminant")

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

    Raises
    ------
    RecognitionError
        If a discriminant has nothing to take a covariance of.
    """
    seed = draw_seed(generator)
    if name in _DISCRIMINANTS:
        _check_spread(name, features, labels)
    if name == "quadratic_discriminant":
        return _fit_quadratic_discriminant(parameters, features, labels)
    if name == "k_nearest_neighbours" and parameters.neighbours > len(labels):
        fewer = parameters.model_copy(update={"neighbours": len(labels)})
        note = f"{len(labels)} neighbours, for there are no more training sequences"
        return _make_classifier(name, fewer, features, seed).fit(features, labels), note
    return _make_classifier(name, parameters, features, seed).fit(features, labels), None


def _check_spread(
    name: ClassifierName, features: NDArray[np.float64], labels: NDArray[np.int64]
) -> None:
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


def draw_seed(generator: np.random.Generator) -> int:
    """Draw what every fit draws, whether it has a use for chance or not."""
    return int(generator.integers(2**31))


def _make_classifier(
    name: ClassifierName,
    parameters: ClassifierParameters,
    features: NDArray[np.float64],
    seed: int,
) -> Any:
    match name:
        case "k_nearest_neighbours":
            return KNeighborsClassifier(
                parameters.neighbours, weights=parameters.neighbour_weights, algorithm="brute"
            )
        case "support_vector_machine":
            return SVC(kernel=parameters.svm_kernel, C=parameters.svm_penalty)
        case "decision_tree":
            return DecisionTreeClassifier(
                criterion=parameters.tree_criterion,
                min_samples_leaf=parameters.tree_leaf_sequences,
                random_state=seed,
            )
        case "naive_bayes":
            return GaussianNB(var_smoothing=parameters.bayes_smoothing)
        case "linear_discriminant":
            covariance = ShrunkCovariance(
                parameters.linear_shrinkage, "mean_variance", _variance_floor(features)
            )
            return LinearDiscriminantAnalysis(solver="lsqr", covariance_estimator=covariance)
        case "logistic_regression":
            return LogisticRegression(C=parameters.logistic_penalty, max_iter=1000)
    raise RecognitionError(f"There is no classifier {name}; {', '.join(NAMES)} are allowed.")


def _fit_quadratic_discriminant(
    parameters: ClassifierParameters,
    features: NDArray[np.float64],
    labels: NDArray[np.int64],
) -> tuple[Any, str | None]:
    """Fit plain covariances if any; where one is singular, shrink all, so that classes compare."""
    _, counts = np.unique(labels, return_counts=True)
    always = parameters.discriminant_regularisation == "always"
    if counts.min() > features.shape[1] and not always:
        try:
            return QuadraticDiscriminantAnalysis().fit(features, labels), None
        except np.linalg.LinAlgError:
            pass  # a covariance is singular for another reason than few sequences
    shrinkage, target = parameters.discriminant_shrinkage, parameters.discriminant_target
    covariance = ShrunkCovariance(shrinkage, target, _variance_floor(features))
    regularised = QuadraticDiscriminantAnalysis(
        solver="eigen", covariance_estimator=covariance, tol=0
    )
    amount = "Ledoit-Wolf shrinkage" if shrinkage == "ledoit_wolf" else f"shrinkage {shrinkage:g}"
    note = None if always else f"singular covariance: {amount} of every class"
    return regularised.fit(features, labels), note


def _shrink(covariance: NDArray[np.float64], shrinkage: float) -> NDArray[np.float64]:
    """Shrink towards one variance in every direction.

    As scikit-learn's `shrunk_covariance`, number for number, but without its checks, which take ten
    times as long as the sums.
    """
    shrunk: NDArray[np.float64] = (1.0 - shrinkage) * covariance
    shrunk += shrinkage * (np.trace(covariance) / len(covariance)) * np.eye(len(covariance))
    return shrunk


def _variance_floor(features: NDArray[np.float64]) -> float:
    return VARIANCE_FLOOR * float(features.var(axis=0).mean())
