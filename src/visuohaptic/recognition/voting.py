"""One answer for an object from the answers to its sequences."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def vote_credit(
    owners: NDArray[np.int64], predicted: NDArray[np.int64], true_class: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Give each object's credit in a majority vote of its sequences.

    An object has credit 1 where its class has the most votes alone, 1/k where k
    classes share the most and its own is among them (what tossing for it would
    give on average), 0 otherwise.

    Parameters
    ----------
    owners : numpy.ndarray
        Shape (n,), int64: the object of each sequence.
    predicted : numpy.ndarray
        Shape (n,), int64: the class named for each sequence.
    true_class : numpy.ndarray
        Shape (o,), int64: the class of each object, indexed by `owners`.

    Returns
    -------
    owners : numpy.ndarray
        Shape (m,), int64: the objects that have sequences, ascending.
    credit : numpy.ndarray
        Shape (m,), float64, within [0, 1].
    """
    present, row = np.unique(owners, return_inverse=True)
    classes = int(max(predicted.max(), true_class.max())) + 1
    votes = np.zeros((len(present), classes), dtype=np.int64)
    np.add.at(votes, (row, predicted), 1)
    most = votes == votes.max(axis=1, keepdims=True)
    own = most[np.arange(len(present)), true_class[present]]
    return present, own / most.sum(axis=1)


def soft_vote(owners: NDArray[np.int64], probabilities: NDArray[np.float64]) -> NDArray[np.int64]:
    """Name each object by the mean probabilities of its sequences.

    Parameters
    ----------
    owners : numpy.ndarray
        Shape (n,), int64: the object of each sequence, 0 to m - 1, each at least once.
    probabilities : numpy.ndarray
        Shape (n, c), float64.

    Returns
    -------
    numpy.ndarray
        Shape (m,), int64: the class named for each object.
    """
    sums = np.zeros((int(owners.max()) + 1, probabilities.shape[1]))
    np.add.at(sums, owners, probabilities)
    return sums.argmax(axis=1)
