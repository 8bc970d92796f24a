"""How well a saliency map predicts a target, or where people looked."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .errors import AttentionError


def area_under_curve(
    saliency: NDArray[np.float32], target: NDArray[np.bool_], mask: NDArray[np.bool_]
) -> float:
    """Give the probability that a pixel of the target is more salient than another pixel.

    Parameters
    ----------
    saliency : numpy.ndarray
        Shape (h, w).
    target : numpy.ndarray
        Shape (h, w), bool: pixels of the target, or fixated ones.
    mask : numpy.ndarray
        Shape (h, w), bool: pixels that count; those outside the target are compared with it.

    Returns
    -------
    float
        0 to 1, chance 0.5; ties count half. It is the area under the receiver
        operating characteristic (AUC-Judd of Bylinskii et al. 2019, "What do
        different evaluation metrics tell us about saliency models?").

    Raises
    ------
    AttentionError
        If the target or the rest of the mask is empty.
    """
    from scipy.stats import rankdata

    _check_target(target, mask)
    hits = target[mask]
    ranks = rankdata(saliency[mask])
    count = int(hits.sum())
    above = float(ranks[hits].sum()) - 0.5 * count * (count + 1)
    return above / (count * (len(hits) - count))


def normalised_scanpath_saliency(
    saliency: NDArray[np.float32], target: NDArray[np.bool_], mask: NDArray[np.bool_]
) -> float:
    """Give the target's mean saliency in standard deviations above the mean.

    Parameters
    ----------
    saliency : numpy.ndarray
        Shape (h, w).
    target : numpy.ndarray
        Shape (h, w), bool: pixels of the target, or fixated ones.
    mask : numpy.ndarray
        Shape (h, w), bool: pixels that count.

    Returns
    -------
    float
        0 at chance (NSS, Peters et al. 2005, "Components of bottom-up gaze
        allocation in natural images"); 0 for a map without variation.

    Raises
    ------
    AttentionError
        If the target or the rest of the mask is empty.
    """
    _check_target(target, mask)
    values = saliency[mask].astype(np.float64)
    deviation = float(values.std())
    if deviation == 0.0:
        return 0.0
    return (float(values[target[mask]].mean()) - float(values.mean())) / deviation


def _check_target(target: NDArray[np.bool_], mask: NDArray[np.bool_]) -> None:
    inside = int((target & mask).sum())
    if not 0 < inside < int(mask.sum()):
        raise AttentionError(
            f"the target covers {inside} of {int(mask.sum())} pixels; "
            "at least one, and not all of them, is needed."
        )
