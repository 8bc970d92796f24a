"""The k nearest neighbours, by one matrix of all distances."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

NeighbourWeights = Literal["uniform", "distance"]


@dataclass(frozen=True)
class NearestNeighbours:
    """Training rows (n, d) that vote; of rows as far away as the last neighbour the first ones do.

    `members` (n, c) is 1 for the class of each row, 0 for the others. With weighting ``distance``
    votes count by its inverse; where some rows are not away at all, these alone.
    """

    classes_: NDArray[np.int64]
    rows: NDArray[np.float64]
    members: NDArray[np.float64]
    neighbours: int
    weighting: NeighbourWeights

    @property
    def n_features_in_(self) -> int:
        """How many features a row has."""
        return self.rows.shape[1]

    def predict_proba(self, rows: NDArray[np.float64]) -> NDArray[np.float64]:
        """Give each class's share of the votes: (m, d) to (m, c)."""
        from scipy.spatial.distance import cdist

        distances = cdist(rows, self.rows, "sqeuclidean")
        votes = (self._nearest(distances) * self._weights(distances)) @ self.members
        found: NDArray[np.float64] = votes / votes.sum(axis=1, keepdims=True)
        return found

    def predict(self, rows: NDArray[np.float64]) -> NDArray[np.int64]:
        """Give the class of the most votes, the first of several: (m, d) to (m,)."""
        found: NDArray[np.int64] = self.classes_[self.predict_proba(rows).argmax(axis=1)]
        return found

    def _nearest(self, distances: NDArray[np.float64]) -> NDArray[np.bool_]:
        last = np.partition(distances, self.neighbours - 1, axis=1)[:, [self.neighbours - 1]]
        nearer, as_far = distances < last, distances == last
        missing = self.neighbours - nearer.sum(axis=1, keepdims=True)
        found: NDArray[np.bool_] = nearer | (as_far & (np.cumsum(as_far, axis=1) <= missing))
        return found

    def _weights(self, squared_distances: NDArray[np.float64]) -> NDArray[np.float64]:
        if self.weighting == "uniform":
            return np.ones(1)
        at_place = squared_distances == 0
        with np.errstate(divide="ignore"):
            weights = 1 / np.sqrt(squared_distances)
        return np.where(at_place.any(axis=1, keepdims=True), at_place, weights)


def fit_nearest_neighbours(
    features: NDArray[np.float64],
    labels: NDArray[np.int64],
    neighbours: int,
    weighting: NeighbourWeights,
) -> NearestNeighbours:
    """Keep training features, (n, d), and their classes, (n,); at most all of them vote."""
    classes = np.unique(labels)
    members = (labels[:, None] == classes).astype(np.float64)
    return NearestNeighbours(classes, features, members, min(neighbours, len(labels)), weighting)
