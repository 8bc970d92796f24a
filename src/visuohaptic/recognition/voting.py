"""One prediction for an object from the predictions for its sequences."""

from __future__ import annotations

import math

import numpy as np

from visuohaptic.base.arrays import FloatArray, IntArray


def vote_credit(
    owners: IntArray, predicted: IntArray, true_class: IntArray
) -> tuple[IntArray, FloatArray]:
    """Give the objects' credits in a majority vote of their sequences.

    First come the objects that have sequences, (m,), ascending, then their credits (m,). An object
    has credit 1 if its class alone has the most votes, 1/k if k classes share the most and its own
    is among them (the mean of a random choice), 0 otherwise. `owners` (n,) and `predicted` (n,) are
    the object and the predicted class of each sequence, `true_class` (o,) is the class of each
    object.
    """
    present, row = np.unique(owners, return_inverse=True)
    classes = int(max(predicted.max(), true_class.max())) + 1
    votes = np.zeros((len(present), classes), dtype=np.int64)
    np.add.at(votes, (row, predicted), 1)
    most = votes == votes.max(axis=1, keepdims=True)
    own = most[np.arange(len(present)), true_class[present]]
    return present, own / most.sum(axis=1)


def evenly_spaced_subsets(total: int, count: int) -> IntArray:
    """Return all ways to choose `count` of `total` indices, evenly spaced on a ring: (k, count).

    Each index is in as many rows as any other. The first ceil(total / count) rows hold all indices, once each where
    `count` divides `total`.
    """
    steps = np.arange(count) * total // count
    turns = np.arange(total // math.gcd(total, count))
    return np.sort((steps + turns[:, None]) % total, axis=1)
