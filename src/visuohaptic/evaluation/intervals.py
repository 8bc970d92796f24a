"""Intervals and tests that resample objects, for sequences of one object are not independent.

What is resampled is a value an object (its accuracy over every split that tested
it), with the predictions as they are: the intervals show how the figure would vary
with other test objects of the same kind, not with other training.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.recognition.parameters import IntervalParameters


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


def resample_objects(objects: int, samples: int, generator: np.random.Generator) -> IntArray:
    """Draw bootstrap samples: how often each object is in each, shape (samples, objects)."""
    return generator.multinomial(objects, np.full(objects, 1 / objects), size=samples)


def object_interval(
    values: FloatArray,
    weights: FloatArray,
    parameters: IntervalParameters,
    generator: np.random.Generator,
) -> Interval:
    """Give the mean of values of objects (o,), of positive weights (o,), with its bootstrap interval.

    Objects are drawn with replacement from all, not class by class. The percentiles are expanded for
    few objects (T. Hesterberg, "What teachers should know about the bootstrap", The American
    Statistician 69(4), 2015). Of a single object both ends are NaN.
    """
    return object_intervals(values[:, None], weights, parameters, generator)[0]


def object_intervals(
    values: FloatArray,
    weights: FloatArray,
    parameters: IntervalParameters,
    generator: np.random.Generator,
) -> list[Interval]:
    """Give k figures (o, k) of objects as `object_interval` gives each, over the same samples."""
    means = weights @ values / weights.sum()
    if len(values) < 2:
        return [Interval(float(mean), float("nan"), float("nan")) for mean in means]
    drawn = resample_objects(len(values), parameters.bootstrap_samples, generator)
    resampled = drawn @ (values * weights[:, None]) / (drawn @ weights)[:, None]
    return [
        _around(float(mean), column, len(values), parameters.confidence)
        for mean, column in zip(means, resampled.T, strict=True)
    ]


def rate_interval(
    values: FloatArray,
    weights: FloatArray,
    parameters: IntervalParameters,
    generator: np.random.Generator,
) -> Interval:
    """Give a mean of shares as `object_interval` does, with exact binomial limits at 0 and at 1."""
    found = object_interval(values, weights, parameters, generator)
    limit = exact_limit(len(values), parameters.confidence)
    # Sums of shares may miss 1 by a rounding.
    if np.all(values > 1 - 1e-12):
        return Interval(1.0, 1 - limit, 1.0)
    return Interval(0.0, 0.0, limit) if np.all(values < 1e-12) else found


def difference_interval(
    first: FloatArray,
    second: FloatArray,
    weights: FloatArray,
    parameters: IntervalParameters,
    generator: np.random.Generator,
) -> Interval:
    """Give the mean paired difference of shares (o,), first less second, as `object_interval` does.

    Where all objects have the same share under both, the ends are the exact binomial limits.
    """
    found = object_interval(first - second, weights, parameters, generator)
    limit = exact_limit(len(first), parameters.confidence)
    return Interval(0.0, -limit, limit) if np.all(np.abs(first - second) < 1e-12) else found


def exact_limit(objects: int, confidence: float) -> float:
    """Give the largest rate that no event among so many objects leaves possible.

    The exact binomial interval's end (C. Clopper and E. Pearson, Biometrika 26(4), 1934).
    """
    return float(1 - ((1 - confidence) / 2) ** (1 / objects))


def balanced_interval(
    values: FloatArray,
    classes: IntArray,
    parameters: IntervalParameters,
    generator: np.random.Generator,
) -> Interval:
    """Give the mean over classes of the mean over each class's objects, as `object_interval` does."""
    member = (classes[:, None] == np.unique(classes)).astype(np.float64)
    mean = float(np.mean(values @ member / member.sum(axis=0)))
    if len(values) < 2:
        return Interval(mean, float("nan"), float("nan"))
    drawn = resample_objects(len(values), parameters.bootstrap_samples, generator)
    counts = drawn @ member
    sums = (drawn * values) @ member
    held = counts > 0
    means = np.where(held, sums / np.where(held, counts, 1), 0).sum(axis=1) / held.sum(axis=1)
    return _around(mean, means, len(values), parameters.confidence)


def _around(mean: float, means: FloatArray, objects: int, confidence: float) -> Interval:
    """Give a mean with the expanded percentiles of its bootstrap means, shape (samples,)."""
    tail = expanded_tail(objects, confidence)
    low, high = np.quantile(means, [tail, 1 - tail])
    return Interval(mean, float(low), float(high))


def expanded_tail(objects: int, confidence: float) -> float:
    """Give the probability left out at each end: Phi(-sqrt(n / (n - 1)) t), t Student's quantile."""
    from scipy.special import ndtr, stdtrit

    student = stdtrit(objects - 1, (1 - confidence) / 2)
    return float(ndtr(np.sqrt(objects / (objects - 1)) * student))


def compare_paired(
    first: FloatArray,
    second: FloatArray,
    weights: FloatArray,
    parameters: IntervalParameters,
    generator: np.random.Generator,
) -> PairedComparison:
    """Compare values (o,) of the same objects, of positive weights (o,), under two treatments.

    The p value is the share of sign changes of the objects' differences whose mean is at least as
    far from 0: all of them where they fit, else a sample that counts the observed one.
    """
    interval = difference_interval(first, second, weights, parameters, generator)
    parts = (first - second) * weights / weights.sum()
    exact = len(parts) < 63 and 2 ** len(parts) <= parameters.permutations
    if exact:
        places = np.arange(2 ** len(parts))[:, None] >> np.arange(len(parts))
        signs = 1.0 - 2.0 * (places & 1)
    else:
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
