"""Combine the predictions for the sequences of an object to one prediction."""

from __future__ import annotations

import math

import numpy as np

from visuohaptic.base.arrays import FloatArray, IntArray


def vote_credit(
    owners: IntArray, predicted: IntArray, true_class: IntArray
) -> tuple[IntArray, FloatArray]:
    """Compute the credit of each object in a majority vote of its sequences.

    Parameters
    ----------
    owners, predicted : ndarray of shape (n,)
        Object and predicted class of each sequence.
    true_class : ndarray of shape (o,)
        Class of each object.

    Returns
    -------
    objects : ndarray of shape (m,)
        Objects that have sequences, ascending.
    credits : ndarray of shape (m,)
        1 if only the true class has the most votes, 1/k if k classes including the true one share the most (the mean
        of a random choice), and 0 otherwise.
    """
    present, row = np.unique(owners, return_inverse=True)
    classes = int(max(predicted.max(), true_class.max())) + 1
    votes = np.zeros((len(present), classes), dtype=np.int64)
    np.add.at(votes, (row, predicted), 1)
    most = votes == votes.max(axis=1, keepdims=True)
    true_is_most = most[np.arange(len(present)), true_class[present]]
    return present, true_is_most / most.sum(axis=1)


def evenly_spaced_subsets(total: int, count: int) -> IntArray:
    """Return all ways to choose `count` of `total` indices, evenly spaced on a ring: (k, count).

    Each index is in as many rows as any other. The first ceil(total / count) rows hold all indices, once each where
    `count` divides `total`.
    """
    steps = np.arange(count) * total // count
    turns = np.arange(total // math.gcd(total, count))
    return np.sort((steps + turns[:, None]) % total, axis=1)
