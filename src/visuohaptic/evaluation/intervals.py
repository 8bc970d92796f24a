"""Intervals over objects by one rule, and paired tests over objects.

Sequences of one object are not independent, so the unit is the object. Each object has one value, such as its mean
accuracy over the splits that tested the object. The interval is a confidence interval of the mean over all objects of
the same kind, from the observed sample of objects. The trained classifiers are fixed, so the variation of training
objects is not included.

The rule for the low end, with tail = (1 - confidence) / 2; the high end is its mirror image:

1. Add an extra object. Its weight is sum(w**2) / sum(w), where w are the weights of the observed objects.
2. Multiply each weight by a random factor with a gamma distribution. The shape is 1 for observed objects (Bayesian
   bootstrap, D. Rubin, Annals of Statistics 9(1), 1981) and `EXTRA` for the extra object.
3. Compute quantile `tail` of the weighted mean over all objects, twice. The low end is the smaller quantile.

   - Variation of observed objects: the extra object has the lowest observed value.
   - Unobserved failures: the extra object has the lowest possible value, and all other objects have the highest
     observed value.

The quantiles are computed by numerical integration, without random draws. The rule is monotone: both ends stay or
fall if the value of an object falls. If all values are 0 or 1 and all weights are equal, the random mean has a beta
distribution.
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
"""Type of bounds: the lowest and the highest value that an object can have."""

SHARE: Bounds = (0.0, 1.0)
"""Bounds of a share, such as an accuracy."""
DIFFERENCE: Bounds = (-1.0, 1.0)
"""Bounds of the difference of two shares."""
CORRELATION: Bounds = (-1.0, 1.0)
"""Bounds of a correlation coefficient."""
UNBOUNDED: Bounds = (-math.inf, math.inf)
"""Bounds of a measure without limits; intervals then use only the observed objects."""

EXTRA = 0.75
"""Shape of the extra object's gamma distribution, which is also its mean factor; observed objects have shape 1.

The smallest multiple of 0.05 at which intervals of confidence 95 % contain the true mean in at least 93 % of
simulations. The simulated objects have values 0 or 1 (docs/intervals.md). The value is also in the code of
`_probability_below_zero`.
"""

# Trapezoidal rule over x = 0, 1/16, ..., 383/16 for integrals over sinh x from 0 to infinity. The substitution makes
# integrands with a power-law tail decay exponentially in x. Powers of a literal have the same bits on every processor.
_STEP = 1 / 16
_EXPONENTIALS = np.concatenate([[1.0], np.cumprod(np.full(383, 1.0644944589178593))])  # e^x
_NODES = (_EXPONENTIALS - 1 / _EXPONENTIALS) / 2  # sinh x
_WIDTHS = (_EXPONENTIALS + 1 / _EXPONENTIALS) / 2 * np.where(_EXPONENTIALS == 1, 0.5, 1.0)  # cosh x
_SADDLE_BISECTIONS = 16
_ROOT_BISECTIONS = 3
_MAXIMUM_ROOT_STEPS = 100
_ROOT_TOLERANCE = 1e-12
"""`_root` ends at this function value or at this width of the bracket."""
_ROUNDING = 1e-9
"""How far values may lie outside their bounds, to allow for rounding."""


@dataclass(frozen=True)
class Interval:
    """A mean and the ends of its confidence interval; both ends are NaN for a single object."""

    mean: float
    low: float
    high: float


@dataclass(frozen=True)
class PairedComparison:
    """Result of a paired test of two treatments of the same objects.

    `difference` is the weighted mean of first minus second, with its interval. `p_value` is two-sided. `objects` is
    the number of objects. `exact` is True if `p_value` comes from all sign changes, False if from a random sample.
    """

    difference: Interval
    p_value: float
    objects: int
    exact: bool


def plain_interval(interval: Interval) -> dict[str, float | None]:
    """Return a dict with keys ``mean``, ``low`` and ``high``, for JSON; NaN becomes None."""
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
        One finite value per object, within the bounds; at least one object.
    weights : array (o,)
        One positive weight per object. Only the ratios of weights count.
    parameters : IntervalParameters
        Only `confidence` is used: 0.95 is an interval from the 2.5 % to the 97.5 % quantile.
    bounds : tuple of two floats
        The lowest and the highest possible value, for which the unobserved failures of the rule are computed. With
        an infinite bound, the end on that side is the quantile for the observed objects.

    Returns
    -------
    Interval
        The interval lies within the bounds and contains the mean. With a single object both ends are NaN.

    Raises
    ------
    ValueError
        If there is no object, or a value lies outside the bounds by more than 1e-9.
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
    """Compute the mean over classes of the mean over the objects of a class, and its interval over objects.

    `values` (o,) are shares in [0, 1], one per object. `classes` (o,) are class labels. The interval is that of
    `object_interval`, with weight 1 / (objects of the class) per object.
    """
    _, class_index, counts = np.unique(classes, return_inverse=True, return_counts=True)
    return object_interval(values, 1.0 / counts[class_index], parameters)


@lru_cache(maxsize=64)
def _unobserved_weight(weights: tuple[float, ...], tail: float) -> float:
    """Compute quantile 1 - `tail` of the extra object's share of the total random weight."""
    return 1 - _quantile(np.ones(len(weights)), np.array(weights), 0.0, tail)


