"""Compare rules for intervals of leads: `python -m benchmarks.leads [OBJECTS] [TRIALS]`.

With `--classes CLASSES` rules for intervals of new classes are compared. Prints for each rule and group of worlds the
smallest and the mean coverage in percent, and the mean width in points. The results are in docs/intervals.md.
"""

from __future__ import annotations

import argparse
import functools
from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np
from scipy.special import ndtr, ndtri, stdtrit
from scipy.stats import beta

from benchmarks import intervals
from turned.kept import HEADLINE_TOUCHES, read_turned
from visuohaptic.base.arrays import FloatArray
from visuohaptic.evaluation.intervals import (
    DIFFERENCE,
    EXTRA,
    SHARE,
    Bounds,
    class_interval,
    compare_differences,
    object_interval,
)
from visuohaptic.recognition.parameters import IntervalParameters

Ends = tuple[FloatArray, FloatArray]
Rule = Callable[[FloatArray], Ends]
"""Takes leads (sets, objects), and returns low and high ends (sets,)."""
ClassRule = Callable[[FloatArray, Bounds], Ends]
"""Takes values (sets, classes, objects) and their bounds, and returns low and high ends (sets,)."""
Worlds = Iterator[tuple[str, float, FloatArray]]
"""Yields the group of a simulated or real world, its true mean, and values."""

TAIL = 0.025
PARAMETERS = IntervalParameters()
RESAMPLED = 999
SIGN_CHANGES = 4096
KEPT_FRAMES = {
    ("none", "full"),
    ("vertical", "full"),
    ("vertical", "vertical"),
    ("any", "full"),
    ("any", "none"),
}
LEADS = (0.0, 0.05, 0.1)


def kept_leads() -> Iterator[tuple[FloatArray, tuple[str, ...]]]:
    """Yield the kept leads of fixation by five touches on 142 objects, and the objects' classes."""
    kept = read_turned()["benchmark"]
    classes = np.array(kept.classes)
    cells = {
        (cell.turns, cell.known, cell.pipeline, cell.strategy): cell.accuracy
        for cell in kept.cells
        if cell.touches == HEADLINE_TOUCHES
    }
    for (turns, known, pipeline, strategy), values in cells.items():
        if strategy == "fixation" and (turns, known) in KEPT_FRAMES:
            for other in ("random", "random_visible"):
                lead = values - cells[turns, known, pipeline, other]
                tested = np.isfinite(lead)
                yield lead[tested], tuple(classes[tested].tolist())


def worlds(objects: int, trials: int) -> Worlds:
    """Draw sets of paired differences with known true mean; values have the shape (trials, objects)."""
    generator = np.random.default_rng(1)
    size = (trials, objects)
    for lead in LEADS:
        group = "lead" if lead else "no lead"
        for second in (0.5, 0.8, 0.95):
            first = min(second + lead, 1.0)
            for shared in (0.0, 0.5):
                chance = generator.random(size)
                other = np.where(generator.random(size) < shared, chance, generator.random(size))
                is_right, is_other_right = chance < first, other < first - lead
                drawn = is_right.astype(np.float64) - is_other_right.astype(np.float64)
                yield f"all or nothing, {group}", lead, drawn
        for second in (0.6, 0.81, 0.9, 0.985):
            first = min(second + lead, 0.99)
            for correlation in (0.3, 0.7):
                own = generator.normal(size=size)
                rest = np.sqrt(1 - correlation**2) * generator.normal(size=size)
                drawn = _accuracies(own, first) - _accuracies(
                    correlation * own + rest, first - lead
                )
                yield f"accuracies, {group}", lead, drawn
    for shares in ((0.02, 0.02), (0.1, 0.1), (0.05, 0.15)):
        hard = [
            np.where(generator.random(size) < share, generator.uniform(0, 0.6, size), 1.0)
            for share in shares
        ]
        lead = 0.7 * (shares[1] - shares[0])
        yield f"accuracies, {'lead' if lead else 'no lead'}", lead, hard[0] - hard[1]
    for values, _ in kept_leads():
        resampled: FloatArray = generator.choice(values, size)
        yield "kept", float(values.mean()), resampled


