"""Fit a temperature that calibrates class scores."""

from __future__ import annotations

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.special import log_softmax

from visuohaptic.base.arrays import FloatArray, IntArray

LEAST, MOST = 0.02, 50.0


def fit_temperature(scores: FloatArray, labels: IntArray, doubt: float = 0.0) -> float:
    """Fit the temperature that minimises the mean log loss of the softmax of scores / temperature.

    C. Guo et al., "On calibration of modern neural networks", ICML 2017.

    Parameters
    ----------
    scores : ndarray of shape (n, c)
        Log probabilities of held-out sequences, each row up to a constant.
    labels : ndarray of shape (n,)
        Class index of each sequence.
    doubt : float
        Label smoothing: share of each label that is spread over all classes, in [0, 1).

    Returns
    -------
    float
        The temperature, between `LEAST` and `MOST`.
    """
    classes = scores.shape[1]
    truth = (1 - doubt) * np.eye(classes)[labels] + doubt / classes

    def loss(logarithm: float) -> float:
        return -float((truth * log_softmax(scores * np.exp(-logarithm), axis=1)).sum(axis=1).mean())

    fitted = minimize_scalar(loss, bounds=np.log([LEAST, MOST]), method="bounded")
    return float(np.exp(fitted.x))
