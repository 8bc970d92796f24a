"""A self-organising map that reduces a touch's features to a few numbers.

Batch training after T. Kohonen, "Essentials of the self-organizing map", Neural
Networks 37 (2013), section 3.3; online training is MiniSom's.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import RecognitionError

# The paper says nothing of how its map was trained; these are our choices.
RADII = (2.0, 0.5)
"""The neighbourhood's standard deviation at the start and at the end, units: from across five units to each alone."""

ORDERING_EPOCHS = 20
"""Passes over the touches while the neighbourhood shrinks (batch)."""

SETTLING_EPOCHS = 200
"""Most passes at the final radius (batch): training ends where no touch changes its nearest unit, long before."""

ONLINE_EPOCHS = 10
"""Passes over the touches (online)."""

LEARNING_RATE = 0.5
"""The first learning rate (online), MiniSom's own default."""


@dataclass(frozen=True)
class SelfOrganisingMap:
    """A fitted map of u units with weights (u, k) at positions (u, a) of a lattice of a axes."""

    weights: FloatArray
    positions: FloatArray

    def distances(self, touches: FloatArray) -> FloatArray:
        """Give the Euclidean distances of touches (n, k) to the units, (n, u)."""
        squares = np.square(touches[:, None, :] - self.weights[None, :, :])
        return np.sqrt(squares.sum(axis=-1))

    def nearest(self, touches: FloatArray) -> IntArray:
        """Give the nearest unit of n touches, shape (n,); the first one where two are as near."""
        return _nearest(touches, self.weights)


def fit_map(
    rows: FloatArray, positions: FloatArray, training: str, generator: np.random.Generator
) -> SelfOrganisingMap:
    """Fit a map on rows (n, k), by ``batch`` or ``online`` training; `positions` (u, a) are the lattice."""
    if training == "batch":
        return fit_batch_map(rows, positions)
    return fit_online_map(rows, positions, generator)


def fit_batch_map(
    touches: FloatArray,
    positions: FloatArray,
    radii: tuple[float, float] = RADII,
    settling_epochs: int = SETTLING_EPOCHS,
) -> SelfOrganisingMap:
    """Fit a map on touches (n, k), all at once in each pass; `positions` (u, a) are the lattice.

    Each unit becomes the mean of the touches, weighted by a Gaussian of the lattice distance to the
    touch's nearest unit, until no touch changes its nearest unit.
    """
    weights = _principal_weights(touches, positions)
    squares = np.square(positions[:, None, :] - positions[None, :, :]).sum(axis=-1)
    winners = _nearest(touches, weights)
    for radius in np.geomspace(*radii, ORDERING_EPOCHS):
        neighbourhood = np.exp(-squares / (2 * radius**2))
        weights = _weighted_means(touches, winners, neighbourhood, weights)
        winners = _nearest(touches, weights)
    for _ in range(settling_epochs):
        weights = _weighted_means(touches, winners, neighbourhood, weights)
        previous, winners = winners, _nearest(touches, weights)
        if np.array_equal(previous, winners):
            break
    return SelfOrganisingMap(weights, positions)


def fit_online_map(
    touches: FloatArray, positions: FloatArray, generator: np.random.Generator
) -> SelfOrganisingMap:
    """Fit a map touch by touch, (n, k), with MiniSom, in random order.

    Raises `RecognitionError` if the lattice has more than two axes.
    """
    from minisom import MiniSom

    if positions.shape[1] > 2:
        raise RecognitionError(
            f"recognition.self_organising_map.training is online and the lattice has "
            f"{positions.shape[1]} axes; MiniSom has two at most, batch has no limit."
        )
    shape = np.ones(2, dtype=np.int64)
    shape[: positions.shape[1]] = positions.max(axis=0).astype(np.int64) + 1
    som = MiniSom(
        int(shape[0]),
        int(shape[1]),
        touches.shape[1],
        sigma=RADII[0],
        learning_rate=LEARNING_RATE,
        random_seed=int(generator.integers(2**31)),
    )
    som.get_weights()[:] = _principal_weights(touches, positions).reshape(*shape, -1)
    som.train(touches, ONLINE_EPOCHS * len(touches), random_order=True)
    return SelfOrganisingMap(som.get_weights().reshape(-1, touches.shape[1]).copy(), positions)


def line(units: int) -> FloatArray:
    """Give the places of units in a row, shape (units, 1)."""
    return np.arange(units, dtype=np.float64)[:, None]


def lattice(axes: int, levels: int) -> FloatArray:
    """Give the places of a lattice's units, shape (levels ** axes, axes)."""
    return np.array(list(itertools.product(range(levels), repeat=axes)), dtype=np.float64)


def _principal_weights(touches: FloatArray, positions: FloatArray) -> FloatArray:
    """Lay the lattice's axes along the touches' principal components, ± 1 sd long."""
    centre = touches.mean(axis=0)
    _, scales, directions = np.linalg.svd(touches - centre, full_matrices=False)
    axes = min(positions.shape[1], len(scales))
    directions, scales = directions[:axes], scales[:axes] / np.sqrt(len(touches))
    # SVD signs are arbitrary; make the largest loading positive.
    largest = np.argmax(np.abs(directions), axis=1)
    directions = directions * np.sign(directions[np.arange(axes), largest])[:, None]
    span = positions.max(axis=0)[:axes] / 2
    along = (positions[:, :axes] - span) / np.where(span > 0, span, 1)
    return centre + (along * scales) @ directions


def _nearest(touches: FloatArray, weights: FloatArray) -> IntArray:
    # |x - w|² without |x|², which is the same for every unit.
    scores = np.square(weights).sum(axis=1) - 2 * (touches @ weights.T)
    return np.argmin(scores, axis=1)


def _weighted_means(
    touches: FloatArray, winners: IntArray, neighbourhood: FloatArray, previous: FloatArray
) -> FloatArray:
    won = np.eye(len(neighbourhood))[winners]
    sums, counts = won.T @ touches, won.sum(axis=0)
    share = (neighbourhood @ counts)[:, None]
    # A unit that no touch reaches stays where it was.
    return np.where(share > 0, (neighbourhood @ sums) / np.where(share > 0, share, 1), previous)
