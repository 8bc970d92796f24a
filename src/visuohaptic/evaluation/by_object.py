"""Accuracies per object from accuracies per object and split."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pyarrow as pa

from visuohaptic.base.arrays import FloatArray
from visuohaptic.tables.phases import owners_of
from visuohaptic.tables.schema import matrix


@dataclass(frozen=True)
class ObjectMeans:
    """Accuracies (o,) of o objects, pairs of class and name, sorted, and their weights (o,).

    The mean of the accuracies by the weights is the mean over splits. `share` is each row's share of the test
    sequences of its split.
    """

    objects: tuple[tuple[str, str], ...]
    accuracy: FloatArray
    weights: FloatArray
    share: FloatArray


def average_by_object(rows: pa.Table, counted: str = "sequences") -> ObjectMeans:
    """Average each object's `accuracy` over the splits and repeats that tested it.

    Parameters
    ----------
    rows : pyarrow.Table
        Columns ``class``, ``object``, ``split``, ``repeat``, ``accuracy`` and `counted`, one row per object,
        split and repeat, such as rows of `tables.STUDY` of one condition, pipeline, strategy and classifier.
    counted : str
        The column with the number of test sequences.

    Returns
    -------
    ObjectMeans
        The accuracies, by object.
    """
    owners = owners_of(rows)
    objects = tuple(sorted(set(owners)))
    places = {owner: place for place, owner in enumerate(objects)}
    owner = np.array([places[one] for one in owners])
    split, repeat, count, accuracy = matrix(rows, ["split", "repeat", counted, "accuracy"]).T
    _, run = np.unique(split * (repeat.max() + 1) + repeat, return_inverse=True)
    share = count / np.bincount(run, weights=count)[run]
    weights: FloatArray = np.bincount(owner, weights=share).astype(np.float64)
    # Shares times counts are whole numbers but for rounding, except where viewpoints vote.
    right = np.where(count > 1, np.rint(accuracy * count), accuracy)
    means = np.bincount(owner, weights=share * right / count) / weights
    return ObjectMeans(objects, means, weights, share)
