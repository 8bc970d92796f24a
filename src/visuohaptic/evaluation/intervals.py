"""Intervals over objects by one rule, and tests in pairs: sequences of one object are not independent.

The values are one per object (its accuracy over every split that tested it), with the predictions as they
are. So an interval shows how far a mean may lie from that of all objects of the same kind, with the trained
classifiers as they are: without the variation of training objects.

The rule for the low end; the high end is its mirror image. Objects get random weights, and so does an extra
object: their own weights times draws of gamma distributions, of shape 1 (Bayesian bootstrap, D. Rubin, Annals
of Statistics 9(1), 1981) and of shape `EXTRA`. The low end is the smaller of two quantiles of the weighted mean:

- what the objects show: the extra object is as bad as the worst of them;
- what they may have missed: the extra object is as bad as possible, all others as good as the best of them.

Each mean rises with each value, so no end moves up where an object gets worse. Of all-or-nothing objects, both
quantiles are those of beta distributions.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.recognition.parameters import IntervalParameters

Bounds = tuple[float, float]
"""The least and the largest value that an object can have."""

SHARE: Bounds = (0.0, 1.0)
DIFFERENCE: Bounds = (-1.0, 1.0)
"""Of two shares."""
CORRELATION: Bounds = (-1.0, 1.0)
UNBOUNDED: Bounds = (-math.inf, math.inf)

EXTRA = 0.75
"""Weight of the extra object, in objects: of the multiples of 0.05, the least that keeps 93 % (docs/recognition.md)."""

# Trapezoids over x with the nodes sinh x: functions that fall as a power are summed as exactly as those that fall as
# a normal density. Powers of a literal have the same bits on every processor.
_STEP = 1 / 16
_GROWTH = np.concatenate([[1.0], np.cumprod(np.full(383, 1.0644944589178593))])  # e^x
_NODES = (_GROWTH - 1 / _GROWTH) / 2
_WIDTHS = (_GROWTH + 1 / _GROWTH) / 2 * np.where(_GROWTH == 1, 0.5, 1.0)
_HALVINGS = 16
_FIRST_HALVINGS = 3
_TURNS = 100
_NARROW = 1e-12
_ROUNDING = 1e-9
"""By how much values may miss their bounds."""


@dataclass(frozen=True)
class Interval:
    """A figure and its interval."""

    mean: float
    low: float
    high: float


@dataclass(frozen=True)
class PairedComparison:
    """A mean difference, first less second, between two treatments of the same objects.

    The p value is two-sided; `exact` says whether all sign changes were taken.
    """

    difference: Interval
    p_value: float
    objects: int
    exact: bool


def plain_interval(interval: Interval) -> dict[str, float | None]:
    """Give mean, low and high by name, for JSON; what is NaN is None."""
    return {name: None if np.isnan(value) else value for name, value in vars(interval).items()}


def object_interval(
    values: FloatArray,
    weights: FloatArray,
    parameters: IntervalParameters,
    bounds: Bounds = SHARE,
) -> Interval:
    """Compute the weighted mean of objects' values and its interval, by the rule of this module.

    Parameters
    ----------
    values : array (o,)
        One value per object, within the bounds.
    weights : array (o,)
        Positive weights.
    parameters : IntervalParameters
        The confidence.
    bounds
        The least and the largest possible value. Where one is infinite, the end on its side only counts what
        the objects show.

    Returns
    -------
    Interval
        Within the bounds, and with the mean inside. With a single object both ends are NaN.

    Raises
    ------
    ValueError
        If a value lies outside the bounds.
    """
    least, most = float(values.min()), float(values.max())
    if least < bounds[0] - _ROUNDING or most > bounds[1] + _ROUNDING:
        raise ValueError(f"values are from {least} to {most}; they must be within {bounds}.")
    values = np.clip(values, *bounds)
    mean = float(np.clip(np.einsum("o,o", weights, values) / np.sum(weights), least, most))
    if len(values) < 2:
        return Interval(mean, math.nan, math.nan)
    tail = (1 - parameters.confidence) / 2
    missed = _missed(tuple(weights.tolist()), tail)
    low = _low_end(values, weights, bounds[0], missed, tail)
    high = -_low_end(-values, weights, -bounds[1], missed, tail)
    return Interval(mean, min(low, mean), max(high, mean))


def balanced_interval(
    values: FloatArray, classes: IntArray, parameters: IntervalParameters
) -> Interval:
    """Compute the mean over classes of the mean share (o,) of their objects, and its interval."""
    _, place, counts = np.unique(classes, return_inverse=True, return_counts=True)
    return object_interval(values, 1.0 / counts[place], parameters)


@lru_cache(maxsize=64)
def _missed(weights: tuple[float, ...], tail: float) -> float:
    """Compute the weight that an extra object may have beside objects of some weights."""
    return 1 - _quantile(np.ones(len(weights)), np.array(weights), 0.0, tail)


def _low_end(
    values: FloatArray, weights: FloatArray, worst: float, missed: float, tail: float
) -> float:
    """Compute the low end; `missed` is the weight of what the objects may have missed."""
    least, most = float(values.min()), float(values.max())
    shown = _quantile(values, weights, least, tail)
    if math.isinf(worst):
        return shown
    return min(shown, (1 - missed) * most + missed * worst)


def _quantile(values: FloatArray, weights: FloatArray, extra: float, tail: float) -> float:
    """Compute a quantile of the randomly weighted mean of objects and an extra one of value `extra`."""
    least, most = min(float(values.min()), extra), float(values.max())
    if least == most:
        return least
    places = (np.append(values, extra) - least) / (most - least)
    # The extra object's own weight is that of a typical one: the mean of the objects' weights, by weight.
    own = np.append(weights, np.einsum("o,o", weights, weights) / np.sum(weights))
    level = _root(lambda level: _share_below(own * (places - level)) - tail, -tail, 1 - tail)
    return least + level * (most - least)


def _root(function: Callable[[float], float], below: float, above: float) -> float:
    """Compute where a function rises through 0 between 0 and 1, where it is `below` and `above`."""
    # Halvings, then regula falsi that halves the value at an end that stays (Illinois).
    low, high, last = 0.0, 1.0, 0.0
    middle = 0.5
    for turn in range(_TURNS):
        value = function(middle)
        if abs(value) < _NARROW or high - low < _NARROW:
            break
        if value < 0:
            low, below, above = middle, value, above / 2 if last < 0 else above
        else:
            high, above, below = middle, value, below / 2 if last > 0 else below
        last = value
        middle = (low + high) / 2
        if turn >= _FIRST_HALVINGS:
            middle = (low * above - high * below) / (above - below)
    return middle


def _share_below(slopes: FloatArray) -> float:
    """Compute the probability that the sum of slopes (o + 1,) times gamma draws is below 0."""
    # The inverse Laplace transform of the moment generating function, along a line near its saddle point
    # (R. Lugannani and S. Rice, Advances in Applied Probability 12(2), 1980). Sums, products, quotients and roots
    # in one order have the same bits on every processor.
    if slopes.min() >= 0 or slopes.max() <= 0:
        return float(slopes.max() <= 0)
    slopes = slopes / np.abs(slopes).max()
    saddle = _saddle(slopes)
    along = 1 - saddle * slopes
    across = np.multiply.outer(slopes, -saddle * _NODES)
    squares = (along * along)[:, None] + across * across
    real, imaginary = along[:, None] / squares, across / squares
    # A power of 3/4: a root times the root of that root.
    root = _square_root(real[-1], imaginary[-1])
    real[-1], imaginary[-1] = _product(*root, *_square_root(*root))
    while len(real) > 1:
        half = len(real) // 2
        first, second = slice(half), slice(half, 2 * half)
        pairs = _product(real[first], imaginary[first], real[second], imaginary[second])
        real = np.concatenate([pairs[0], real[2 * half :]])
        imaginary = np.concatenate([pairs[1], imaginary[2 * half :]])
    # Divided by the place on the line, in units of the saddle point.
    parts = (real[0] - imaginary[0] * _NODES) / (1 + _NODES * _NODES)
    return math.fsum((parts * _WIDTHS).tolist()) * _STEP / math.pi


def _saddle(slopes: FloatArray) -> float:
    """Compute where the moment generating function over minus its argument is least, left of 0."""
    low, high = 1 / float(slopes.min()), 0.0
    parts = slopes * np.append(np.ones(len(slopes) - 1), EXTRA)
    middle = low / 2
    for _ in range(_HALVINGS):
        if np.add.reduce(parts / (1 - middle * slopes)) > 1 / middle:
            high = middle
        else:
            low = middle
        middle = (low + high) / 2
    return middle


def _product(
    real: FloatArray, imaginary: FloatArray, other_real: FloatArray, other_imaginary: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Multiply complex numbers; NumPy's product may round once less on some processors."""
    return (
        real * other_real - imaginary * other_imaginary,
        real * other_imaginary + imaginary * other_real,
    )


