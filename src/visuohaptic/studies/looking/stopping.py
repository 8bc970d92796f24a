"""A rule that stops touching where the next touch brings less than its price.

After each touch it goes on while a second of touching is expected to bring more than a `worth`: the
probability of a correct answer that a second must bring.
"""

from __future__ import annotations

from bisect import bisect_left

import numpy as np
from numpy.typing import NDArray


def learn_pace(
    correct: NDArray[np.bool_], confidence: NDArray[np.float64], touch_seconds: float
) -> NDArray[np.float64]:
    """Learn which share of the doubt a second of touching removes after 0 to k touches: (k + 1,), the last 0.

    `correct` and `confidence`, (k + 1, n), say of n rehearsals on training objects whether the likeliest
    class is right, and its probability; doubt is one less it. Further touches gain the rise in the share
    that is right as a share of the doubt; the number of them with the highest gain a second counts.
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
    """Give what a second of touching is expected to bring after 0 to k touches: (k + 1, …) of both."""
    return np.einsum("k,k...->k...", pace, 1 - confidence)


def touches_made(worth: float, gain: NDArray[np.float64]) -> NDArray[np.int64]:
    """Give after how many touches the rule stops, of the expected gain after each, (k + 1, …) to (…)."""
    return np.argmax(gain <= worth, axis=0)


def worth_of_budget(gain: NDArray[np.float64], most_touches: float) -> float:
    """Choose the least worth of a second by which rehearsals take at most so many touches on average.

    `gain` is what each rehearsal expects, (k + 1, n), as `expected_gain` gives it.
    """
    worths = np.unique([0.0, *gain.ravel()])
    # The larger the worth, the earlier every rehearsal stops.
    enough = bisect_left(
        worths, x=True, key=lambda worth: touches_made(worth, gain).mean() <= most_touches
    )
    return float(worths[enough])