def _low_end(
    values: FloatArray, weights: FloatArray, worst: float, unobserved: float, tail: float
) -> float:
    """Compute the low end; `worst` is the lowest possible value, `unobserved` comes from `_unobserved_weight`."""
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
    # The weight of the extra object is sum(w**2) / sum(w): objects of large weight count more in this mean.
    all_weights = np.append(weights, np.einsum("o,o", weights, weights) / np.sum(weights))
    level = _root(
        lambda level: _probability_below_zero(all_weights * (scaled - level)) - tail,
        -tail,
        1 - tail,
    )
    return lowest + level * (highest - lowest)


def _root(function: Callable[[float], float], value_at_low: float, value_at_high: float) -> float:
    """Compute the root of a rising function on [0, 1] from its values at 0 (negative) and at 1 (positive)."""
    # A few bisections, then the Illinois variant of regula falsi.
    low, high, last = 0.0, 1.0, 0.0
    middle = 0.5
    for step in range(_MAXIMUM_ROOT_STEPS):
        value = function(middle)
        if abs(value) < _ROOT_TOLERANCE or high - low < _ROOT_TOLERANCE:
            break
        if value < 0:
            low, value_at_low = middle, value
            value_at_high = value_at_high / 2 if last < 0 else value_at_high
        else:
            high, value_at_high = middle, value
            value_at_low = value_at_low / 2 if last > 0 else value_at_low
        last = value
        middle = (low + high) / 2
        if step >= _ROOT_BISECTIONS:
            middle = (low * value_at_high - high * value_at_low) / (value_at_high - value_at_low)
    return middle


def _probability_below_zero(slopes: FloatArray) -> float:
    """Compute P(slopes @ factors < 0) for slopes (o + 1,); gamma factors have shape 1, the last has shape `EXTRA`."""
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
    # The last factor's transform has the power EXTRA = 3/4: its square root times the root of that root.
    root = _square_root(real[-1], imaginary[-1])
    real[-1], imaginary[-1] = _product(*root, *_square_root(*root))
    while len(real) > 1:
        half = len(real) // 2
        first, second = slice(half), slice(half, 2 * half)
        pairs = _product(real[first], imaginary[first], real[second], imaginary[second])
        real = np.concatenate([pairs[0], real[2 * half :]])
        imaginary = np.concatenate([pairs[1], imaginary[2 * half :]])
    # The inverse transform divides by the point on the line, saddle * (1 ± i * node).
    integrand = (real[0] - imaginary[0] * _NODES) / (1 + _NODES * _NODES)
    return math.fsum((integrand * _WIDTHS).tolist()) * _STEP / math.pi


def _saddle(slopes: FloatArray) -> float:
    """Compute s < 0 that minimises M(s) / -s, by bisection; M is the moment generating function of slopes @ factors."""
    low, high = 1 / float(slopes.min()), 0.0
    numerators = slopes * np.append(np.ones(len(slopes) - 1), EXTRA)
    middle = low / 2
    for _ in range(_SADDLE_BISECTIONS):
        if np.add.reduce(numerators / (1 - middle * slopes)) > 1 / middle:
            high = middle
        else:
            low = middle
        middle = (low + high) / 2
    return middle


def _product(
    real: FloatArray, imaginary: FloatArray, other_real: FloatArray, other_imaginary: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Multiply complex numbers with the same bits on every processor; NumPy's product may fuse operations."""
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
        Shares in [0, 1], one per object, in the same order of objects; at least one object.
    weights : array (o,)
        One positive weight per object. Only the ratios of weights count.
    parameters : IntervalParameters
        The confidence of the interval, and the largest number of sign changes.

    Returns
    -------
    PairedComparison
        The weighted mean of first minus second, its interval, and the p value. The p value is the share of sign
        changes with an absolute weighted mean at least as large as the observed one. All 2**o sign changes are taken
        if they are at most `parameters.permutations`. Otherwise `parameters.permutations` sign changes are drawn, and
        the observed signs are added. The drawn sample depends only on `parameters.permutations` and the number of
        objects, so the p value is reproducible.

    Raises
    ------
    ValueError
        If there is no object, or a difference lies outside [-1, 1] by more than 1e-9.
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
    """Return p values with Holm's correction for the number of given p values, at most 1, in the given order.

    S. Holm, Scandinavian Journal of Statistics 6:65-70, 1979.
    """
    order = np.argsort(p_values, kind="stable")
    steps = np.arange(len(p_values), 0, -1) * np.asarray(p_values)[order]
    adjusted = np.empty(len(p_values))
    adjusted[order] = np.minimum(np.maximum.accumulate(steps), 1.0)
    return adjusted.tolist()