def _square_root(real: FloatArray, imaginary: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Compute the square root of complex numbers with a positive real part."""
    root = np.sqrt((np.sqrt(real * real + imaginary * imaginary) + real) / 2)
    return root, imaginary / (2 * root)


def compare_paired(
    first: FloatArray,
    second: FloatArray,
    weights: FloatArray,
    parameters: IntervalParameters,
) -> PairedComparison:
    """Compare shares (o,) of the same objects, of positive weights (o,), under two treatments.

    The p value is the share of sign changes of the objects' differences whose mean is at least as
    far from 0: all of them where they fit, else a sample that counts the observed one. The sample depends
    on the number of objects only, so that a comparison has the same p value wherever it is made.
    """
    interval = object_interval(first - second, weights, parameters, DIFFERENCE)
    parts = (first - second) * weights / weights.sum()
    exact = len(parts) < 63 and 2 ** len(parts) <= parameters.permutations
    if exact:
        places = np.arange(2 ** len(parts))[:, None] >> np.arange(len(parts))
        signs = 1.0 - 2.0 * (places & 1)
    else:
        generator = spawn_generator(0, "sign changes", len(parts))
        signs = generator.choice([-1.0, 1.0], size=(parameters.permutations, len(parts)))
    # Sums that differ by rounding alone are equal.
    reached = np.abs(signs @ parts) >= np.abs(parts.sum()) - 1e-12
    p_value = reached.mean() if exact else (reached.sum() + 1) / (len(signs) + 1)
    return PairedComparison(interval, float(p_value), len(parts), exact)


def holm(p_values: Sequence[float]) -> list[float]:
    """Adjust p values for their number, to 1 at most (S. Holm, Scand. J. Statist. 6:65-70, 1979)."""
    order = np.argsort(p_values, kind="stable")
    steps = np.arange(len(p_values), 0, -1) * np.asarray(p_values)[order]
    adjusted = np.empty(len(p_values))
    adjusted[order] = np.minimum(np.maximum.accumulate(steps), 1.0)
    return adjusted.tolist()
