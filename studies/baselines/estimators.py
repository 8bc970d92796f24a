"""Baselines on imprints and poses: the nearest object by kernel density, a multilayer perceptron, and twenty lines."""

from __future__ import annotations

import warnings
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist
from scipy.special import logsumexp
from sklearn.base import BaseEstimator, ClassifierMixin
from sklearn.decomposition import PCA
from sklearn.discriminant_analysis import LinearDiscriminantAnalysis
from sklearn.exceptions import ConvergenceWarning
from sklearn.neural_network import MLPClassifier
from sklearn.pipeline import Pipeline, make_pipeline
from sklearn.preprocessing import FunctionTransformer, StandardScaler

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.features.imprint_shape import describe_imprint_shape

SKIN_COMPONENTS = 6
IMPRINT_COMPONENTS = 20


class NearestObject(ClassifierMixin, BaseEstimator):  # type: ignore[misc]
    """Predict the class of the training object with the highest likelihood of a sequence's touches.

    The likelihood of a touch is a Gaussian kernel density over the training touches of an object, in the space of pose
    and skin. Poses are standardised over the training touches. The skin is six principal components of the
    standardised shape of the imprints. The log likelihoods of a sequence's touches are added.

    Parameters
    ----------
    bandwidth : float
        Standard deviation of the Gaussian, in standard deviations of the pose.
    skin : float
        Standard deviation of the first component of the skin; 0 for poses only.
    tested : int, optional
        The number of touches, from the first, that predictions use. The default is all touches. Training uses all
        touches.
    """

    def __init__(
        self, bandwidth: float = 0.3, skin: float = 0.5, tested: int | None = None
    ) -> None:
        self.bandwidth = bandwidth
        self.skin = skin
        self.tested = tested

    def fit(self, X: NDArray[np.void], y: IntArray, groups: IntArray) -> Self:
        """Fit on sequences (n, t) of `touch_arrays` with classes `y` (n,) and objects `groups` (n,)."""
        self.classes_ = np.unique(y)
        self.pose_ = StandardScaler().fit(_rows(X, "pose"))
        self.components_ = make_pipeline(StandardScaler(), PCA(SKIN_COMPONENTS)).fit(_shapes(X))
        rows, owners = self._describe(X), np.repeat(groups, X.shape[1])
        objects, first = np.unique(groups, return_index=True)
        self.labels_ = y[first]
        self.touches_ = [rows[owners == index] for index in objects]
        return self

    def predict(self, X: NDArray[np.void]) -> NDArray[Any]:
        """Predict the classes (n,) of sequences (n, t)."""
        X = X[:, : self.tested]
        rows = self._describe(X)
        logs = [self._log_density(rows, touches) for touches in self.touches_]
        of_sequences = np.reshape(logs, (len(logs), *X.shape)).sum(axis=2)
        return self.labels_[of_sequences.argmax(axis=0)]

    def _log_density(self, rows: FloatArray, touches: FloatArray) -> FloatArray:
        squares = cdist(rows, touches, "sqeuclidean") / (2 * self.bandwidth**2)
        density: FloatArray = logsumexp(-squares, axis=1) - np.log(len(touches))
        return density

    def _describe(self, sequences: NDArray[np.void]) -> FloatArray:
        """Compute the coordinates of touches in the space of pose and skin, (n * t, 12)."""
        weight = self.skin / np.sqrt(self.components_[-1].explained_variance_[0])
        skin = weight * self.components_.transform(_shapes(sequences))
        return np.concatenate([self.pose_.transform(_rows(sequences, "pose")), skin], axis=1)


class TouchPerceptron(ClassifierMixin, BaseEstimator):  # type: ignore[misc]
    """Multilayer perceptron of single touches. The log probabilities of a sequence's touches are added.

    Parameters
    ----------
    hidden : tuple of int
        Units of each hidden layer.
    penalty : float
        Weight of the penalty on squared weights.
    tested : int, optional
        As in `NearestObject`.
    random_state : int, optional
        Seed of weights and batches.
    """

    def __init__(
        self,
        hidden: tuple[int, ...] = (64,),
        penalty: float = 1e-4,
        tested: int | None = None,
        random_state: int | None = None,
    ) -> None:
        self.hidden = hidden
        self.penalty = penalty
        self.tested = tested
        self.random_state = random_state

    def fit(self, X: NDArray[np.void], y: IntArray) -> Self:
        """Fit on sequences (n, t) of `touch_arrays` with classes `y` (n,)."""
        self.pca_ = PCA(IMPRINT_COMPONENTS, svd_solver="covariance_eigh").fit(_rows(X, "imprint"))
        self.scaling_ = StandardScaler().fit(self._describe(X))
        self.network_ = MLPClassifier(
            self.hidden, alpha=self.penalty, max_iter=100, random_state=self.random_state
        )
        with warnings.catch_warnings():
            # The number of passes is fixed, so the fit need not converge.
            warnings.simplefilter("ignore", ConvergenceWarning)
            self.network_.fit(self.scaling_.transform(self._describe(X)), np.repeat(y, X.shape[1]))
        self.classes_ = self.network_.classes_
        return self

    def predict(self, X: NDArray[np.void]) -> NDArray[Any]:
        """Predict the classes (n,) of sequences (n, t)."""
        X = X[:, : self.tested]
        logs = self.network_.predict_log_proba(self.scaling_.transform(self._describe(X)))
        return self.classes_[logs.reshape(*X.shape, -1).sum(axis=1).argmax(axis=1)]

    def _describe(self, sequences: NDArray[np.void]) -> FloatArray:
        """Compute pose, principal components of the imprint, and sensor size of touches, (n * t, 27)."""
        imprints = self.pca_.transform(_rows(sequences, "imprint"))
        parts = [_rows(sequences, "pose"), imprints, _rows(sequences, "sensor_size")]
        return np.concatenate(parts, axis=1)


def twenty_lines() -> Pipeline:
    """Return an unfitted shrunk linear discriminant of `touch_statistics`, as `examples/twenty_lines.py` has it."""
    discriminant = LinearDiscriminantAnalysis(solver="lsqr", shrinkage="auto")
    return make_pipeline(FunctionTransformer(touch_statistics), discriminant)


def touch_statistics(sequences: NDArray[np.void]) -> FloatArray:
    """Compute statistics of the touches of sequences: (n, t) to (n, 32).

    A touch has eight numbers: mean and deviation of its imprint, position, and normal. Each has a mean, deviation,
    minimum and maximum over the touches.
    """
    imprints = sequences["imprint"].reshape(*sequences.shape, -1).astype(np.float64)
    skin = np.stack([imprints.mean(axis=2), imprints.std(axis=2)], axis=2)
    touches = np.concatenate([skin, sequences["pose"]], axis=2)
    parts = [touches.mean(axis=1), touches.std(axis=1), touches.min(axis=1), touches.max(axis=1)]
    return np.concatenate(parts, axis=1)


def _shapes(sequences: NDArray[np.void]) -> FloatArray:
    """Compute the shape of the imprints and the logarithm of the sensor's size, (n * t, 14)."""
    imprints = sequences["imprint"].reshape(-1, *sequences["imprint"].shape[2:])
    size = np.log(np.maximum(_rows(sequences, "sensor_size"), 1e-6))
    return np.concatenate([describe_imprint_shape(imprints), size], axis=1)


def _rows(sequences: NDArray[np.void], name: str) -> FloatArray:
    rows: FloatArray = np.reshape(sequences[name], (sequences.size, -1)).astype(np.float64)
    return rows
