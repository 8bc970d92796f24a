"""A guard of the figures: they are summed again from the predictions, by other lines."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from statistics import fmean
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa

from visuohaptic.guards.verdicts import Verdict, judge

SUMS = "figures are the sums of the predictions"
NEAR = 2e-5
"""Figures are rounded to six digits."""

MOST_SIGNS = 14
"""Objects of which all sign changes are taken."""

Row = Mapping[str, Any]
"""Sequences of one object that were predicted alike in one split: keys, and `viewpoint_count`."""

_KEYS = [
    *("pipeline", "strategy", "classifier", "split", "seed"),
    *("class", "object", "predicted", "voted"),
]


class _Sums(NamedTuple):
    """Figures by name; and by object, in order, its accuracy and its weight: over splits, its share of all sequences."""

    figures: dict[str, float]
    shares: dict[tuple[str, str], float]
    weights: list[float]


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
    rows = predictions.group_by(_KEYS).aggregate([("viewpoint", "count")]).to_pylist()
    cells = {key: _sum_again(some) for key, some in _grouped(rows, *_KEYS[:3]).items()}
    published = metrics["results"]
    for key, sums in sorted(cells.items()):
        figures = published.get(key[0], {}).get(key[1], {}).get(key[2], {})
        for name, again in sums.figures.items():
            yield f"{name} of {', '.join(key)}", figures.get(name, {}).get("mean"), again
    for pipeline, classifiers in metrics["comparisons"].items():
        for classifier, others in classifiers.items():
            for other, found in others.items():
                ours, against = (cells[pipeline, one, classifier] for one in ("fixation", other))
                parts = np.array([ours.shares[key] - against.shares[key] for key in ours.shares])
                parts *= np.array(ours.weights) / sum(ours.weights)
                name = f"fixation against {other}, {pipeline}, {classifier}"
                yield f"difference: {name}", found["difference"]["mean"], float(parts.sum())
                if found["exact"] and len(parts) <= MOST_SIGNS:
                    yield f"p value: {name}", found["p_value"], _sign_test(parts)


def _grouped(rows: Iterable[Row], *names: str) -> dict[tuple[Any, ...], list[Row]]:
    groups = defaultdict(list)
    for row in rows:
        groups[tuple(row[name] for name in names)].append(row)
    return groups


def _sum_again(rows: list[Row]) -> _Sums:
    accuracies, votes = [], []
    right: defaultdict[tuple[str, str], float] = defaultdict(float)
    weights: defaultdict[tuple[str, str], float] = defaultdict(float)
    for test in _grouped(rows, "split", "seed").values():
        size = sum(row["viewpoint_count"] for row in test)
        correct = [row for row in test if row["predicted"] == row["class"]]
        accuracies.append(sum(row["viewpoint_count"] for row in correct) / size)
        votes.append(fmean(map(_vote, _grouped(test, "class", "object").values())))
        for sums, some in ((weights, test), (right, correct)):
            for row in some:
                sums[row["class"], row["object"]] += row["viewpoint_count"] / size
    shares = {key: right[key] / weights[key] for key in sorted(weights)}
    classes = defaultdict(list)
    for (name, _), share in shares.items():
        classes[name].append(share)
    figures = {
        "accuracy": fmean(accuracies),
        "object_accuracy": fmean(votes),
        "balanced_accuracy": fmean(map(fmean, classes.values())),
    }
    return _Sums(figures, shares, [weights[key] for key in shares])


def _vote(rows: list[Row]) -> float:
    """Give whether a vote of an object's sequences in a split is right; where some tie, the share of these."""
    name, voted = rows[0]["class"], rows[0]["voted"]
    if voted is not None:
        return float(voted == name)
    most = max(row["viewpoint_count"] for row in rows)
    first = [row["predicted"] for row in rows if row["viewpoint_count"] == most]
    return (name in first) / len(first)


def _sign_test(parts: np.ndarray) -> float:
    """Give the share of all sign changes whose sum is as far from 0, to either side."""
    sums = np.array([0.0])
    for part in parts:
        sums = np.concatenate([sums + part, sums - part])
    return float(np.mean(np.abs(sums) >= abs(parts.sum()) - 1e-12))