def _accuracies(normal: FloatArray, mean: float) -> FloatArray:
    """Turn standard normal values into values of a beta distribution with the given mean."""
    values: FloatArray = beta.ppf(ndtr(normal), 4 * mean, 4 * (1 - mean))
    return values


def former(values: FloatArray) -> Ends:
    """Return the rule of accuracies with the bounds of differences, which leads had before."""
    low, high = intervals.ours(values.shape[1])((values + 1) / 2)
    return 2 * low - 1, 2 * high - 1


def student(values: FloatArray) -> Ends:
    """Return Student's interval."""
    objects = values.shape[1]
    reach = stdtrit(objects - 1, 1 - TAIL) * values.std(axis=1, ddof=1) / np.sqrt(objects)
    return values.mean(axis=1) - reach, values.mean(axis=1) + reach


def bootstrap_t(values: FloatArray) -> Ends:
    """Return the bootstrap-t interval (P. Hall, Annals of Statistics 16(3), 1988)."""
    objects = values.shape[1]
    drawn = np.random.default_rng(3).integers(0, objects, (RESAMPLED, objects))
    found = []
    for one in values:
        resampled = one[drawn]
        shift, spread = resampled.mean(axis=1) - one.mean(), resampled.std(axis=1, ddof=1)
        ratio = np.divide(shift, spread, out=_unlimited(shift), where=spread > 1e-12)
        low, high = np.quantile(ratio, [TAIL, 1 - TAIL], method="nearest")
        scale = one.std(ddof=1)
        ends = (
            (one.mean(), one.mean()) if scale == 0 else one.mean() - scale * np.array([high, low])
        )
        found.append(np.clip(ends, -1, 1))
    return np.array(found)[:, 0], np.array(found)[:, 1]


def _unlimited(values: FloatArray) -> FloatArray:
    """Return infinity with the sign of each value; 0 of 0."""
    return np.select([values > 0, values < 0], [np.inf, -np.inf], 0.0)


def accelerated(values: FloatArray) -> Ends:
    """Return the BCa bootstrap (B. Efron, Journal of the American Statistical Association 82, 1987)."""
    objects = values.shape[1]
    counts = np.random.default_rng(3).multinomial(objects, np.full(objects, 1 / objects), RESAMPLED)
    means, mean = np.sort(values @ counts.T / objects, axis=1), values.mean(axis=1)
    below = (means < mean[:, None]).mean(axis=1) + (means == mean[:, None]).mean(axis=1) / 2
    bias = ndtri(np.clip(below, 1e-3, 1 - 1e-3))
    from_mean = values - mean[:, None]
    spread = np.maximum((from_mean**2).sum(axis=1), 1e-30)
    acceleration = (from_mean**3).sum(axis=1) / (6 * spread**1.5)
    ends = []
    for level in (TAIL, 1 - TAIL):
        moved = bias + ndtri(level)
        chance = ndtr(bias + moved / (1 - acceleration * moved))
        place = np.clip((chance * RESAMPLED).astype(int), 0, RESAMPLED - 1)
        ends.append(means[np.arange(len(values)), place])
    return ends[0], ends[1]


@functools.lru_cache
def _groups(objects: int) -> FloatArray:
    """Return groups of objects as 0 and 1 (groups, objects): half of all sign changes, or a sample."""
    if 2 ** (objects - 1) <= SIGN_CHANGES:
        return (np.arange(2 ** (objects - 1))[:, None] >> np.arange(objects) & 1).astype(float)
    return np.random.default_rng(5).integers(0, 2, (SIGN_CHANGES, objects)).astype(float)


def sign_changes(values: FloatArray, extra: float | None = None) -> Ends:
    """Return the means that the sign-change test does not reject; `extra` is the value of one object more."""

    def low(values: FloatArray) -> FloatArray:
        if extra is not None:
            values = np.hstack([values, np.full((len(values), 1), extra)])
        groups = _groups(values.shape[1])
        inside = groups.sum(axis=1)
        outside = values.shape[1] - inside
        sums = values @ groups.T
        rest = values.sum(axis=1, keepdims=True) - sums
        never = np.full_like(sums, -np.inf)
        means = np.minimum(
            np.divide(sums, inside, out=never.copy(), where=inside > 0),
            np.divide(rest, outside, out=never, where=outside > 0),
        )
        rank = int(np.ceil(2 * TAIL * len(groups))) - 1
        return np.clip(np.partition(means, rank, axis=1)[:, rank], -1, 1)

    return low(values), -low(-values)


