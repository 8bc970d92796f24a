"""A rule that stops touching where the next touch brings less than its price."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class StoppingRule:
    """After each touch, go on while a second of touching is expected to bring more than `worth`.

    Attributes
    ----------
    pace : numpy.ndarray
        Shape (k + 1,), float64: the share of the doubt that a second of touching removes after 0 to
        k touches; the last is 0.
    worth : float
        Probability of a correct answer that a second must bring.
    """

    pace: NDArray[np.float64]
    worth: float

    def touches(self, confidence: NDArray[np.float64]) -> NDArray[np.int64]:
        """Give the touches that are made, (n,), of the probability of the class after each, (k + 1, n)."""
        return np.argmax(expected_gain(self.pace, confidence) <= self.worth, axis=0)


def learn_pace(
    correct: NDArray[np.bool_], confidence: NDArray[np.float64], touch_seconds: float
) -> NDArray[np.float64]:
    """Learn how fast touching removes doubt, from rehearsals on training objects.

    Parameters
    ----------
    correct, confidence : numpy.ndarray
        Shape (k + 1, n): whether the likeliest class is right after 0 to k touches, and its
        probability.
    touch_seconds : float
        What a touch takes, more than 0 (seconds).

    Returns
    -------
    numpy.ndarray
        Shape (k + 1,), float64: the doubt is one less the confidence. What further touches gain is
        the rise in the share that is right, over all rehearsals, as a share of the doubt; of all
        numbers of further touches, the one with the highest gain a second counts.
    """
    right = correct.sum(axis=1)
    doubt = np.maximum((1 - confidence).sum(axis=1), np.finfo(np.float64).tiny)
    pace = np.zeros(len(right))
    for made in range(len(right) - 1):
        further = np.arange(1, len(right) - made)
        shares = np.clip((right[made + 1 :] - right[made]) / doubt[made], 0, 1)
        pace[made] = (shares / (further * touch_seconds)).max()
    return pace


def expected_gain(
    pace: NDArray[np.float64], confidence: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Give what a second of touching is expected to bring after 0 to k touches: (k + 1, n)."""
    return pace[:, None] * (1 - confidence)


def rule_of_budget(
    pace: NDArray[np.float64], confidence: NDArray[np.float64], most_touches: float
) -> StoppingRule:
    """Choose the least worth of a second by which rehearsals take so many touches on average.

    Parameters
    ----------
    pace : numpy.ndarray
        As `learn_pace` gives it.
    confidence : numpy.ndarray
        Shape (k + 1, n): of the rehearsals.
    most_touches : float
        How many touches a rehearsal may take on average.

    Returns
    -------
    StoppingRule
        The rule.
    """
    worths = np.unique([0.0, *expected_gain(pace, confidence).ravel()])
    # The larger the worth, the earlier every rehearsal stops.
    low, high = 0, len(worths) - 1
    while low < high:
        middle = (low + high) // 2
        rule = StoppingRule(pace, float(worths[middle]))
        if rule.touches(confidence).mean() <= most_touches:
            high = middle
        else:
            low = middle + 1
    return StoppingRule(pace, float(worths[low]))
