"""Classifiers whose settings and probabilities are chosen inside the training objects.

This module imports scikit-learn (two seconds); import it where it is used.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.base import clone
from sklearn.pipeline import Pipeline, make_pipeline
from sklearn.preprocessing import StandardScaler

from visuohaptic.recognition.classifiers import make_classifier
from visuohaptic.recognition.parameters import ClassifierName, ClassifierParameters
from visuohaptic.recognition.splits import grouped_folds

TEMPERATURES = np.geomspace(0.02, 50.0, 69)
"""Candidates for what scores are divided by before they become probabilities."""

LEAST_PROBABILITY = 1e-9

GRIDS: dict[str, Mapping[str, Sequence[Any]]] = {
    "k_nearest_neighbours": {"neighbours": (3, 7, 15)},
    "support_vector_machine": {"svm_penalty": (1.0, 10.0)},
    "decision_tree": {"tree_leaf_sequences": (1, 4, 8)},
    "quadratic_discriminant": {"discriminant_shrinkage": ("ledoit_wolf", 0.5, 0.9)},
    "naive_bayes": {"bayes_smoothing": (1e-9, 0.01, 0.1)},
    "linear_discriminant": {"linear_shrinkage": ("ledoit_wolf", 0.5, 0.9)},
    "logistic_regression": {"logistic_penalty": (0.01, 0.1, 1.0)},
    "extra_trees": {},
}
"""The settings that are tried for each classifier."""


@dataclass(frozen=True)
class TunedClassifier:
    """A fitted classifier that gives probabilities.

    Attributes
    ----------
    estimator : sklearn.pipeline.Pipeline
        Scaling and classifier, fitted on all training sequences.
    temperature : float
        What its scores are divided by before they become probabilities.
    classes : int
        Number c of classes; one that training lacked has probability near 0.
    setting : str
        What was chosen, such as ``svm_penalty 10``; empty where there was no choice.
    """

    estimator: Pipeline
    temperature: float
    classes: int
    setting: str

    def probabilities(self, features: NDArray[np.float64]) -> NDArray[np.float64]:
        """Give class probabilities: (n, d) to (n, c)."""
        return softmax(class_scores(self.estimator, features, self.classes) / self.temperature)


def fit_tuned_classifier(
    name: ClassifierName,
    parameters: ClassifierParameters,
    features: NDArray[np.float64],
    labels: NDArray[np.int64],
    owners: NDArray[np.int64],
    classes: int,
    folds: int,
    generator: np.random.Generator,
) -> TunedClassifier:
    """Choose a classifier's setting and temperature by folds of whole objects, then fit it.

    The setting with the least log loss over the held-out sequences wins, each
    setting at its own best temperature (C. Guo et al., "On calibration of modern
    neural networks", ICML 2017), the simpler one where two are equal.

    Parameters
    ----------
    name : str
        Which classifier.
    parameters : ClassifierParameters
        Settings that the grid does not vary.
    features : numpy.ndarray
        Shape (n, d), float64: the training features.
    labels, owners : numpy.ndarray
        Shape (n,), int64: class and object of each training sequence.
    classes : int
        Number of classes, also those that training lacks.
    folds : int
        Inner folds.
    generator : numpy.random.Generator
        Deals the objects over the folds; seeds trees.

    Returns
    -------
    TunedClassifier
        The classifier.
    """
    tested = _inner_folds(labels, owners, folds, generator)
    seed = int(generator.integers(2**31))
    best: tuple[float, float, str, Pipeline] | None = None
    for setting in _settings(name):
        settings = parameters.model_copy(update=setting)
        estimator = make_pipeline(StandardScaler(), make_classifier(name, settings, seed))
        loss, temperature = _held_out_loss(estimator, features, labels, tested, classes)
        if best is None or loss < best[0]:
            best = (loss, temperature, _in_words(setting), estimator)
    assert best is not None  # noqa: S101 - every classifier has at least one setting
    _, temperature, words, estimator = best
    return TunedClassifier(clone(estimator).fit(features, labels), temperature, classes, words)
