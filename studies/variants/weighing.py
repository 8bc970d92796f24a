"""Compute the figures of each variant from the blocks of the study, and summarise all variants."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from variants.choices import BY_NAME, CHOICES, OPPONENTS
from variants.design import (
    CROSSED_SINGLY,
    FACTORIAL,
    Variant,
    all_variants,
    is_base_but_for,
    is_default,
)
from variants.leads import MAIN_OPPONENT, SAME, against_main, sum_up
from variants.tables import VARIANTS
from visuohaptic.evaluation.published import TABLE_1
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.studies.figures import (
    CELL,
    Cell,
    CellKey,
    Row,
    cells_of,
    compare,
    condition_interval,
    rows_by,
)
from visuohaptic.tables.schema import build_rows, matrix, read_table
from visuohaptic.tables.studies import STUDY


def variant_figures(parts: Iterable[str | Path], intervals: IntervalParameters) -> pa.Table:
    """Return the table `VARIANTS` of the blocks `parts`, with one block in memory at a time.

    Each block is a file of `tables.STUDY`, and holds all rows of its conditions.
    """
    position_of = {variant.name: (index, variant) for index, variant in enumerate(all_variants())}
    rows: list[Row] = []
    for block in parts:
        table = read_table(STUDY, block)
        cells, splits = cells_of(table), split_accuracies(table)
        for name, classifier in dict.fromkeys((key[0], key[3]) for key in cells):
            rows += [
                {
                    **_identity(*position_of[name], classifier, option),
                    **_figures(name, classifier, opponent, cells, splits, intervals),
                }
                for option, opponent in OPPONENTS.items()
            ]
    opponents, classifiers = list(OPPONENTS), list(TABLE_1)
    rows.sort(
        key=lambda row: (
            row["place"],
            opponents.index(row["random_probing"]),
            classifiers.index(row["classifier"]),
        )
    )
    return build_rows(VARIANTS, rows)


def split_accuracies(rows: pa.Table) -> dict[CellKey, NDArray[np.float64]]:
    """Compute the share of test sequences that are correctly classified, per split, by cell.

    `rows` has the columns of `tables.STUDY`. Cells that could not be run are left out.
    """
    accuracies = {}
    for key, cell in rows_by(rows, CELL).items():
        if cell.column("error")[0].as_py() is not None:
            continue
        split, repeat, sequences, accuracy = matrix(
            cell, ["split", "repeat", "sequences", "accuracy"]
        ).T
        _, run = np.unique(split * (repeat.max() + 1) + repeat, return_inverse=True)
        correct = np.bincount(run, weights=np.rint(sequences * accuracy))
        accuracies[CellKey(*key)] = correct / np.bincount(run, weights=sequences)
    return accuracies


def _identity(place: int, variant: Variant, classifier: str, opponent: str) -> Row:
    return {
        "variant": variant.name,
        "classifier": classifier,
        "part": variant.part,
        "place": place,
        **variant.options,
        "random_probing": opponent,
    }


def _figures(
    name: str,
    classifier: str,
    opponent: str,
    cells: Mapping[CellKey, Cell],
    splits: Mapping[CellKey, NDArray[np.float64]],
    intervals: IntervalParameters,
) -> Row:
    row: Row = dict.fromkeys(column.name for column in VARIANTS.columns[4 + len(CHOICES) :])
    strategies = {"fixation": "fixation", "random": opponent}
    keys = {
        column: CellKey(name, "paper", strategy, classifier)
        for column, strategy in strategies.items()
    }
    errors = [cells[key].error if key in cells else "no result" for key in keys.values()]
    if reasons := [error for error in errors if error is not None]:
        return row | {"error": reasons[0]}
    for strategy, key in keys.items():
        interval = condition_interval(cells[key], intervals)
        published = TABLE_1[classifier][strategy]
        row |= {
            strategy: interval.mean,
            f"{strategy}_low": interval.low,
            f"{strategy}_high": interval.high,
            f"{strategy}_best_split": float(splits[key].max()),
            f"{strategy}_splits_reaching": float((splits[key] >= published - SAME).mean()),
        }
    fixation, random = (cells[key] for key in keys.values())
    row |= {
        "objects": len(fixation.objects),
        "splits": len(splits[keys["fixation"]]),
        "seconds": (fixation.seconds or 0.0) + (random.seconds or 0.0),
    }
    if (compared := compare(fixation, random, intervals)) is not None:
        row |= {"ahead": compared.difference.mean, "p_value": compared.p_value}
    return row


def summarise_variants(rows: Sequence[Row]) -> dict[str, Any]:
    """Summarise the variants by classifier, with the main kind of random touches.

    `rows` has the columns of `VARIANTS`. The part ``protocol`` asks another question, and is summarised apart under
    ``known_objects``.
    """
    rows = against_main(rows)
    new_objects = [row for row in rows if row["part"] != "protocol"]
    known_objects = [row for row in rows if row["part"] == "protocol"]
    return {
        "variants": len({row["variant"] for row in new_objects}),
        "random_probing": MAIN_OPPONENT if rows else None,
        "failed": sorted({row["variant"] for row in new_objects if row["error"] is not None}),
        "classifiers": _by_classifier(new_objects),
        "known_objects": _by_classifier(known_objects),
    }


def _by_classifier(rows: Sequence[Row]) -> dict[str, Any]:
    summaries = {}
    for name, published in TABLE_1.items():
        run = [row for row in rows if row["classifier"] == name and row["error"] is None]
        if run:
            summaries[name] = {**_range(run, published), "choices": weigh_choices(run)}
    return summaries


def _range(rows: Sequence[Row], published: Mapping[str, float]) -> dict[str, Any]:
    fixation, random = (np.array([row[name] for row in rows]) for name in ("fixation", "random"))
    reaching = np.array([row["fixation_splits_reaching"] for row in rows])
    best = max(rows, key=lambda row: row["fixation_best_split"])
    led = [row for row in rows if row["ahead"] is not None]
    lead, ahead = sum_up(led), [row["ahead"] for row in led]
    return {
        "variants": len(rows),
        "published": dict(published),
        "lowest": fixation.min(),
        "median": float(np.median(fixation)),
        "highest": fixation.max(),
        "highest_variant": rows[int(fixation.argmax())]["variant"],
        "random_median": float(np.median(random)),
        "default": next((row["fixation"] for row in rows if is_default(row)), None),
        "variants_reaching": int((fixation >= published["fixation"] - SAME).sum()),
        "variants_with_a_split_reaching": int((reaching > 0).sum()),
        "splits_reaching": float(reaching.mean()),
        "highest_split": best["fixation_best_split"],
        "highest_split_variant": best["variant"],
        "ahead": lead.ahead,
        "ahead_singly": lead.ahead_singly,
        "behind": lead.behind,
        "behind_singly": lead.behind_singly,
        "ahead_median": lead.middle,
        "ahead_lowest": min(ahead),
        "ahead_highest": max(ahead),
        "published_ahead": published["fixation"] - published["random"],
    }


def weigh_choices(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Compute how much of the spread of accuracy by fixation each choice and each pair of choices explains.

    `rows` are of one classifier. Shares are sums of squares of a balanced design, and the largest share comes first.
    Recognition choices are weighed over the part ``recognition``. All others are weighed over the part ``upstream``
    together with the base of the design. A gain is the mean of an option minus the mean of the base option.
    """
    complete = [row for row in rows if row["part"] == "recognition"]
    fraction = [row for row in rows if row["part"] == "upstream"]
    if fraction:
        # The runs of the fraction with the base of every other choice belong to the full factorial.
        fraction += [row for row in complete if is_base_but_for(row, CROSSED_SINGLY)]
    upstream = [
        choice.name
        for choice in CHOICES
        if choice.name not in FACTORIAL and len({row[choice.name] for row in fraction}) > 1
    ]
    # Interactions are not confounded in the full factorial, nor between the crossed choices and any other choice.
    shares = [
        *_shares(complete, FACTORIAL, FACTORIAL, "recognition"),
        *_shares(fraction, (*upstream, *CROSSED_SINGLY), CROSSED_SINGLY, "upstream"),
    ]
    return sorted(shares, key=lambda row: (row["part"], -row["share"]))


