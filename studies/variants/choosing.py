"""Which variant is the package's default: the rules, applied to objects outside the paper's set.

They stand in full in docs/notebook/2026-11-variants.md, were written down before they were applied, and
are applied once; what they said is kept in `chosen.json`. The first chooses among the variants of part
``recognition``, the second among the options of each choice of touches, which are varied alone (parts
``further`` and ``single``). They never look at how far one strategy is ahead of another.

`python -m variants.choosing chosen.json results/study_blocks/variants/*.parquet`
applies the first rule, and the second where its variants are among the blocks; the shares of touches
acquired are then read from `results/study_features/variants/`.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Mapping
from itertools import chain
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray

from variants.choices import BY_NAME, OPPONENTS
from variants.design import (
    BASE,
    CROSSED_SINGLY,
    STRATEGIES,
    VARIED_ALONE,
    Options,
    all_variants,
    is_base_but_for,
)
from variants.kept import OUTSIDE
from variants.leads import SIGNIFICANT
from variants.study import STUDY
from visuohaptic.base.errors import RecognitionError
from visuohaptic.evaluation.intervals import PairedComparison, compare_paired, holm
from visuohaptic.evaluation.published import TABLE_1
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.studies.conditions import plan_study
from visuohaptic.studies.figures import Cell, CellKey, Row, read_cells, write_json
from visuohaptic.tables.phases import FEATURES, OUT_OF_REACH, owners_of
from visuohaptic.tables.schema import read_table

FORMER_DEFAULT: Options = {
    **BASE,
    "map_output": "feature_groups",
    "sequence_extension": "zero",
}
"""The default before the rules were applied, which an application to an earlier design had chosen."""

SCORED = tuple(name for name in STRATEGIES if name != OPPONENTS["anywhere"])
"""The strategies that touch places in reach."""

ENOUGH = 0.95
"""Share of the touches asked for that must be acquired."""

NOT_SCORED = ("order", "random_probing", "protocol")
"""Choices that ask another question than how well touches classify objects."""

Option = tuple[str, str]
"""A choice and one of its options."""


def choose_default(
    cells: Mapping[CellKey, Cell],
    intervals: IntervalParameters,
    former: Options = FORMER_DEFAULT,
) -> Row:
    """Apply the first rule to the cells of study `variants`, as `read_cells` gives them.

    Of the new default, the best variant and the former default it gives the ``score``, how far it is
    ``behind`` the best, the p value of that, and the options that ``changed`` from the former default.
    Raises `RecognitionError` if a variant of the part ``recognition`` is missing.
    """
    variants = {one.name: one for one in all_variants() if one.part == "recognition"}
    found = {name: _cells_of_variant(cells, name) for name in variants}
    run = {name: own for name, own in found.items() if all(cell.error is None for cell in own)}
    objects = {cell.objects for own in run.values() for cell in own}
    if len(objects) != 1:
        raise RecognitionError(
            f"The variants were tested on {len(objects)} different sets of objects; the rule "
            "compares variants on the same ones."
        )
    scores = {name: np.mean([cell.accuracy for cell in own], axis=0) for name, own in run.items()}
    best = max(scores, key=lambda name: float(scores[name].mean()))
    listed: dict[str, Row] = {}
    for name, score in scores.items():
        behind = _compared(scores[best], score, intervals)
        options = variants[name].options.items()
        listed[name] = {
            "variant": name,
            "score": float(score.mean()),
            "behind": behind.difference.mean,
            "p_value": behind.p_value,
            "changed": {choice: option for choice, option in options if option != former[choice]},
        }
    candidates = [
        one for name, one in listed.items() if name == best or one["p_value"] >= SIGNIFICANT
    ]
    return {
        "objects": len(scores[best]),
        "variants": len(listed),
        "candidates": len(candidates),
        "chosen": min(candidates, key=lambda one: (len(one["changed"]), -one["score"])),
        "best": listed[best],
        "former": next(one for one in listed.values() if not one["changed"]),
    }


def choose_options(
    cells: Mapping[CellKey, Cell],
    acquired: Mapping[Option, float],
    intervals: IntervalParameters,
    former: Options = FORMER_DEFAULT,
) -> list[Row]:
    """Apply the second rule: one answer for each choice of touches that is scored, in order.

    P values are against the former option, after Holm's correction over all choices. Raises
    `RecognitionError` if a variant is missing or can't be run, or no object was tested in all of them.
    """
    scores = _option_scores(cells)
    others = [(name, option) for name, option in scores if option != former[name]]
    p_values = [
        _compared(scores[name, option], scores[name, former[name]], intervals).p_value
        for name, option in others
    ]
    adjusted = dict(zip(others, holm(p_values), strict=True))
    found: list[Row] = []
    for name in dict.fromkeys(name for name, _ in scores):
        own, options = former[name], BY_NAME[name].options
        means = {option: float(scores[name, option].mean()) for option in options}
        admitted = [option for option in options if acquired[name, option] >= ENOUGH]
        better = [
            option
            for option in admitted
            if option == own
            or (means[option] > means[own] and adjusted[name, option] < SIGNIFICANT)
        ]
        candidates = better if own in admitted else admitted
        found.append(
            {
                "choice": name,
                "former": own,
                "chosen": max(candidates or [own], key=lambda option: means[option]),
                "scores": means,
                "acquired": {option: acquired[name, option] for option in options},
                "p_values": {option: adjusted[name, option] for option in options if option != own},
            }
        )
    return found


def _option_scores(cells: Mapping[CellKey, Cell]) -> dict[Option, NDArray[np.float64]]:
    """Average the accuracy of each option's variants, on each of the objects that all were tested on."""
    names = scored_variants()
    found = {name: _cells_of_variant(cells, name) for name in sorted({*chain(*names.values())})}
    every = [(name, cell) for name, own in found.items() for cell in own]
    for name, cell in every:
        if cell.error is not None:
            raise RecognitionError(f"Variant {name} can't be run, so it has no score: {cell.error}")
    shared = frozenset.intersection(*(frozenset(cell.objects) for _, cell in every))
    if not shared:
        raise RecognitionError(
            "No object was tested in all variants; the rule compares on one at least."
        )
    scores = {
        name: np.mean(
            [cell.accuracy[[one in shared for one in cell.objects]] for cell in own], axis=0
        )
        for name, own in found.items()
    }
    return {
        option: np.mean([scores[name] for name in of_option], axis=0)
        for option, of_option in names.items()
    }


