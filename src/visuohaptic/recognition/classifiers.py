"""Names of classifiers: the paper's five in the order of its Table 1, then others."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Any

from visuohaptic.base.registry import Registry
from visuohaptic.recognition.classifier_parameters import ClassifierParameters


@dataclass(frozen=True)
class Classifier:
    """A classifier of the registry.

    Attributes
    ----------
    name : str
        Name in parameters and tables.
    label : str
        Name in the report.
    make : callable
        ``make(settings)`` returns an unfitted scikit-learn classifier with the settings of a `ClassifierParameters`.
    """

    name: str
    label: str
    make: Callable[[ClassifierParameters], Any]

    @classmethod
    def of(cls, name: str, estimator: Any, label: str = "") -> Classifier:
        """Return an entry for any scikit-learn classifier.

        Parameters
        ----------
        name : str
            Name in parameters and tables.
        estimator : object
            Unfitted; each fit takes a copy. A `random_state` is replaced by the seed of the fit.
        label : str, optional
            Name in the report; by default the name with blanks.
        """
        return cls(name, label or name.replace("_", " "), lambda _: estimator)


def _make(name: str, settings: ClassifierParameters) -> Any:
    from visuohaptic.recognition.estimators import MAKERS

    return MAKERS[name](settings)


CLASSIFIERS = Registry(
    "classifier",
    *(
        Classifier(name, label, partial(_make, name))
        for name, label in {
            "k_nearest_neighbours": "k nearest neighbours",
            "support_vector_machine": "support vector machine",
            "decision_tree": "decision tree",
            "quadratic_discriminant": "quadratic discriminant",
            "naive_bayes": "naïve Bayes",
            "linear_discriminant": "linear discriminant",
            "logistic_regression": "logistic regression",
        }.items()
    ),
)

ClassifierName = Annotated[str, CLASSIFIERS]
