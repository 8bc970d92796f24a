"""The support vector machine: trained by libsvm, answered by one matrix product for all pairs of classes."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import Literal

import numpy as np

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.recognition.classifier_parameters import ClassifierParameters, Fit


@dataclass(frozen=True)
class SupportVectorMachine:
    """Machines that tell two classes apart, one for each pair of k classes.

    `vectors` (s, d) are the support vectors of all pairs, and `weights` (s, p) what each counts in
    each of the p = k (k - 1) / 2 pairs, which are in the order 0 and 1, 0 and 2, …, 1 and 2, … The
    kernel multiplies products, or squared distances, by `scale`; ``poly`` is of the third degree.
    """

    classes_: IntArray
    vectors: FloatArray
    weights: FloatArray
    intercepts: FloatArray
    kernel: Literal["linear", "poly", "rbf"]
    scale: float

    @property
    def n_features_in_(self) -> int:
        """How many features a row has."""
        return self.vectors.shape[1]

    def decision_function(self, rows: FloatArray) -> FloatArray:
        """Give a score a class, (n, d) to (n, k): the pairs that it wins, and less than one half for by how much.

        Of two classes these are the distances from the border, with both signs.
        """
        pairs = self._pairs(rows)
        if len(self.classes_) == 2:
            return np.hstack([pairs, -pairs])
        votes, margins = self._votes(pairs), pairs @ self._signs
        return votes + margins / (3 * (np.abs(margins) + 1))

    def predict(self, rows: FloatArray) -> IntArray:
        """Give the class that wins most pairs, the first of several: (n, d) to (n,)."""
        return self.classes_[self._votes(self._pairs(rows)).argmax(axis=1)]

    def _pairs(self, rows: FloatArray) -> FloatArray:
        """Give the decision of each pair, positive for its first class: (n, d) to (n, p)."""
        values = _KERNELS[self.kernel](rows, self.vectors, self.scale)
        return values @ self.weights + self.intercepts

    def _votes(self, pairs: FloatArray) -> FloatArray:
        won = np.where(pairs > 0, 1.0, -1.0)
        return np.maximum(won[:, :, None] * self._signs, 0).sum(axis=1)

    @property
    def _signs(self) -> FloatArray:
        """Whether a class is the first (1), the second (-1) or none of a pair, shape (p, k)."""
        first, second = _places_of_pairs(len(self.classes_))
        own = np.eye(len(self.classes_))
        return own[first] - own[second]


def fit_support_vector_machine(
    parameters: ClassifierParameters, features: FloatArray, labels: IntArray, _seed: int
) -> Fit:
    """Train every pair of classes on features (n, d) and labels (n,).

    The kernel's scale is 1 / (d × the variance of all features).
    """
    from sklearn.svm import SVC

    kernel, variance = parameters.svm_kernel, float(features.var())
    scale = 1 / (features.shape[1] * variance) if variance else 1.0
    trained = SVC(kernel=kernel, C=parameters.svm_penalty, gamma=scale).fit(features, labels)
    first, second = _places_of_pairs(len(trained.classes_))
    owners = np.repeat(np.arange(len(trained.classes_)), trained.n_support_)
    # Row j - 1 of libsvm's coefficients is, for vectors of class i, for the pair of i and j.
    weights = np.where(owners[:, None] == first, trained.dual_coef_.T[:, second - 1], 0.0)
    weights += np.where(owners[:, None] == second, trained.dual_coef_.T[:, first], 0.0)
    # Of two classes scikit-learn turns the signs.
    sign = -1.0 if len(trained.classes_) == 2 else 1.0
    found = SupportVectorMachine(
        trained.classes_,
        trained.support_vectors_,
        sign * weights,
        sign * trained.intercept_,
        kernel,
        scale,
    )
    return found, None


def _places_of_pairs(classes: int) -> tuple[IntArray, IntArray]:
    first, second = np.array(list(combinations(range(classes), 2))).T
    return first, second


def _linear(rows: FloatArray, vectors: FloatArray, _: float) -> FloatArray:
    return rows @ vectors.T


def _polynomial(rows: FloatArray, vectors: FloatArray, scale: float) -> FloatArray:
    return (scale * (rows @ vectors.T)) ** 3


def _radial(rows: FloatArray, vectors: FloatArray, scale: float) -> FloatArray:
    squares = np.square(rows).sum(axis=1)[:, None] + np.square(vectors).sum(axis=1)
    return np.exp(-scale * np.maximum(squares - 2 * (rows @ vectors.T), 0))


_KERNELS = {"linear": _linear, "poly": _polynomial, "rbf": _radial}
