"""The k nearest neighbours, by one matrix of all distances."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.recognition.classifier_parameters import ClassifierParameters, Fit


@dataclass(frozen=True)
class NearestNeighbours:
    """Training rows (n, d) that vote; of rows as far away as the last neighbour the first ones do.

    `members` (n, c) is 1 for the class of each row, 0 for the others. All votes count alike.
    """

    classes_: IntArray
    rows: FloatArray
    members: FloatArray
    neighbours: int

    @property
    def n_features_in_(self) -> int:
        """How many features a row has."""
        return self.rows.shape[1]

    def predict_proba(self, rows: FloatArray) -> FloatArray:
        """Give each class's share of the votes: (m, d) to (m, c)."""
        from scipy.spatial.distance import cdist

        distances = cdist(rows, self.rows, "sqeuclidean")
        votes = self._nearest(distances) @ self.members
        return votes / votes.sum(axis=1, keepdims=True)

    def predict(self, rows: FloatArray) -> IntArray:
        """Give the class of the most votes, the first of several: (m, d) to (m,)."""
        return self.classes_[self.predict_proba(rows).argmax(axis=1)]

    def _nearest(self, distances: FloatArray) -> BoolArray:
        last = np.partition(distances, self.neighbours - 1, axis=1)[:, [self.neighbours - 1]]
        nearer, as_far = distances < last, distances == last
        missing = self.neighbours - nearer.sum(axis=1, keepdims=True)
        return nearer | (as_far & (np.cumsum(as_far, axis=1) <= missing))


def fit_nearest_neighbours(
    parameters: ClassifierParameters, features: FloatArray, labels: IntArray, _seed: int
) -> Fit:
    """Keep training features, (n, d), and their classes, (n,); at most all of them vote."""
    classes = np.unique(labels)
    members = (labels[:, None] == classes).astype(np.float64)
    count = min(parameters.neighbours, len(labels))
    found = NearestNeighbours(classes, features, members, count)
    if count == parameters.neighbours:
        return found, None
    return found, f"{count} neighbours, for there are no more training sequences"
