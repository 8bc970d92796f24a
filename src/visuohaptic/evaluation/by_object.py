"""Accuracies per object from accuracies per object and split."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pyarrow as pa

from visuohaptic.base.arrays import FloatArray
from visuohaptic.tables.phases import owners_of
from visuohaptic.tables.schema import matrix


@dataclass(frozen=True)
class ObjectAccuracies:
    """Accuracies of the objects that one strategy tested, such as fixation or one draw of a random strategy.

    Attributes
    ----------
    objects : tuple of (str, str)
        Class and name of o objects. Accuracies that are compared need the same order of objects.
    accuracy : array (o,), float64
        For each object, the mean accuracy over the splits that tested the object.
    weights : array (o,), float64
        The objects' weights in `mean`. Only their ratios count.
    """

    objects: tuple[tuple[str, str], ...]
    accuracy: FloatArray
    weights: FloatArray

    @property
    def classes(self) -> tuple[str, ...]:
        """The class of each object."""
        return tuple(category for category, _ in self.objects)

    @property
    def mean(self) -> float:
        """The weighted mean of `accuracy`; with all tested objects, the mean over splits of each split's accuracy."""
        return float(self.weights @ self.accuracy / self.weights.sum())


def average_by_object(
    rows: pa.Table, counted: str = "sequences"
) -> tuple[ObjectAccuracies, FloatArray]:
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
    accuracies : ObjectAccuracies
        The objects in the order of their names. The weighted mean of the accuracies equals the mean over splits.
    share : array (n,), float64
        For each of the n rows, its share of the test sequences of its split.
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
    return ObjectAccuracies(objects, means, weights), share
