"""How far an object's touches lie from those of known objects, as sets of points."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.recognition.encoding import fit_standardiser
from visuohaptic.recognition.sequences import TouchSequences
from visuohaptic.tables.phases import NORMAL_NAMES, POINT_NAMES

POSITION_WEIGHT = 2.0
"""How much more a position, in object radii, counts than a unit normal."""

POSE_CUES = frozenset({"pose", "embedding"})
"""With one of these cues, touches are compared by where they are, not by what is felt alone."""


@dataclass(frozen=True)
class KnownTouches:
    """Touches (m, k) of known objects, each feature times its weight, and each object's first place."""

    weights: FloatArray
    touches: NDArray[np.float32]
    starts: IntArray

    def nearest(self, touches: FloatArray) -> float:
        """Give the distance of an object, by all its touches (n, k), from the nearest known one.

        It is the symmetric Chamfer distance (H. G. Barrow et al., IJCAI 1977): the mean distance of
        a touch from the nearest of the other set, both ways.
        """
        return self.distances(touches).nearest(...)

    def distances(self, touches: FloatArray) -> TouchDistances:
        """Give the distances of touches (..., k) from all known ones."""
        from sklearn.metrics.pairwise import euclidean_distances

        every = touches.reshape(-1, touches.shape[-1])
        found = euclidean_distances((every * self.weights).astype(np.float32), self.touches)
        there = np.minimum.reduceat(found, self.starts, axis=1)
        shape = (*touches.shape[:-1], -1)
        return TouchDistances(found.reshape(shape), there.reshape(shape), self.starts)


@dataclass(frozen=True)
class TouchDistances:
    """Distances of an object's touches: from m known ones, (..., m), and from r objects, (..., r)."""

    found: NDArray[np.float32]
    there: NDArray[np.float32]
    starts: IntArray

    def nearest(self, chosen: Any) -> float:
        """Give what `KnownTouches.nearest` does, from the touches of an index alone."""
        there = self.there[chosen].reshape(-1, len(self.starts)).mean(axis=0, dtype=np.float64)
        known = self.found.shape[-1]
        counts = np.diff(np.append(self.starts, known))
        closest = self.found[chosen].reshape(-1, known).min(axis=0).astype(np.float64)
        return float((there + np.add.reduceat(closest, self.starts) / counts).min() / 2)


def keep_touches(sequences: TouchSequences, cues: Collection[str]) -> KnownTouches:
    """Keep the touches of training objects; without one of `POSE_CUES` pose counts nothing.

    All features but pose are standardised, and count together as much as a unit normal.
    """
    names, touches = sequences.feature_names, sequences.features
    count = len(names)
    felt = np.array([name not in {*POINT_NAMES, *NORMAL_NAMES} for name in names])
    scale = fit_standardiser(touches.reshape(-1, count), "standardise").scale
    pose = np.where(np.isin(names, POINT_NAMES), POSITION_WEIGHT, 1.0)
    pose *= not POSE_CUES.isdisjoint(cues)
    weights = np.where(felt, 1 / scale / np.sqrt(max(felt.sum(), 1)), pose)
    order = np.argsort(sequences.object_index, kind="stable")
    _, first = np.unique(sequences.object_index[order], return_index=True)
    kept = (touches[order].reshape(-1, count) * weights).astype(np.float32)
    return KnownTouches(weights, kept, first.astype(np.int64) * touches.shape[1])
