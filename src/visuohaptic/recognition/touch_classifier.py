"""Pipeline `best` with scikit-learn's interface."""

from __future__ import annotations

from typing import Any, Self

import numpy as np
import pyarrow as pa
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, ClassifierMixin
from sklearn.utils import check_random_state
from sklearn.utils.multiclass import check_classification_targets
from sklearn.utils.validation import check_is_fitted, validate_data

from visuohaptic.errors import RecognitionError
from visuohaptic.recognition.certainty import one_classifier
from visuohaptic.recognition.descriptors import describe_sequences, draw_waves
from visuohaptic.recognition.experiment import gather_pipeline
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.pooling import Ballots
from visuohaptic.recognition.tuning import fit_best_classifiers
from visuohaptic.seeds import spawn_generator


class TouchClassifier(ClassifierMixin, BaseEstimator):  # type: ignore[misc]
    """Classify objects from descriptors of sequences of touches, such as `touch_descriptors` gives.

    A row is a sequence; `groups` says which rows are of one object. Everything is chosen and calibrated
    by folds of whole objects.

    Parameters
    ----------
    classifier : str
        One of `CLASSIFIERS`; a linear discriminant of bags of rows answers beside it.
    parameters : RecognitionParameters or None
        All else; None for the defaults.
    random_state : int, RandomState or None
        Deals the objects over folds.

    Attributes
    ----------
    classes_ : numpy.ndarray
        The classes, sorted.
    n_features_in_ : int
        Columns of the training rows.

    Examples
    --------
    >>> import numpy as np
    >>> rows = np.random.default_rng(0).normal(size=(40, 6)) + np.repeat([[0.0], [3.0]], 20, axis=0)
    >>> fitted = TouchClassifier(random_state=0).fit(rows, np.repeat(["cup", "lamp"], 20))
    >>> fitted.predict([[3.0] * 6]).tolist()
    ['lamp']
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
        """Train.

        Parameters
        ----------
        X : array_like
            Shape (n, d).
        y : array_like
            Shape (n,): classes.
        groups : array_like, optional
            Shape (n,): the object of each row; without it each row is an object of its own.

        Returns
        -------
        TouchClassifier
            Itself.

        Raises
        ------
        ValueError
            If rows, classes or groups are not usable.
        RecognitionError
            If no row differs from another.
        """
        rows, y = validate_data(self, X, y, dtype=np.float64)
        check_classification_targets(y)
        self.classes_, labels = np.unique(y, return_inverse=True)
        if len(self.classes_) < 2:
            raise ValueError("There is one class; at least two are needed to distinguish them.")
        owners = _codes_of(groups, len(rows))
        crossing = [
            owner for owner in np.unique(owners) if len(np.unique(labels[owners == owner])) > 1
        ]
        if crossing:
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

    def predict_proba(self, X: ArrayLike) -> NDArray[np.float64]:
        """Give the class probabilities of each row by itself: (n, d) to (n, c)."""
        return self._ballots(X).alone()

    def predict(self, X: ArrayLike) -> NDArray[Any]:
        """Classify each row by itself: (n, d) to (n,)."""
        found = self.predict_proba(X)
        return self.classes_[found.argmax(axis=1)]

    def predict_objects(
        self, X: ArrayLike, groups: ArrayLike
    ) -> tuple[NDArray[Any], NDArray[np.float64]]:
        """Give the objects, sorted, and the class probabilities of each from all its rows together.

        Parameters
        ----------
        X : array_like
            Shape (n, d).
        groups : array_like
            Shape (n,): the object of each row.

        Returns
        -------
        objects : numpy.ndarray
            Shape (m,).
        probabilities : numpy.ndarray
            Shape (m, c), float64.
        """
        objects, codes = np.unique(np.asarray(groups), return_inverse=True)
        ballots = self._ballots(X)
        if len(codes) != len(ballots.probabilities):
            raise ValueError(
                f"There are {len(ballots.probabilities)} rows and {len(codes)} groups."
            )
        return objects, ballots.together(codes == np.arange(len(objects))[:, None])

    def _ballots(self, X: ArrayLike) -> Ballots:
        check_is_fitted(self, "tuned_")
        rows = validate_data(self, X, dtype=np.float64, reset=False)
        return self.tuned_.ballots(self.projection_.apply(rows))


def touch_descriptors(
    features: pa.Table, parameters: RecognitionParameters | None = None, seed: int = 2018
) -> tuple[NDArray[np.float64], NDArray[np.str_], NDArray[np.str_]]:
    """Give what `TouchClassifier` takes from a table of features.

    Parameters
    ----------
    features : pyarrow.Table
        Rows of `tables.FEATURES` of one strategy, whole sequences.
    parameters : RecognitionParameters, optional
        Touches, cues and waves.
    seed : int
        Draws the waves; the same for training and test.

    Returns
    -------
    descriptors : numpy.ndarray
        Shape (s, d), float64.
    classes, objects : numpy.ndarray
        Shape (s,): of each sequence.

    Raises
    ------
    RecognitionError
        If the features don't allow it.
    """
    chosen = parameters or RecognitionParameters()
    if not features.num_rows:
        raise RecognitionError("The features hold no touches.")
    sequences = gather_pipeline(features, chosen, "best")
    waves = draw_waves(chosen.best, spawn_generator(seed, "recognition", "waves"))
    found = describe_sequences(sequences.features, sequences.feature_names, waves, chosen.best)
    owners = [sequences.objects[place] for place in sequences.object_index]
    return (
        found,
        np.array([category for category, _ in owners]),
        np.array([f"{category}/{name}" for category, name in owners]),
    )


def _codes_of(groups: ArrayLike | None, count: int) -> NDArray[np.int64]:
    if groups is None:
        return np.arange(count, dtype=np.int64)
    _, codes = np.unique(np.asarray(groups), return_inverse=True)
    if len(codes) != count:
        raise ValueError(f"There are {count} rows and {len(codes)} groups.")
    return codes.astype(np.int64)