def unobserved(values: FloatArray) -> Ends:
    """Return the ends for unobserved failures."""
    kept = beta.ppf(TAIL, values.shape[1], EXTRA)
    return kept * values.max(axis=1) - (1 - kept), kept * values.min(axis=1) + (1 - kept)


def hull(*rules: Ends) -> Ends:
    """Return the lowest of low ends and the highest of high ends."""
    return np.min([low for low, _ in rules], axis=0), np.max([high for _, high in rules], axis=0)


def ours(values: FloatArray) -> Ends:
    """Return the rule of `visuohaptic.evaluation.intervals`."""
    found = [compare_differences(one, np.ones(len(one)), PARAMETERS).difference for one in values]
    return np.array([one.low for one in found]), np.array([one.high for one in found])


RULES: Mapping[str, Rule] = {
    "former rule, as for accuracies": former,
    "Student": student,
    "bootstrap-t": bootstrap_t,
    "BCa bootstrap": accelerated,
    "sign changes": sign_changes,
    "sign changes, an object more at the bound": lambda values: sign_changes(values, -1.0),
    "Student, and unobserved failures": lambda values: hull(student(values), unobserved(values)),
    "ours: sign changes, and unobserved failures": ours,
}


def class_worlds(
    classes: int, objects: int, trials: int
) -> Iterator[tuple[str, float, FloatArray, Bounds]]:
    """Draw sets of classes with known true mean; values have the shape (trials, classes, objects)."""
    generator = np.random.default_rng(1)
    size = (trials, classes, objects)
    for lead in LEADS:
        for between, within in ((0.19, 0.186), (0.1, 0.2), (0.0, 0.2), (0.19, 0.05)):
            means = generator.normal(lead, between, (trials, classes, 1))
            drawn = means + generator.normal(0, within, size)
            yield "leads, normal", lead, np.clip(drawn, -1, 1), DIFFERENCE
        ahead = generator.random((trials, classes, 1)) < 0.15
        means = lead + np.where(ahead, 0.34, -0.06)
        drawn = np.clip(means + generator.normal(0, 0.1, size), -1, 1)
        yield "leads, few classes ahead", lead, drawn, DIFFERENCE
    for mean in (0.6, 0.81, 0.95, 0.985):
        for concentration in (4, 15):
            shapes = concentration * mean, concentration * (1 - mean)
            means = np.clip(generator.beta(*shapes, (trials, classes, 1)), 1e-6, 1 - 1e-6)
            group = "accuracies to 0.81" if mean < 0.9 else "accuracies from 0.95"
            yield group, mean, generator.beta(8 * means, 8 * (1 - means), size), SHARE
            yield group, mean, np.where(generator.random(size) < means, 1.0, 0.0), SHARE
    for values, names in kept_leads():
        by_class = [values[np.array(names) == name] for name in sorted(set(names))]
        drawn = np.empty(size)
        chosen = generator.integers(0, len(by_class), (trials, classes))
        for number, of_class in enumerate(by_class):
            inside = chosen == number
            drawn[inside] = generator.choice(of_class, (int(inside.sum()), objects))
        mean = float(np.mean([of_class.mean() for of_class in by_class]))
        yield "leads, kept", mean, drawn, DIFFERENCE


def new_objects(values: FloatArray, bounds: Bounds) -> Ends:
    """Return the interval of new objects."""
    return _computed(values, bounds, is_of_classes=False)


def class_bootstrap(values: FloatArray, *, inner: bool) -> Ends:
    """Return the percentile bootstrap of classes, or (`inner`) of classes and then of objects."""
    generator = np.random.default_rng(4)
    trials, classes, objects = values.shape
    means = np.empty((trials, RESAMPLED))
    for number in range(RESAMPLED):
        chosen = generator.integers(0, classes, (classes,))
        if inner:
            places = generator.integers(0, objects, (classes, objects))
            taken = values[:, chosen[:, None], places]
        else:
            taken = values[:, chosen]
        means[:, number] = taken.mean(axis=(1, 2))
    low, high = np.quantile(means, [TAIL, 1 - TAIL], axis=1)
    return low, high


