"""How well objects are classified from single tactile images, over random splits of the images.

This is the protocol of Gandarias, García-Cerezo and Gómez-de-Gabriel ("CNN-based methods for object
recognition with high-resolution tactile sensors", IEEE Sensors Journal 19(16), 2019): of each class a
share of the images trains, the others are tested, and the mean of 20 such splits counts. Images of one
object are on both sides, so this tells known objects apart; it says nothing of new ones.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from visuohaptic.errors import RecognitionError

PENALTY = 30.0
"""Penalty C of the support vector machine."""


def split_accuracies(
    groups: Mapping[str, NDArray[np.float64]],
    classes: Sequence[str],
    splits: int,
    train_share: float,
    generator: np.random.Generator,
) -> NDArray[np.float64]:
    """Give the share (splits,) of test images that a support vector machine classifies correctly.

    Of the n images of `classes`, `groups` hold features (n, k) each, which count alike, whatever their
    width; `train_share` of each class's images trains.
    """
    from threadpoolctl import threadpool_limits

    names, labels = np.unique(np.asarray(classes), return_inverse=True)
    if len(names) < 2:
        raise RecognitionError(f"There is one class ({names[0]}); at least two are needed.")
    counts = np.bincount(labels)
    tested = np.round(counts * (1 - train_share)).astype(int)
    lacking = (tested < 1) | (tested >= counts)
    if lacking.any():
        raise RecognitionError(
            f"Class {names[lacking][0]} has {counts[lacking][0]} images, which can't be divided into "
            f"{train_share:g} to train and the rest to test."
        )
    with threadpool_limits(limits=1):
        return np.array(
            [_accuracy(groups, labels, _draw(labels, tested, generator)) for _ in range(splits)]
        )


def _draw(
    labels: NDArray[np.int64], tested: NDArray[np.int64], generator: np.random.Generator
) -> NDArray[np.bool_]:
    """Choose so many test images of each class; true where an image is tested."""
    chosen = np.zeros(len(labels), dtype=bool)
    for place, count in enumerate(tested):
        chosen[generator.permutation(np.flatnonzero(labels == place))[:count]] = True
    return chosen


def _accuracy(
    groups: Mapping[str, NDArray[np.float64]],
    labels: NDArray[np.int64],
    tested: NDArray[np.bool_],
) -> float:
    from sklearn.svm import SVC

    from visuohaptic.recognition.encoding import fit_standardiser

    parts = [
        fit_standardiser(values[~tested], "standardise").apply(values) / np.sqrt(values.shape[1])
        for values in groups.values()
    ]
    rows = np.concatenate(parts, axis=1)
    machine = SVC(C=PENALTY, gamma=1 / max(rows[~tested].var(axis=0).sum(), 1e-12))
    machine.fit(rows[~tested], labels[~tested])
    return float((machine.predict(rows[tested]) == labels[tested]).mean())
