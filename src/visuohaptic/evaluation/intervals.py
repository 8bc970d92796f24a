"""Intervals over objects by one rule, and paired tests over objects.

Sequences of one object are not independent, so the unit is the object. Each object has one value: its accuracy
over every split that tested it. An interval shows how far a mean may lie from the mean over all objects of the
same kind. The trained classifiers are fixed, so the variation of training objects is not included.

The rule for the low end (the high end is its mirror image): objects and an extra object get random weights. These
are their own weights times draws of a gamma distribution. Its shape is 1 for objects (Bayesian bootstrap, D. Rubin,
Annals of Statistics 9(1), 1981) and `EXTRA` for the extra object. The low end is the smaller of two quantiles of the
weighted mean:

- the observed objects: the extra object has the value of the worst object;
- unobserved objects: the extra object has the lowest possible value, all others have the value of the best object.

Each weighted mean rises with each value, so no end moves up when an object gets worse. If all values are 0 or 1,
both quantiles are quantiles of beta distributions.
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
"""The lowest and the highest value that an object can have."""

SHARE: Bounds = (0.0, 1.0)
DIFFERENCE: Bounds = (-1.0, 1.0)
"""Bounds of the difference of two shares."""
CORRELATION: Bounds = (-1.0, 1.0)
UNBOUNDED: Bounds = (-math.inf, math.inf)

EXTRA = 0.75
"""Weight of the extra object, in objects: the smallest multiple of 0.05 with a coverage of 93 % (docs/recognition.md)."""

# Trapezoidal rule over x with nodes at sinh x: integrands with a power-law tail are then summed as exactly as
# integrands with a normal tail. Powers of a literal have the same bits on every processor.
_STEP = 1 / 16
_GROWTH = np.concatenate([[1.0], np.cumprod(np.full(383, 1.0644944589178593))])  # e^x
_NODES = (_GROWTH - 1 / _GROWTH) / 2
_WIDTHS = (_GROWTH + 1 / _GROWTH) / 2 * np.where(_GROWTH == 1, 0.5, 1.0)
_HALVINGS = 16
_FIRST_HALVINGS = 3
_TURNS = 100
_NARROW = 1e-12
_ROUNDING = 1e-9
"""How far values may lie outside their bounds, to allow for rounding."""


@dataclass(frozen=True)
class Interval:
    """A mean and its interval; ends are NaN where there are none."""

    mean: float
    low: float
    high: float


@dataclass(frozen=True)
class PairedComparison:
    """The mean difference, first minus second, between two treatments of the same objects.

    `p_value` is two-sided. `exact` is True if the test took all sign changes, False if it took a random sample.
    """

    difference: Interval
    p_value: float
    objects: int
    exact: bool


def plain_interval(interval: Interval) -> dict[str, float | None]:
    """Return ``mean``, ``low`` and ``high`` by name, for JSON; NaN becomes None."""
    return {name: None if np.isnan(value) else value for name, value in vars(interval).items()}


def object_interval(
    values: FloatArray,
    weights: FloatArray,
    parameters: IntervalParameters,
    bounds: Bounds = SHARE,
) -> Interval:
    """Compute the weighted mean of the objects' values and its interval, by the rule of this module.

    Parameters
    ----------
    values : array (o,)
        One value per object, within the bounds.
    weights : array (o,)
        Positive weights.
    parameters : IntervalParameters
        The confidence.
    bounds : tuple of two floats
        The lowest and the highest possible value. With an infinite bound, the end on that side uses the
        observed objects only.

    Returns
    -------
    Interval
        The interval lies within the bounds and contains the mean. With a single object both ends are NaN.

    Raises
    ------
    ValueError
        If a value lies outside the bounds.
    """
    lowest, highest = float(values.min()), float(values.max())
    if lowest < bounds[0] - _ROUNDING or highest > bounds[1] + _ROUNDING:
        raise ValueError(f"values are from {lowest} to {highest}; they must be within {bounds}.")
    values = np.clip(values, *bounds)
    mean = float(np.clip(np.einsum("o,o", weights, values) / np.sum(weights), lowest, highest))
    if len(values) < 2:
        return Interval(mean, math.nan, math.nan)
    tail = (1 - parameters.confidence) / 2
    unobserved = _unobserved_weight(tuple(weights.tolist()), tail)
    low = _low_end(values, weights, bounds[0], unobserved, tail)
    high = -_low_end(-values, weights, -bounds[1], unobserved, tail)
    return Interval(mean, min(low, mean), max(high, mean))


def balanced_interval(
    values: FloatArray, classes: IntArray, parameters: IntervalParameters
) -> Interval:
    """Compute the mean over classes of the mean over a class's objects, and its interval.

    `values` (o,) are shares in [0, 1], one per object; `classes` (o,) are the objects' classes.
    """
    _, class_index, counts = np.unique(classes, return_inverse=True, return_counts=True)
    return object_interval(values, 1.0 / counts[class_index], parameters)


@lru_cache(maxsize=64)
def _unobserved_weight(weights: tuple[float, ...], tail: float) -> float:
    """Compute the share of the total weight that the extra object exceeds with probability `tail`."""
    return 1 - _quantile(np.ones(len(weights)), np.array(weights), 0.0, tail)


def _low_end(
    values: FloatArray, weights: FloatArray, worst: float, unobserved: float, tail: float
) -> float:
    """Compute the low end; `worst` is the lowest possible value, `unobserved` the weight of unobserved objects."""
    lowest, highest = float(values.min()), float(values.max())
    observed = _quantile(values, weights, lowest, tail)
    if math.isinf(worst):
        return observed
    return min(observed, (1 - unobserved) * highest + unobserved * worst)


def _quantile(values: FloatArray, weights: FloatArray, extra: float, tail: float) -> float:
    """Compute quantile `tail` of the randomly weighted mean of the objects and an extra object of value `extra`."""
    lowest, highest = min(float(values.min()), extra), float(values.max())
    if lowest == highest:
        return lowest
    scaled = (np.append(values, extra) - lowest) / (highest - lowest)
    # The extra object is a typical object: its weight is the mean of the objects' weights, weighted by themselves.
    all_weights = np.append(weights, np.einsum("o,o", weights, weights) / np.sum(weights))
    level = _root(
        lambda level: _share_below(all_weights * (scaled - level)) - tail, -tail, 1 - tail
    )
    return lowest + level * (highest - lowest)


def _root(function: Callable[[float], float], below: float, above: float) -> float:
    """Compute the root of a rising function on [0, 1]; `below` and `above` are its values at 0 and 1."""
    # A few bisections, then the Illinois variant of regula falsi.
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
    # Inverse Laplace transform of the moment generating function along a line near its saddle point
    # (R. Lugannani and S. Rice, Advances in Applied Probability 12(2), 1980). Only sums, products, quotients and
    # roots, in a fixed order: these have the same bits on every processor.
    if slopes.min() >= 0 or slopes.max() <= 0:
        return float(slopes.max() <= 0)
    slopes = slopes / np.abs(slopes).max()
    saddle = _saddle(slopes)
    along = 1 - saddle * slopes
    across = np.multiply.outer(slopes, -saddle * _NODES)
    squares = (along * along)[:, None] + across * across
    real, imaginary = along[:, None] / squares, across / squares
    # The extra object's factor has the power EXTRA = 3/4: the root times the root of the root.
    root = _square_root(real[-1], imaginary[-1])
    real[-1], imaginary[-1] = _product(*root, *_square_root(*root))
    while len(real) > 1:
        half = len(real) // 2
        first, second = slice(half), slice(half, 2 * half)
        pairs = _product(real[first], imaginary[first], real[second], imaginary[second])
        real = np.concatenate([pairs[0], real[2 * half :]])
        imaginary = np.concatenate([pairs[1], imaginary[2 * half :]])
    # The integrand is divided by the point on the line, in units of the saddle point.
    integrand = (real[0] - imaginary[0] * _NODES) / (1 + _NODES * _NODES)
    return math.fsum((integrand * _WIDTHS).tolist()) * _STEP / math.pi


def _saddle(slopes: FloatArray) -> float:
    """Compute the saddle point: the minimum over s < 0 of the moment generating function at s, divided by -s."""
    low, high = 1 / float(slopes.min()), 0.0
    numerators = slopes * np.append(np.ones(len(slopes) - 1), EXTRA)
    middle = low / 2
    for _ in range(_HALVINGS):
        if np.add.reduce(numerators / (1 - middle * slopes)) > 1 / middle:
            high = middle
        else:
            low = middle
        middle = (low + high) / 2
    return middle


def _product(
    real: FloatArray, imaginary: FloatArray, other_real: FloatArray, other_imaginary: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Multiply complex numbers with the same bits everywhere; NumPy's product may fuse operations."""
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
    """Compare two treatments of the same objects by a sign-change permutation test.

    Parameters
    ----------
    first, second : array (o,)
        Shares in [0, 1], one per object.
    weights : array (o,)
        Positive weights of the objects.
    parameters : IntervalParameters
        The confidence, and the number of permutations.

    Returns
    -------
    PairedComparison
        The mean of first minus second, its interval, and the p value. The p value is the share of sign changes with
        a mean at least as far from 0 as the observed mean. All sign changes are taken if there are at most
        `parameters.permutations`, else a random sample that includes the observed signs. The sample depends only on
        the number of objects, so that a comparison has the same p value wherever it is computed.
    """
    interval = object_interval(first - second, weights, parameters, DIFFERENCE)
    differences = (first - second) * weights / weights.sum()
    count = len(differences)
    exact = count < 63 and 2**count <= parameters.permutations
    if exact:
        bits = np.arange(2**count)[:, None] >> np.arange(count)
        signs = 1.0 - 2.0 * (bits & 1)
    else:
        generator = spawn_generator(0, "sign changes", count)
        signs = generator.choice([-1.0, 1.0], size=(parameters.permutations, count))
    # Sums that differ only by rounding count as equal.
    reached = np.abs(signs @ differences) >= np.abs(differences.sum()) - 1e-12
    p_value = reached.mean() if exact else (reached.sum() + 1) / (len(signs) + 1)
    return PairedComparison(interval, float(p_value), count, exact)


def holm(p_values: Sequence[float]) -> list[float]:
    """Return p values with Holm's correction, at most 1, in the given order.

    S. Holm, Scandinavian Journal of Statistics 6:65-70, 1979.
    """
    order = np.argsort(p_values, kind="stable")
    steps = np.arange(len(p_values), 0, -1) * np.asarray(p_values)[order]
    adjusted = np.empty(len(p_values))
    adjusted[order] = np.minimum(np.maximum.accumulate(steps), 1.0)
    return adjusted.tolist()
