"""One prediction for an object from the predictions for its sequences."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def vote_credit(
    owners: NDArray[np.int64], predicted: NDArray[np.int64], true_class: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Give each object's credit in a majority vote of its sequences.

    An object has credit 1 if its class alone has the most votes, 1/k if k
    classes share the most and its own is among them (the mean of a random choice),
    0 otherwise.

    Parameters
    ----------
    owners : numpy.ndarray
        Shape (n,), int64: the object of each sequence.
    predicted : numpy.ndarray
        Shape (n,), int64: the class predicted for each sequence.
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
