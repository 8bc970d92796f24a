"""Intervals over objects and over classes, and paired tests.

Sequences of one object are not independent, so the unit is the object. Each object has one value, such as its mean
accuracy over the splits that tested the object. The interval of new objects is a confidence interval of the mean over
all objects of the same classes, from the observed sample of objects. The interval of new classes is that of the mean
over all classes: classes count as a sample, too. The trained classifiers are fixed, so the variation of training
objects is not included. docs/intervals.md has the measured coverage.

The rule of an accuracy (`object_interval`) for the low end, with tail = (1 - confidence) / 2; the high end is its mirror
image:

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

The rule of a lead, a mean of paired differences (`compare_differences`): the interval has all means that the
sign-change test (`sign_changes`) or the rule of unobserved failures above does not reject. The p value is the larger
of both tests' p values at a lead of 0. So p is below 1 - confidence exactly if the interval excludes 0.

The rule of new classes (`class_interval`, and the second interval of a lead): all means that the rule of new objects or
Student's t test of the means of classes does not reject.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.evaluation import student
from visuohaptic.evaluation.sign_changes import sign_change_test
from visuohaptic.recognition.parameters import IntervalParameters

Bounds = tuple[float, float]
"""Type of bounds: the lowest and the highest value that an object can have."""

Classes = Sequence[str] | Sequence[int] | IntArray | NDArray[np.str_]
"""Type of the classes of objects, one per object."""

SHARE: Bounds = (0.0, 1.0)
"""Bounds of a share, such as an accuracy."""
DIFFERENCE: Bounds = (-1.0, 1.0)
"""Bounds of the difference of two shares."""
CORRELATION: Bounds = (-1.0, 1.0)
"""Bounds of a correlation coefficient."""
UNBOUNDED: Bounds = (-math.inf, math.inf)
"""Bounds of a measure without limits; intervals then use only the observed objects."""

SIGNIFICANCE = 0.05
"""A difference is called shown if its p value is below this level.

Where one question has several comparisons, p values are corrected by `holm` for all of them. Intervals of confidence 95 %
belong to this level.
"""

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

    Attributes
    ----------
    difference : Interval
        The weighted mean of first minus second, with its interval of new objects of the same classes.
    p_value : float
        The two-sided p value, below 1 - confidence exactly if `difference` excludes 0.
    objects : int
        The number of objects.
    exact : bool
        Whether the test used all sign changes, not a random sample.
    difference_new_classes : Interval
        The same mean with its interval of new classes. With fewer than two classes, or unknown classes, both ends are
        NaN.
    p_value_new_classes : float
        The p value of `difference_new_classes`; NaN where its ends are.
    classes : int
        The number of classes; 0 if they are unknown.
    """

    difference: Interval
    p_value: float
    objects: int
    exact: bool
    difference_new_classes: Interval
    p_value_new_classes: float
    classes: int


def plain_interval(interval: Interval) -> dict[str, float | None]:
    """Return a dict with keys ``mean``, ``low`` and ``high``, for JSON; NaN becomes None."""
    return {name: None if np.isnan(value) else value for name, value in vars(interval).items()}


def plain_comparison(comparison: PairedComparison) -> dict[str, Any]:
    """Return a dict with a key per attribute of the comparison, for JSON; intervals are dicts, NaN becomes None."""
    p_value = comparison.p_value_new_classes
    return {
        **vars(comparison),
        "difference": plain_interval(comparison.difference),
        "difference_new_classes": plain_interval(comparison.difference_new_classes),
        "p_value_new_classes": None if math.isnan(p_value) else p_value,
    }


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
    values, mean = _checked(values, weights, bounds)
    if len(values) < 2:
        return Interval(mean, math.nan, math.nan)
    tail = (1 - parameters.confidence) / 2
    unobserved = _unobserved_weight(tuple(weights.tolist()), tail)
    low = _low_end(values, weights, bounds[0], unobserved, tail)
    high = -_low_end(-values, weights, -bounds[1], unobserved, tail)
    return Interval(mean, min(low, mean), max(high, mean))


def class_interval(
    values: FloatArray,
    weights: FloatArray,
    classes: Classes,
    parameters: IntervalParameters,
    bounds: Bounds = SHARE,
) -> Interval:
    """Compute the weighted mean of the objects' values and its interval of new classes.

    `classes` has length o: the class of each object, as numbers or names. Other parameters, the mean and the errors
    are as in `object_interval`. The interval contains the interval of `object_interval`, and Student's interval of the
    means of classes, with one degree of freedom fewer than classes. With a single class both ends are NaN.
    """
    objects = object_interval(values, weights, parameters, bounds)
    means = _class_means(np.clip(values, *bounds), weights, classes)
    return _widened(objects, means, bounds, _significance(parameters))