def scored_variants() -> dict[Option, list[str]]:
    """Name, by scored choice and option, the variants with the base of every other choice, and any map output."""
    variants = all_variants()
    return {
        (choice, option): [
            one.name
            for one in variants
            if one.options[choice] == option
            and is_base_but_for(one.options, (choice, *CROSSED_SINGLY))
        ]
        for choice in VARIED_ALONE
        if choice not in NOT_SCORED
        for option in BY_NAME[choice].options
    }


def acquired_share(features: pa.Table, viewpoints: int, touches: int) -> float:
    """Give the share of touches at places in reach, of those asked for by the scored strategies.

    `features` are rows of `tables.FEATURES`; so many `viewpoints` of each object were asked for,
    and so many `touches` from each by each strategy.
    """
    scored = features.filter(pc.is_in(features.column("strategy"), pa.array(SCORED)))
    first = scored.filter(pc.less(scored.column("touch"), touches))
    out = pc.is_in(first.column("contact_state"), pa.array(OUT_OF_REACH))
    asked = len(set(owners_of(features))) * viewpoints * touches * len(SCORED)
    return (first.num_rows - (pc.sum(out).as_py() or 0)) / asked


def _compared(
    first: NDArray[np.float64],
    second: NDArray[np.float64],
    intervals: IntervalParameters,
) -> PairedComparison:
    return compare_paired(first, second, np.ones(len(first)), intervals)


def _cells_of_variant(cells: Mapping[CellKey, Cell], name: str) -> list[Cell]:
    keys = [(name, "paper", strategy, classifier) for strategy in SCORED for classifier in TABLE_1]
    if missing := [key for key in keys if key not in cells]:
        raise RecognitionError(f"Variant {name} has no result for {' '.join(missing[0][2:])}.")
    return [cells[key] for key in keys]


def write_choice(
    parts: Iterable[str | Path],
    output: str | Path,
    features: str | Path = "results/study_features/variants",
) -> None:
    """Write what the rules say of a study's blocks as JSON; `features` is the folder of what it recomputed."""
    run = ExperimentParameters()
    cells, intervals = read_cells(parts), run.recognition.intervals
    chosen = choose_default(cells, intervals)
    if {*chain(*scored_variants().values())} <= {key[0] for key in cells}:
        acquired = _acquired(Path(features), run)
        chosen["options"] = choose_options(cells, acquired, intervals)
    write_json(chosen, output)


def _acquired(folder: Path, run: ExperimentParameters) -> dict[Option, float]:
    """Read the share of touches acquired by each option of each scored choice."""
    outside = run.model_copy(update={"meshes": run.meshes.model_copy(update={"set": OUTSIDE})})
    planned = {one.condition.name: one for one in plan_study(STUDY, outside).conditions}
    found = {}
    for option, names in scored_variants().items():
        one = planned[names[0]]
        table = read_table(FEATURES, folder / f"{one.key}.parquet")
        touches = one.parameters.recognition.touches or 0
        found[option] = acquired_share(table, one.parameters.viewpoints.total, touches)
    return found


if __name__ == "__main__":
    write_choice(sys.argv[2:], sys.argv[1])
