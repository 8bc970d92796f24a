"""Compare rules for intervals over objects: `python -m benchmarks.intervals [OBJECTS] [TRIALS]`.

Prints the smallest coverage of each rule over simulated sets of objects, and mean widths in points. The results are in
docs/intervals.md. `python -m benchmarks.leads` compares rules for leads and for new classes.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping

import numpy as np
from scipy.special import ndtr, stdtrit
from scipy.stats import beta, binom

from visuohaptic.base.arrays import FloatArray
from visuohaptic.evaluation.intervals import EXTRA

Ends = tuple[FloatArray, FloatArray]
Rule = Callable[[FloatArray], Ends]
"""Takes accuracies (sets, objects), and returns low and high ends (sets,)."""

DRAWS = 4000
TAIL = 0.025
CONCENTRATION = 4
ALL_OR_NOTHING = np.arange(0.5, 0.9901, 0.0025)


def accuracies(objects: int, trials: int) -> Mapping[str, tuple[float, FloatArray]]:
    """Draw sets of objects with known true mean. Returns the mean and accuracies (trials, objects) by name."""
    generator = np.random.default_rng(1)
    size = (trials, objects)
    drawn: dict[str, tuple[float, FloatArray]] = {}
    for mean in (0.6, 0.81, 0.95, 0.985, 0.998):
        shapes = CONCENTRATION * mean, CONCENTRATION * (1 - mean)
        drawn[f"mean {mean}"] = (mean, generator.beta(*shapes, size))
    for share in (0.02, 0.1, 0.3):
        is_hard = generator.random(size) < share
        hard = np.where(is_hard, generator.uniform(0, 0.6, size), 1.0)
        drawn[f"{share} hard, others perfect"] = (1 - 0.7 * share, hard)
    return drawn


def percentile(objects: int) -> Rule:
    """Return the expanded percentile bootstrap (T. Hesterberg, The American Statistician 69(4), 2015)."""
    tail = ndtr(np.sqrt(objects / (objects - 1)) * stdtrit(objects - 1, TAIL))
    counts = np.random.default_rng(2).multinomial(
        objects, np.full(objects, 1 / objects), size=DRAWS
    )

    def ends(values: FloatArray) -> Ends:
        means = counts @ values.T / objects
        return np.quantile(means, tail, axis=0), np.quantile(means, 1 - tail, axis=0)

    return ends


def binomial(objects: int) -> Rule:
    """Return binomial limits with the sum as successes (C. Clopper and E. Pearson, Biometrika 26(4), 1934)."""

    def ends(values: FloatArray) -> Ends:
        right = values.sum(axis=1)
        wrong = np.maximum(objects - right, 0)
        low = beta.ppf(TAIL, np.maximum(right, 1e-9), wrong + 1)
        return low, beta.ppf(1 - TAIL, right + 1, np.maximum(wrong, 1e-9))

    return ends


def student(objects: int) -> Rule:
    """Return Student's interval with two extra objects, at 0 and at 1. This rule is not monotone."""

    def ends(values: FloatArray) -> Ends:
        count = objects + 2
        mean = (values.sum(axis=1) + 1) / count
        spread = ((values**2).sum(axis=1) + 1) / count - mean**2
        reach = stdtrit(objects - 1, 1 - TAIL) * np.sqrt(spread / (count - 1))
        return np.maximum(mean - reach, 0), np.minimum(mean + reach, 1)

    return ends


def weights(objects: int, extra: float) -> tuple[FloatArray, FloatArray]:
    """Draw weights of objects (draws, objects) and of an extra object (draws, 1) with sum 1."""
    generator = np.random.default_rng(3)
    own = generator.standard_gamma(1, size=(DRAWS, objects))
    further = generator.standard_gamma(extra, size=(DRAWS, 1))
    total = own.sum(axis=1, keepdims=True) + further
    return own / total, further / total


def extra_at_the_bounds(objects: int, extra: float = 1) -> Rule:
    """Return the bound of N. Gaffke: Dirichlet weights with an extra object of value 0 or 1."""
    own, further = weights(objects, extra)

    def ends(values: FloatArray) -> Ends:
        means = own @ values.T
        return np.quantile(means, TAIL, axis=0), np.quantile(means + further, 1 - TAIL, axis=0)

    return ends


def ours(objects: int, extra: float = EXTRA) -> Rule:
    """Return the rule of `visuohaptic.evaluation.intervals`, computed from random draws."""
    own, further = weights(objects, extra)
    kept = beta.ppf(TAIL, objects, extra)

    def ends(values: FloatArray) -> Ends:
        means = own @ values.T
        least, most = values.min(axis=1), values.max(axis=1)
        low = np.quantile(means + further * least, TAIL, axis=0)
        high = np.quantile(means + further * most, 1 - TAIL, axis=0)
        return np.minimum(low, kept * most), np.maximum(high, kept * least + 1 - kept)

    return ends


RULES: Mapping[str, Callable[[int], Rule]] = {
    "expanded percentile bootstrap": percentile,
    "binomial limits of the sum": binomial,
    "Student, an object more at 0 and at 1": student,
    "Gaffke: one object more at the bound": extra_at_the_bounds,
    "three quarters of an object more at the bound": lambda objects: extra_at_the_bounds(
        objects, EXTRA
    ),
    "ours": ours,
}


def all_or_nothing(rule: Rule, objects: int) -> float:
    """Compute the smallest coverage for objects with accuracy 0 or 1, over the probability of 1."""
    values = (np.arange(objects) < np.arange(objects + 1)[:, None]).astype(np.float64)
    low, high = rule(values)
    rates = ALL_OR_NOTHING[:, None]
    held = (low <= rates + 1e-9) & (rates - 1e-9 <= high)
    chances = binom.pmf(np.arange(objects + 1), objects, rates)
    return float(np.min(np.sum(chances * held, axis=1)))


def row(rule: Rule, objects: int, drawn: Mapping[str, tuple[float, FloatArray]]) -> str:
    """Write a rule's smallest coverages and mean widths as cells of a table."""
    covered, widths = [], []
    for mean, values in drawn.values():
        low, high = rule(values)
        covered.append(float(np.mean((low <= mean) & (mean <= high))))
        widths.append(100 * float(np.mean(high - low)))
    cells = [f"{100 * all_or_nothing(rule, objects):.1f} %", f"{100 * min(covered):.1f} %"]
    return " | ".join([*cells, *(f"{width:.1f}" for width in widths)])


def main() -> None:
    """Print the table for a number of objects."""
    parser = argparse.ArgumentParser("python -m benchmarks.intervals")
    parser.add_argument("objects", nargs="?", type=int, default=12)
    parser.add_argument("trials", nargs="?", type=int, default=2000)
    arguments = parser.parse_args()
    drawn = accuracies(arguments.objects, arguments.trials)
    print(" | ".join(["rule", "all or nothing", "accuracies", *drawn]))
    for name, make in RULES.items():
        print(f"{name} | {row(make(arguments.objects), arguments.objects, drawn)}", flush=True)


if __name__ == "__main__":
    main()
