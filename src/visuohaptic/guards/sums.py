"""A guard of the figures: they are summed again from the predictions, by other lines."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping
from statistics import fmean
from typing import Any

import numpy as np
import pyarrow as pa

from visuohaptic.guards.verdicts import Verdict, judge

SUMS = "figures are the sums of the predictions"
NEAR = 2e-5
"""Figures are rounded to six digits."""

MOST_SIGNS = 14
"""Objects of which all sign changes are taken."""

Cell = tuple[str, str, str]
Owner = tuple[str, str]
Row = Mapping[str, Any]
"""Sequences of one object that were predicted alike in one split: keys, and `viewpoint_count`."""

_KEYS = [
    *("pipeline", "strategy", "classifier", "split", "seed"),
    *("class", "object", "predicted", "voted"),
]


def guard_sums(metrics: Mapping[str, Any], predictions: pa.Table) -> Verdict:
    """Sum `reports/metrics.json` again, from all predictions of the run; of several wrong figures name the first."""
    pairs = list(_pairs(metrics, predictions))
    wrong = [
        name
        for name, published, again in pairs
        if published is None or abs(published - again) > NEAR * max(1.0, abs(again))
    ]
    found = f"{len(pairs)} figures were summed again from {predictions.num_rows} predictions"
    if wrong:
        found += f", and {len(wrong)} differ: {wrong[0]} first"
    return judge(SUMS, held=bool(pairs) and not wrong, found=f"{found}.")


def _pairs(
    metrics: Mapping[str, Any], predictions: pa.Table
) -> Iterator[tuple[str, float | None, float]]:
    """Give the name of each figure, as it was published and as it is summed again."""
    cells: dict[Cell, list[Row]] = defaultdict(list)
    for row in predictions.group_by(_KEYS).aggregate([("viewpoint", "count")]).to_pylist():
        cells[row["pipeline"], row["strategy"], row["classifier"]].append(row)
    published = metrics["results"]
    for key, rows in sorted(cells.items()):
        figures = published.get(key[0], {}).get(key[1], {}).get(key[2], {})
        for name, again in _sum_again(rows).items():
            yield f"{name} of {', '.join(key)}", figures.get(name, {}).get("mean"), again
    for pipeline, classifiers in metrics["comparisons"].items():
        for classifier, others in classifiers.items():
            for other, found in others.items():
                rows, against = (cells[pipeline, one, classifier] for one in ("fixation", other))
                first, second = _shares(rows), _shares(against)
                name = f"fixation against {other}, {pipeline}, {classifier}"
                apart = {key: first[key] - second[key] for key in first}
                weights = _sums(rows, rows)
                yield f"difference: {name}", found["difference"]["mean"], _mean(apart, weights)
                if found["exact"] and len(apart) <= MOST_SIGNS:
                    yield f"p value: {name}", found["p_value"], _sign_test(apart, weights)


def _sum_again(rows: list[Row]) -> dict[str, float]:
    tests = defaultdict(list)
    for row in rows:
        tests[row["split"], row["seed"]].append(row)
    shares = _shares(rows)
    classes = defaultdict(list)
    for (name, _), share in shares.items():
        classes[name].append(share)
    return {
        "accuracy": fmean(
            _count(row for row in some if row["predicted"] == row["class"]) / _count(some)
            for some in tests.values()
        ),
        "object_accuracy": fmean(_credit(some) for some in tests.values()),
        "balanced_accuracy": fmean(map(fmean, classes.values())),
    }


def _count(rows: Iterable[Row]) -> int:
    return sum(row["viewpoint_count"] for row in rows)


def _credit(rows: list[Row]) -> float:
    """Give the share of a split's objects that a vote of their sequences classifies correctly."""
    objects = defaultdict(list)
    for row in rows:
        objects[row["class"], row["object"]].append(row)
    shares = []
    for (name, _), some in objects.items():
        if some[0]["voted"] is not None:
            shares.append(float(some[0]["voted"] == name))
            continue
        most = max(row["viewpoint_count"] for row in some)
        first = [row["predicted"] for row in some if row["viewpoint_count"] == most]
        shares.append((name in first) / len(first))
    return fmean(shares)


def _shares(rows: list[Row]) -> dict[Owner, float]:
    """Give each object's accuracy over its splits, weighted as `_sums` are."""
    right = _sums([row for row in rows if row["predicted"] == row["class"]], rows)
    return {key: right.get(key, 0.0) / weight for key, weight in sorted(_sums(rows, rows).items())}


def _sums(rows: list[Row], all_rows: list[Row]) -> dict[Owner, float]:
    """Give each object's weight: over splits, the sum of its rows' share of all sequences."""
    sizes: Counter[tuple[int, int]] = Counter()
    for row in all_rows:
        sizes[row["split"], row["seed"]] += row["viewpoint_count"]
    found: dict[Owner, float] = defaultdict(float)
    for row in rows:
        size = sizes[row["split"], row["seed"]]
        found[row["class"], row["object"]] += row["viewpoint_count"] / size
    return found


def _mean(values: Mapping[Any, float], weights: Mapping[Any, float]) -> float:
    return sum(values[key] * weights[key] for key in values) / sum(weights.values())


def _sign_test(values: Mapping[Any, float], weights: Mapping[Any, float]) -> float:
    """Give the share of all sign changes whose sum is as far from 0, to either side."""
    parts = np.array([values[key] * weights[key] for key in values])
    parts /= sum(weights.values())
    sums = np.array([0.0])
    for part in parts:
        sums = np.concatenate([sums + part, sums - part])
    return float(np.mean(np.abs(sums) >= abs(parts.sum()) - 1e-12))