def _shares(
    rows: Sequence[Row], names: Sequence[str], crossed: Sequence[str], part: str
) -> list[dict[str, Any]]:
    """Compute the share of each choice, and of each pair that contains one of the `crossed` choices."""
    accuracy = np.array([row["fixation"] for row in rows])
    total = float(np.square(accuracy - accuracy.mean()).sum()) if len(rows) > 1 else 0.0
    if total == 0:
        return []
    shares = []
    squares = {}
    for name in names:
        fitted, of_option = _group_means(accuracy, [row[name] for row in rows])
        squares[name] = float(np.square(fitted - accuracy.mean()).sum())
        base = of_option[BY_NAME[name].base]
        gains = {option: mean - base for option, mean in of_option.items()}
        shares.append(
            {"part": part, "choices": [name], "share": squares[name] / total, "gains": gains}
        )
    for first, second in itertools.combinations(names, 2):
        if {first, second} & {*crossed}:
            fitted, _ = _group_means(accuracy, [(row[first], row[second]) for row in rows])
            both = float(np.square(fitted - accuracy.mean()).sum())
            share = max(both - squares[first] - squares[second], 0.0) / total
            shares.append({"part": part, "choices": [first, second], "share": share, "gains": None})
    return shares


def _group_means(
    values: NDArray[np.float64], groups: Sequence[Any]
) -> tuple[NDArray[np.float64], dict[Any, float]]:
    """Return the mean of each value's group, (n,), and the mean of each group by name."""
    names = list(dict.fromkeys(groups))
    index_of = {name: index for index, name in enumerate(names)}
    group = np.array([index_of[name] for name in groups])
    means = np.bincount(group, weights=values) / np.bincount(group)
    return means[group], dict(zip(names, means.tolist(), strict=True))
