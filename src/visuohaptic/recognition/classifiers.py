"""Classifiers: the paper's five in the order of its Table 1, then others.

What is a few sums is ours (`gaussian`, `neighbours`), the rest is scikit-learn's. Libraries are
imported with the functions that use them (scikit-learn takes a second), so that the classifiers'
names and settings can be checked without.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

from visuohaptic.base.errors import RecognitionError
from visuohaptic.base.registry import Registry
from visuohaptic.recognition.classifier_parameters import ClassifierParameters, Fit
from visuohaptic.recognition.gaussian import (
    fit_linear_discriminant,
    fit_naive_bayes,
    fit_quadratic_discriminant,
)
from visuohaptic.recognition.neighbours import fit_nearest_neighbours
from visuohaptic.recognition.support_vectors import fit_support_vector_machine

if TYPE_CHECKING:
    import numpy as np

    from visuohaptic.base.arrays import FloatArray, IntArray

logger = logging.getLogger(__name__)

Fitted = TypeVar("Fitted")


@dataclass(frozen=True)
class Classifier:
    """A classifier with its settings.

    Attributes
    ----------
    name : str
        What parameters and tables call it.
    label : str
        What the report calls it.
    fit : callable
        Takes the settings, the training features, shape (n, d), float64, their classes, shape
        (n,), int64, and a seed; gives a classifier with ``classes_``, ``predict``, and class
        probabilities or a decision function, as scikit-learn's, and a note or none.
    grid : mapping of str to sequence
        The settings that pipeline `best` tries, by their names among `ClassifierParameters`,
        the simplest first.
    deterministic : bool
        Whether the same rows and settings give the same classifier with every seed. Only then
        may a fit be used again for another seed.
    """

    name: str
    label: str
    fit: Callable[[ClassifierParameters, FloatArray, IntArray, int], Fit]
    grid: Mapping[str, Sequence[Any]]
    deterministic: bool = False

    @classmethod
    def of(cls, name: str, estimator: Any, label: str = "") -> Classifier:
        """Make an entry of any scikit-learn classifier.

        Parameters
        ----------
        name : str
            What parameters and tables call it.
        estimator : object
            Unfitted; each fit takes a copy. Where it has a `random_state`, that is the seed of the
            fit, whatever was set.
        label : str, optional
            What the report calls it; without it its name with blanks.

        Returns
        -------
        Classifier
            To be registered. Pipeline `best` tries no settings of it.
        """

        def fit(_: ClassifierParameters, features: FloatArray, labels: IntArray, seed: int) -> Fit:
            from sklearn.base import clone

            found = clone(estimator)
            if "random_state" in found.get_params(deep=False):
                found.set_params(random_state=seed)
            return found.fit(features, labels), None

        return cls(name, label or name.replace("_", " "), fit, {})


def fit_classifier(
    classifier: str | Classifier,
    parameters: ClassifierParameters,
    features: FloatArray,
    labels: IntArray,
    generator: np.random.Generator,
) -> Fit:
    """Fit a classifier, or the one of a name, on training features (n, d) and classes (n,).

    Also gives a note on what it needed, if anything, such as regularised covariances. The generator
    gives the seed of those that draw. Raises `RegistryError` if there is no such classifier, and
    `RecognitionError` if a discriminant has nothing to take a covariance of.
    """
    entry = CLASSIFIERS[classifier] if isinstance(classifier, str) else classifier
    return entry.fit(parameters, features, labels, draw_seed(generator))


def fit_each(
    names: Iterable[ClassifierName], fit: Callable[[ClassifierName], Fitted]
) -> Iterator[tuple[ClassifierName, Fitted]]:
    """Fit classifiers one by one; those that can't be fitted are left out, and the log says why.

    Raises the last one's `RecognitionError` if none can be fitted.
    """
    failed, fitted = None, False
    for name in names:
        try:
            found = fit(name)
        except RecognitionError as error:
            logger.warning("%s is left out: %s", name, error)
            failed = error
            continue
        fitted = True
        yield name, found
    if failed is not None and not fitted:
        raise failed


def draw_seed(generator: np.random.Generator) -> int:
    """Draw what every fit draws, whether it has a use for chance or not."""
    return int(generator.integers(2**31))


def _fit_decision_tree(
    parameters: ClassifierParameters, features: FloatArray, labels: IntArray, seed: int
) -> Fit:
    from sklearn.tree import DecisionTreeClassifier

    leaf = parameters.tree_leaf_sequences
    tree = DecisionTreeClassifier(min_samples_leaf=leaf, random_state=seed)
    return tree.fit(features, labels), None


def _fit_logistic_regression(
    parameters: ClassifierParameters, features: FloatArray, labels: IntArray, _seed: int
) -> Fit:
    from sklearn.linear_model import LogisticRegression

    found = LogisticRegression(C=parameters.logistic_penalty, max_iter=1000)
    return found.fit(features, labels), None


CLASSIFIERS = Registry(
    "classifier",
    Classifier(
        "k_nearest_neighbours", "k nearest neighbours",
        fit_nearest_neighbours,
        {"neighbours": (5, 15)}, deterministic=True,
    ),
    Classifier(
        "support_vector_machine", "support vector machine",
        fit_support_vector_machine,
        {"svm_penalty": (1.0, 10.0)}, deterministic=True,
    ),
    Classifier(
        "decision_tree", "decision tree", _fit_decision_tree, {"tree_leaf_sequences": (1, 8)}
    ),
    Classifier(
        "quadratic_discriminant", "quadratic discriminant",
        fit_quadratic_discriminant,
        {"discriminant_shrinkage": (0.9, 0.6, 0.3)}, deterministic=True,
    ),
    Classifier(
        "naive_bayes", "naïve Bayes",
        fit_naive_bayes,
        {"bayes_smoothing": (0.1, 0.01)}, deterministic=True,
    ),
    Classifier(
        "linear_discriminant", "linear discriminant",
        fit_linear_discriminant,
        {"linear_shrinkage": (0.5, 0.1)}, deterministic=True,
    ),
    Classifier(
        "logistic_regression", "logistic regression", _fit_logistic_regression,
        {"logistic_penalty": (0.03, 0.3)}, deterministic=True,
    ),
)  # fmt: skip

ClassifierName = Annotated[str, CLASSIFIERS]