def class_student(values: FloatArray, bounds: Bounds) -> Ends:
    """Return Student's interval of the means of classes."""
    low, high = student(values.mean(axis=2))
    return np.clip(low, *bounds), np.clip(high, *bounds)


def class_sign_changes(values: FloatArray, bounds: Bounds) -> Ends:
    """Return the means that the sign-change test over the means of classes does not reject."""
    low, high = sign_changes(values.mean(axis=2))
    return np.clip(low, *bounds), np.clip(high, *bounds)


def ours_of_classes(values: FloatArray, bounds: Bounds) -> Ends:
    """Return the rule of new classes of `visuohaptic.evaluation.intervals`."""
    return _computed(values, bounds, is_of_classes=True)


def _computed(values: FloatArray, bounds: Bounds, *, is_of_classes: bool) -> Ends:
    trials, classes, objects = values.shape
    names, weights = np.repeat(np.arange(classes), objects), np.ones(classes * objects)
    found = []
    for one in values.reshape(trials, -1):
        if bounds == SHARE:
            near = object_interval(one, weights, PARAMETERS)
            wide = class_interval(one, weights, names, PARAMETERS)
        else:
            compared = compare_differences(one, weights, PARAMETERS, bounds, names)
            near, wide = compared.difference, compared.difference_new_classes
        found.append(wide if is_of_classes else near)
    return np.array([one.low for one in found]), np.array([one.high for one in found])


CLASS_RULES: Mapping[str, ClassRule] = {
    "new objects": new_objects,
    "bootstrap of classes": lambda values, _: class_bootstrap(values, inner=False),
    "bootstrap of classes, then objects": lambda values, _: class_bootstrap(values, inner=True),
    "sign changes of the means of classes": class_sign_changes,
    "Student of the means of classes": class_student,
    "ours: Student of the means of classes, and new objects": ours_of_classes,
}


def covered(ends: Ends, mean: float) -> tuple[float, float]:
    """Return the share of intervals that hold the mean, and their mean width in points."""
    low, high = ends
    held = (low - 1e-9 <= mean) & (mean <= high + 1e-9)
    return 100 * float(np.mean(held)), 100 * float(np.mean(high - low))


def lines(found: Mapping[str, Mapping[str, Sequence[tuple[float, float]]]]) -> Iterator[str]:
    """Yield a table's lines: per rule and group the least and the mean coverage (%) and the mean width (points)."""
    groups = list(next(iter(found.values())))
    yield " | ".join(["rule", *groups])
    for rule, measured in found.items():
        cells = []
        for group in groups:
            shares, widths = np.array(measured[group]).T
            cells.append(f"{shares.min():.1f} / {shares.mean():.1f}, {widths.mean():.1f}")
        yield " | ".join([rule, *cells])


def measure_leads(objects: int, trials: int) -> Iterator[str]:
    """Yield the lines of the table of leads."""
    found: dict[str, dict[str, list[tuple[float, float]]]] = {rule: {} for rule in RULES}
    for group, mean, values in worlds(objects, trials):
        for name, rule in RULES.items():
            found[name].setdefault(group, []).append(covered(rule(values), mean))
    yield from lines(found)


def measure_classes(classes: int, objects: int, trials: int) -> Iterator[str]:
    """Yield the lines of the table of new classes."""
    found: dict[str, dict[str, list[tuple[float, float]]]] = {rule: {} for rule in CLASS_RULES}
    for group, mean, values, bounds in class_worlds(classes, objects, trials):
        for name, rule in CLASS_RULES.items():
            found[name].setdefault(group, []).append(covered(rule(values, bounds), mean))
    yield from lines(found)


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser("python -m benchmarks.leads")
    parser.add_argument("objects", nargs="?", type=int, default=12)
    parser.add_argument("trials", nargs="?", type=int, default=400)
    parser.add_argument("--classes", type=int, help="compare rules for so many new classes")
    arguments = parser.parse_args()
    objects, trials, classes = arguments.objects, arguments.trials, arguments.classes
    found = (
        measure_classes(classes, objects // classes, trials)
        if classes
        else measure_leads(objects, trials)
    )
    for line in found:
        print(line)


if __name__ == "__main__":
    main()