def balanced_interval(
    values: FloatArray, classes: Classes, parameters: IntervalParameters
) -> Interval:
    """Compute the mean over classes of the mean over the objects of a class, and its interval over objects.

    `values` (o,) are shares in [0, 1], one per object. `classes` (o,) are class labels. The interval is that of
    `object_interval`, with weight 1 / (objects of the class) per object.
    """
    _, class_index, counts = np.unique(np.asarray(classes), return_inverse=True, return_counts=True)
    return object_interval(values, 1.0 / counts[class_index], parameters)


def balanced_class_interval(
    values: FloatArray, classes: Classes, parameters: IntervalParameters
) -> Interval:
    """Compute the mean of `balanced_interval` and its interval of new classes, by `class_interval`."""
    _, class_index, counts = np.unique(np.asarray(classes), return_inverse=True, return_counts=True)
    return class_interval(values, 1.0 / counts[class_index], classes, parameters)


def _checked(values: FloatArray, weights: FloatArray, bounds: Bounds) -> tuple[FloatArray, float]:
    """Return the values clipped to the bounds, and their weighted mean; raise `ValueError` as `object_interval`."""
    lowest, highest = float(values.min()), float(values.max())
    if lowest < bounds[0] - _ROUNDING or highest > bounds[1] + _ROUNDING:
        raise ValueError(f"values are from {lowest} to {highest}; they must be within {bounds}.")
    values = np.clip(values, *bounds)
    mean = np.einsum("o,o", weights, values) / np.sum(weights)
    return values, float(np.clip(mean, lowest, highest))


@dataclass(frozen=True)
class _ClassMeans:
    """The number of classes, and mean and standard error of the mean if classes are a sample (NaN for one class)."""

    count: int
    mean: float
    error: float


def _class_means(values: FloatArray, weights: FloatArray, classes: Classes) -> _ClassMeans:
    """Compute the standard error of the weighted mean over classes, from the weighted means of classes."""
    names, index = np.unique(np.asarray(classes), return_inverse=True)
    total = math.fsum(weights.tolist())
    shares, means = [], []
    for number in range(len(names)):
        inside = index == number
        weight = math.fsum(weights[inside].tolist())
        shares.append(weight / total)
        means.append(math.fsum((weights[inside] * values[inside]).tolist()) / weight)
    mean = math.fsum(share * value for share, value in zip(shares, means, strict=True))
    if len(names) < 2:
        return _ClassMeans(len(names), mean, math.nan)
    squares = math.fsum(
        (share * (value - mean)) ** 2 for share, value in zip(shares, means, strict=True)
    )
    # The sum of squares, divided by its expectation for means of variance 1, times the variance of the mean.
    second = math.fsum(share**2 for share in shares)
    expected = math.fsum(share**2 * (1 - 2 * share + second) for share in shares)
    return _ClassMeans(len(names), mean, math.sqrt(squares * second / expected))


def _widened(
    objects: Interval, means: _ClassMeans, bounds: Bounds, significance: float
) -> Interval:
    """Return the interval of new objects, widened to Student's interval of the means of classes."""
    if means.count < 2 or math.isnan(objects.low):
        return Interval(objects.mean, math.nan, math.nan)
    reach = student.quantile(significance, means.count - 1) * means.error
    low = max(objects.mean - reach, bounds[0])
    high = min(objects.mean + reach, bounds[1])
    return Interval(objects.mean, min(low, objects.low), max(high, objects.high))


def _significance(parameters: IntervalParameters) -> float:
    """Return 1 - confidence, without the rounding of the difference."""
    return round(1 - parameters.confidence, 12)


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
    classes: Classes | None = None,
) -> PairedComparison:
    """Compare two treatments of the same objects, by `compare_differences` of first minus second.

    `first` and `second` (o,) are shares in [0, 1], one per object, in the same order of objects. Other parameters, result
    and errors are those of `compare_differences`.
    """
    return compare_differences(first - second, weights, parameters, DIFFERENCE, classes)


