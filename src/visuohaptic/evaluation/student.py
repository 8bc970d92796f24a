"""Student's t distribution for whole degrees of freedom, with the same bits on every processor."""

from __future__ import annotations

import math
from functools import lru_cache

_HALVINGS = 4
_TERMS = 9
_BISECTIONS = 60


def two_sided(mean: float, error: float, degrees: int) -> float:
    """Compute the two-sided p value of a mean with a standard error, by Student's t distribution.

    Parameters
    ----------
    mean, error : float
        The mean, and its standard error (not negative). If both are 0, the p value is 1.
    degrees : int
        Degrees of freedom, at least 1.
    """
    scaled = error * math.sqrt(degrees)
    length = math.sqrt(mean * mean + scaled * scaled)
    return 1.0 if length == 0 else _tail(scaled / length, degrees)


@lru_cache(maxsize=64)
def quantile(significance: float, degrees: int) -> float:
    """Return the t value with a two-sided p value of `significance`, for at least one degree of freedom."""
    low, high = 0.0, 1.0
    for _ in range(_BISECTIONS):
        middle = (low + high) / 2
        if _tail(middle, degrees) < significance:
            low = middle
        else:
            high = middle
    return math.sqrt(degrees) * math.sqrt(1 - high * high) / high


def _tail(cosine: float, degrees: int) -> float:
    """Compute the two-sided p value at the angle whose tangent is t / sqrt(degrees), from its cosine in [0, 1]."""
    # M. Abramowitz and I. Stegun, Handbook of Mathematical Functions, 26.7.3 and 26.7.4. Only sums, products, quotients
    # and roots.
    sine = math.sqrt(max(0.0, 1 - cosine * cosine))
    is_odd = degrees % 2
    term, total = (cosine, 0.0) if is_odd else (1.0, 0.0)
    for power in range(is_odd, degrees - 1, 2):
        total += term
        term *= cosine * cosine * (power + 1) / (power + 2)
    within = sine * total
    if is_odd:
        within = (_angle(sine, cosine) + within) * 2 / math.pi
    return min(1.0, max(0.0, 1 - within))


def _angle(sine: float, cosine: float) -> float:
    """Compute an angle in [0, pi / 2] from its sine and cosine, by halving and the series of the arc tangent."""
    for _ in range(_HALVINGS):
        half = math.sqrt((1 + cosine) / 2)
        sine, cosine = sine / (2 * half), half
    tangent = sine / cosine
    square, total = tangent * tangent, 0.0
    for term in reversed(range(_TERMS)):
        total = 1 / (2 * term + 1) - square * total
    return float(2**_HALVINGS) * tangent * total
