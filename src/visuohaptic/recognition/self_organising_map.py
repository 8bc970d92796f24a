"""Fit a self-organising map that reduces the features of a touch to a few numbers.

Batch training follows T. Kohonen, "Essentials of the self-organizing map", Neural
Networks 37 (2013), section 3.3; online training is MiniSom's.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from hashlib import blake2b

import numpy as np

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import RecognitionError

# The paper says nothing of how its map was trained; these are our choices.
RADII = (2.0, 0.5)
"""Standard deviation of the neighbourhood at the start and at the end, in units: it spans five units, then one unit."""

ORDERING_EPOCHS = 20
"""Passes over the touches while the neighbourhood shrinks (batch)."""

SETTLING_EPOCHS = 200
"""Most passes at the final radius (batch). Training ends when no touch changes its nearest unit, in general long before."""

ONLINE_EPOCHS = 10
"""Passes over the touches (online)."""

LEARNING_RATE = 0.5
"""Learning rate at the start (online), MiniSom's default."""

MOST_REMEMBERED = 4000
"""Most batch maps that a process keeps: five strategies in 81 splits, for several conditions of a study."""


@dataclass(frozen=True)
class SelfOrganisingMap:
    """A fitted map: weights (u, k) of u units, and their positions (u, a) on a lattice with a axes."""

    weights: FloatArray
    positions: FloatArray

    def distances(self, touches: FloatArray) -> FloatArray:
        """Compute the Euclidean distance of each touch (n, k) to each unit, (n, u)."""
        squares = np.square(touches[:, None, :] - self.weights[None, :, :])
        return np.sqrt(squares.sum(axis=-1))

    def nearest(self, touches: FloatArray) -> IntArray:
        """Return the index of the nearest unit of each touch: (n, k) to (n,). Ties go to the first unit."""
        return _nearest(touches, self.weights)


_remembered: dict[tuple[object, ...], SelfOrganisingMap] = {}
"""Batch maps of this process by their rows and positions, the earliest first."""


def fit_map(
    rows: FloatArray, positions: FloatArray, training: str, generator: np.random.Generator
) -> SelfOrganisingMap:
    """Fit a map on rows (n, k) by ``batch`` or ``online`` training; `positions` (u, a) are the units on the lattice.

    Batch maps are remembered, because conditions of a study often differ only in steps behind the map.
    """
    if training == "online":
        return fit_online_map(rows, positions, generator)
    # Sums depend on the order of the numbers in memory, so that the strides belong to the key.
    content = blake2b(rows.tobytes(), digest_size=16).digest()
    key = (content, rows.shape, rows.strides, positions.shape, positions.tobytes())
    if key not in _remembered:
        if len(_remembered) == MOST_REMEMBERED:
            del _remembered[next(iter(_remembered))]
        _remembered[key] = fit_batch_map(rows, positions)
    return _remembered[key]


def fit_batch_map(
    touches: FloatArray,
    positions: FloatArray,
    radii: tuple[float, float] = RADII,
    settling_epochs: int = SETTLING_EPOCHS,
) -> SelfOrganisingMap:
    """Fit a map on touches (n, k) with all touches in each pass; `positions` (u, a) are the units on the lattice.

    In each pass a unit becomes a weighted mean of the touches. The weight is a Gaussian of the lattice distance between
    the unit and the nearest unit of the touch. Its deviation falls from the first to the second of `radii`, in lattice
    units. Training ends when no touch changes its nearest unit, or after `settling_epochs` passes at the final radius.
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
    """Fit a map on touches (n, k) one by one, in random order, with MiniSom.

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
    """Return the positions of units in a row, shape (units, 1)."""
    return np.arange(units, dtype=np.float64)[:, None]


def lattice(axes: int, levels: int) -> FloatArray:
    """Return the positions of the units of a lattice, shape (levels ** axes, axes)."""
    return np.array(list(itertools.product(range(levels), repeat=axes)), dtype=np.float64)


def _principal_weights(touches: FloatArray, positions: FloatArray) -> FloatArray:
    """Return first weights: axes of the lattice along the principal components of the touches, ± 1 deviation long."""
    centre = touches.mean(axis=0)
    _, scales, directions = np.linalg.svd(touches - centre, full_matrices=False)
    axes = min(positions.shape[1], len(scales))
    directions, scales = directions[:axes], scales[:axes] / np.sqrt(len(touches))
    # The signs of an SVD are arbitrary; make the largest loading positive.
    largest = np.argmax(np.abs(directions), axis=1)
    directions = directions * np.sign(directions[np.arange(axes), largest])[:, None]
    span = positions.max(axis=0)[:axes] / 2
    along = (positions[:, :axes] - span) / np.where(span > 0, span, 1)
    return centre + (along * scales) @ directions


def _nearest(touches: FloatArray, weights: FloatArray) -> IntArray:
    # |x - w|² without |x|², which is equal for all units.
    scores = np.square(weights).sum(axis=1) - 2 * (touches @ weights.T)
    return np.argmin(scores, axis=1)


def _weighted_means(
    touches: FloatArray, winners: IntArray, neighbourhood: FloatArray, previous: FloatArray
) -> FloatArray:
    won = np.eye(len(neighbourhood))[winners]
    sums, counts = won.T @ touches, won.sum(axis=0)
    share = (neighbourhood @ counts)[:, None]
    # A unit without any weight keeps its previous weights.
    return np.where(share > 0, (neighbourhood @ sums) / np.where(share > 0, share, 1), previous)