def compare_differences(
    differences: FloatArray,
    weights: FloatArray,
    parameters: IntervalParameters,
    bounds: Bounds = DIFFERENCE,
    classes: Classes | None = None,
) -> PairedComparison:
    """Test whether the mean of paired differences is 0, and compute the intervals that belong to the test.

    Parameters
    ----------
    differences : array (o,)
        One finite difference per object, within the bounds; at least one object.
    weights : array (o,)
        One positive weight per object. Only the ratios of weights count.
    parameters : IntervalParameters
        The confidence of the intervals, and the largest number of sign changes. All 2**o sign changes are taken if they
        are at most `parameters.permutations`; otherwise so many are drawn. The drawn sample depends only on
        `parameters.permutations` and the number of objects.
    bounds : tuple of two floats
        The lowest and the highest possible difference, below and above 0.
    classes : sequence of length o, optional
        The class of each object: numbers or names. Without classes there is no interval of new classes.

    Returns
    -------
    PairedComparison
        By the rules of this module. A p value is below 1 - confidence exactly if its interval excludes 0. Intervals
        lie within the bounds and contain the mean. If the sign-change test can reject no mean, the interval reaches
        from bound to bound: for confidence 95 % with two to five objects. With a single object both ends are NaN and
        the p value is 1.

    Raises
    ------
    ValueError
        If there is no object, or a difference lies outside the bounds by more than 1e-9.
    """
    differences, mean = _checked(differences, weights, bounds)
    significance = _significance(parameters)
    tested = sign_change_test(
        differences, weights / weights.sum(), parameters.permutations, significance
    )
    p_value, interval = tested.p_value, Interval(mean, math.nan, math.nan)
    if len(differences) > 1:
        tail = significance / 2
        low = _unobserved_low_end(differences, weights, bounds[0], tail)
        high = -_unobserved_low_end(-differences, weights, -bounds[1], tail)
        interval = Interval(
            mean,
            max(bounds[0], min(tested.low, low, mean)),
            min(bounds[1], max(tested.high, high, mean)),
        )
        p_value = max(p_value, _unobserved_p_value(differences, weights, mean, bounds))
    p_value = _agreeing(p_value, interval, significance)
    missing = Interval(mean, math.nan, math.nan)
    if classes is None:
        return PairedComparison(
            interval, p_value, len(differences), tested.exact, missing, math.nan, 0
        )
    means = _class_means(differences, weights, classes)
    widened = _widened(interval, means, bounds, significance)
    p_classes = math.nan
    if not math.isnan(widened.low):
        p_classes = max(p_value, student.two_sided(means.mean, means.error, means.count - 1))
        p_classes = _agreeing(p_classes, widened, significance)
    return PairedComparison(
        interval, p_value, len(differences), tested.exact, widened, p_classes, means.count
    )


def _unobserved_low_end(
    values: FloatArray, weights: FloatArray, worst: float, tail: float
) -> float:
    """Compute the low end for unobserved failures only; infinite if `worst` is."""
    if math.isinf(worst):
        return math.inf
    unobserved = _unobserved_weight(tuple(weights.tolist()), tail)
    return (1 - unobserved) * float(values.max()) + unobserved * worst


def _unobserved_p_value(
    differences: FloatArray, weights: FloatArray, mean: float, bounds: Bounds
) -> float:
    """Compute the two-sided p value of a mean of 0 by the rule of unobserved failures; 0 for an infinite bound."""
    best, worst = (
        (float(differences.max()), bounds[0]) if mean > 0 else (float(differences.min()), bounds[1])
    )
    if math.isinf(worst):
        return 0.0
    # The mean is 0 if the extra object has this share of the total weight.
    share = best / (best - worst)
    extra = np.einsum("o,o", weights, weights) / np.sum(weights)
    slopes = np.append(weights * share, extra * (share - 1))
    return min(1.0, 2 * _probability_below_zero(slopes))


def _agreeing(p_value: float, interval: Interval, significance: float) -> float:
    """Return the p value, moved across the significance level where only rounding parts it from the interval."""
    if abs(p_value - significance) > _ROUNDING:
        return p_value
    if interval.low > 0 or interval.high < 0:
        return min(p_value, math.nextafter(significance, 0))
    return max(p_value, significance)


def holm(p_values: Sequence[float]) -> list[float]:
    """Return p values with Holm's correction for the number of given p values, at most 1, in the given order.

    S. Holm, Scandinavian Journal of Statistics 6:65-70, 1979.
    """
    order = np.argsort(p_values, kind="stable")
    steps = np.arange(len(p_values), 0, -1) * np.asarray(p_values)[order]
    adjusted = np.empty(len(p_values))
    adjusted[order] = np.minimum(np.maximum.accumulate(steps), 1.0)
    return adjusted.tolist()
