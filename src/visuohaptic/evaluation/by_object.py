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
    """Mean accuracy of each object.

    Attributes
    ----------
    objects : tuple of (str, str)
        Class and name of o objects, sorted.
    accuracy : array (o,), float64
        The objects' accuracies.
    weights : array (o,), float64
        The objects' weights. The weighted mean of the accuracies equals the mean over splits.
    share : array (n,), float64
        For each of the n rows, its share of the test sequences of its split.
    """

    objects: tuple[tuple[str, str], ...]
    accuracy: FloatArray
    weights: FloatArray
    share: FloatArray


def average_by_object(rows: pa.Table, counted: str = "sequences") -> ObjectMeans:
    """Average each object's accuracy over the splits and repeats that tested the object.

    Parameters
    ----------
    rows : pyarrow.Table
        Columns ``class``, ``object``, ``split``, ``repeat``, ``accuracy`` and `counted`, with one row per object,
        split and repeat: rows of `tables.STUDY` of one condition, pipeline, strategy and classifier.
    counted : str
        The column with the number of test sequences.

    Returns
    -------
    ObjectMeans
        The mean accuracies and the weights.
    """
    owners = owners_of(rows)
    objects = tuple(sorted(set(owners)))
    index_of = {key: index for index, key in enumerate(objects)}
    owner = np.array([index_of[key] for key in owners])
    split, repeat, count, accuracy = matrix(rows, ["split", "repeat", counted, "accuracy"]).T
    _, pair = np.unique(split * (repeat.max() + 1) + repeat, return_inverse=True)
    share = count / np.bincount(pair, weights=count)[pair]
    weights: FloatArray = np.bincount(owner, weights=share).astype(np.float64)
    # Accuracy times count is a whole number up to rounding, except for votes of viewpoints (count 1).
    correct = np.where(count > 1, np.rint(accuracy * count), accuracy)
    means = np.bincount(owner, weights=share * correct / count) / weights
    return ObjectMeans(objects, means, weights, share)
