"""The scikit-learn estimator of each classifier.

A module of its own, so that the names of classifiers can be checked without the second that scikit-learn takes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from sklearn.discriminant_analysis import LinearDiscriminantAnalysis
from sklearn.linear_model import LogisticRegression
from sklearn.naive_bayes import GaussianNB
from sklearn.neighbors import KNeighborsClassifier
from sklearn.svm import SVC
from sklearn.tree import DecisionTreeClassifier

from visuohaptic.recognition.classifier_parameters import ClassifierParameters
from visuohaptic.recognition.quadratic_discriminant import QuadraticDiscriminant

MAKERS: Mapping[str, Callable[[ClassifierParameters], Any]] = {
    # brute: the trees of the other algorithms, read from a file, hold indices that nothing checks
    "k_nearest_neighbours": lambda own: KNeighborsClassifier(own.neighbours, algorithm="brute"),
    "support_vector_machine": lambda own: SVC(kernel=own.svm_kernel, C=own.svm_penalty),
    "decision_tree": lambda own: DecisionTreeClassifier(min_samples_leaf=own.tree_leaf_sequences),
    "quadratic_discriminant": lambda own: QuadraticDiscriminant(
        own.discriminant_shrinkage, own.discriminant_regularisation, own.discriminant_target
    ),
    "naive_bayes": lambda own: GaussianNB(var_smoothing=own.bayes_smoothing),
    "linear_discriminant": lambda own: LinearDiscriminantAnalysis(
        solver="lsqr", shrinkage=own.linear_shrinkage
    ),
    "logistic_regression": lambda own: LogisticRegression(C=own.logistic_penalty, max_iter=1000),
}
"""Unfitted estimators by the names in `classifiers.CLASSIFIERS`."""
