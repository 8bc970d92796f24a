"""Pipeline `best` with scikit-learn's interface."""

from __future__ import annotations

from typing import Any, Self

import numpy as np
import pyarrow as pa
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, ClassifierMixin
from sklearn.utils import check_consistent_length, check_random_state
from sklearn.utils.multiclass import check_classification_targets
from sklearn.utils.validation import check_is_fitted, validate_data

from visuohaptic.base.arrays import FloatArray
from visuohaptic.recognition.certainty import one_classifier
from visuohaptic.recognition.descriptors import describe_all
from visuohaptic.recognition.experiment import gather_pipeline
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.pooling import Ballots
from visuohaptic.recognition.tuning import fit_best_classifiers


class TouchClassifier(ClassifierMixin, BaseEstimator):  # type: ignore[misc]
    """Classify objects from descriptors of sequences of touches, such as `touch_descriptors` gives.

    A row is a sequence; `groups` says which rows are of one object. Everything is chosen and
    calibrated by folds of whole objects, which `random_state` deals. `classifier` is one of
    `CLASSIFIERS`; a linear discriminant of bags of rows answers beside it. After `fit`, `classes_`
    are sorted.
    """

    def __init__(
        self,
        classifier: str = "support_vector_machine",
        parameters: RecognitionParameters | None = None,
        random_state: Any = None,
    ) -> None:
        self.classifier = classifier
        self.parameters = parameters
        self.random_state = random_state

    def fit(self, X: ArrayLike, y: ArrayLike, groups: ArrayLike | None = None) -> Self:
        """Train on rows (n, d) of classes (n,); without groups (n,) each row is an object of its own."""
        rows, y = validate_data(self, X, y, dtype=np.float64)
        check_classification_targets(y)
        self.classes_, labels = np.unique(y, return_inverse=True)
        if len(self.classes_) < 2:
            raise ValueError("There is one class; at least two are needed to distinguish them.")
        check_consistent_length(rows, groups)
        of_own = np.arange(len(rows)) if groups is None else np.asarray(groups)
        _, owners = np.unique(of_own, return_inverse=True)
        if len(np.unique([owners, labels], axis=1).T) > len(np.unique(owners)):
            raise ValueError("A group holds rows of two classes; an object has one.")
        seed = check_random_state(self.random_state).randint(2**31)
        self.projection_, [(_, self.tuned_, _)] = fit_best_classifiers(
            rows,
            labels,
            owners,
            len(self.classes_),
            one_classifier(self.parameters or RecognitionParameters(), self.classifier),
            np.random.default_rng(seed),
        )
        return self

    def predict_proba(self, X: ArrayLike) -> FloatArray:
        """Give the class probabilities of each row by itself: (n, d) to (n, c)."""
        return self._ballots(X).alone()

    def predict(self, X: ArrayLike) -> NDArray[Any]:
        """Classify each row by itself: (n, d) to (n,)."""
        found = self.predict_proba(X)
        return self.classes_[found.argmax(axis=1)]

    def predict_objects(self, X: ArrayLike, groups: ArrayLike) -> tuple[NDArray[Any], FloatArray]:
        """Give the objects (m,) and their class probabilities (m, c), from all rows of each.

        Objects are sorted; `groups` (n,) is the object of each row of `X`, (n, d).
        """
        objects, codes = np.unique(np.asarray(groups), return_inverse=True)
        check_consistent_length(X, codes)
        return objects, self._ballots(X).together(codes == np.arange(len(objects))[:, None])

    def _ballots(self, X: ArrayLike) -> Ballots:
        check_is_fitted(self, "tuned_")
        rows = validate_data(self, X, dtype=np.float64, reset=False)
        return self.tuned_.ballots(self.projection_.apply(rows))


def touch_descriptors(
    features: pa.Table, parameters: RecognitionParameters | None = None, seed: int = 2018
) -> tuple[FloatArray, NDArray[np.str_], NDArray[np.str_]]:
    """Give what `TouchClassifier` takes: descriptors (s, d), classes (s,) and objects (s,).

    `features` are rows of `tables.FEATURES` of one strategy, whole sequences. The seed draws the
    waves and is the same for training and test. Raises `RecognitionError` if the features don't
    allow it.
    """
    chosen = parameters or RecognitionParameters()
    sequences = gather_pipeline(features, chosen, "best")
    owners = [sequences.objects[place] for place in sequences.object_index]
    return (
        describe_all(sequences, chosen.best, seed),
        np.array([category for category, _ in owners]),
        np.array([f"{category}/{name}" for category, name in owners]),
    )
