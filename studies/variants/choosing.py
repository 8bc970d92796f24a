"""Choose the default variant of the package by two rules, on objects outside the paper's set.

The rules were written down before they were applied. The default is the result of the first time, `chosen.json`;
`chosen_again.json` is the result on tables that were measured again later. The rules never use the difference between
strategies.

The first rule chooses among the variants of part ``recognition``:

1. The score of a variant is its accuracy, averaged over the paper's five classifiers and all strategies that touch places
   in reach (fixation, and random touches in reach, seen, and by a walk).
2. The best variant has the highest score. A variant stays a candidate unless its score is significantly lower (paired over
   objects, sign changes, 0.05).
3. Of the candidates, the default is the one that differs from the former default in the fewest choices; of these, the one
   with the highest score.

The second rule chooses among the options of each choice of touches, except their order; these are varied one at a time
(parts ``further`` and ``single``). For each choice by itself:

1. The score of an option is that of its variants, averaged over the four map outputs, on the objects that all of these
   variants could be tested on.
2. An option is out if less than 95 % of the touches that it asks for are acquired, by the same strategies.
3. The option of before stays, unless it is out, or another is significantly better (paired over objects, sign changes,
   0.05 after Holm's correction for all compared options). Of such options the one with the highest score is the default.

`python -m variants.choosing chosen.json results/study_blocks/variants/*.parquet` applies the first rule. It also applies
the second rule if the blocks hold its variants. The shares of acquired touches are then read from
`results/study_features/variants/`.
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
from variants.study import STUDY
from visuohaptic.base.errors import RecognitionError
from visuohaptic.evaluation.intervals import SIGNIFICANCE, holm
from visuohaptic.evaluation.published import TABLE_1
from visuohaptic.evaluation.sign_changes import sign_change_test
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
"""Default before the rules were applied; the rules had chosen it on an earlier design."""

SCORED = tuple(name for name in STRATEGIES if name != OPPONENTS["anywhere"])
"""Strategies that touch only reachable locations."""

ENOUGH = 0.95
"""Least share of the requested touches that an option must acquire."""

NOT_SCORED = ("order", "random_probing", "protocol")
"""Choices whose options ask another question than how well touches classify objects."""

Option = tuple[str, str]
"""Name of a choice, and name of one of its options."""


def choose_default(
    cells: Mapping[CellKey, Cell],
    intervals: IntervalParameters,
    former: Options = FORMER_DEFAULT,
) -> Row:
    """Apply the first rule.

    Parameters
    ----------
    cells : mapping
        Cells of study `variants`, as from `read_cells`.
    intervals : IntervalParameters
        Settings of the paired tests.
    former : mapping of str to str
        Option of each choice in the former default.

    Returns
    -------
    dict
        Rows ``chosen``, ``best`` and ``former``, and counts of objects, variants and candidates. A row has the ``score``
        of a variant, how far it is ``behind`` the best with the ``p_value``, and the options that ``changed`` from the
        former default.

    Raises
    ------
    RecognitionError
        If a variant of the part ``recognition`` is missing, or the variants were tested on different objects.
    """
    variants = {
        variant.name: variant for variant in all_variants() if variant.part == "recognition"
    }
    cells_of = {name: _cells_of_variant(cells, name) for name in variants}
    succeeded = {
        name: of_variant
        for name, of_variant in cells_of.items()
        if all(cell.error is None for cell in of_variant)
    }
    objects = {cell.objects for of_variant in succeeded.values() for cell in of_variant}
    if len(objects) != 1:
        raise RecognitionError(
            f"The variants were tested on {len(objects)} different sets of objects; the rule "
            "needs the same objects for all variants."
        )
    scores = {
        name: np.mean([cell.accuracy for cell in of_variant], axis=0)
        for name, of_variant in succeeded.items()
    }
    best = max(scores, key=lambda name: float(scores[name].mean()))
    listed: dict[str, Row] = {}
    for name, score in scores.items():
        options = variants[name].options.items()
        listed[name] = {
            "variant": name,
            "score": float(score.mean()),
            "behind": float(np.mean(scores[best] - score)),
            "p_value": _p_value(scores[best], score, intervals),
            "changed": {choice: option for choice, option in options if option != former[choice]},
        }
    candidates = [
        row for name, row in listed.items() if name == best or row["p_value"] >= SIGNIFICANCE
    ]
    return {
        "objects": len(scores[best]),
        "variants": len(listed),
        "candidates": len(candidates),
        "chosen": min(candidates, key=lambda row: (len(row["changed"]), -row["score"])),
        "best": listed[best],
        "former": next(row for row in listed.values() if not row["changed"]),
    }


def choose_options(
    cells: Mapping[CellKey, Cell],
    acquired: Mapping[Option, float],
    intervals: IntervalParameters,
    former: Options = FORMER_DEFAULT,
) -> list[Row]:
    """Apply the second rule: return one row per scored choice of touches, in order.

    Parameters
    ----------
    cells : mapping
        Cells of study `variants`, as from `read_cells`.
    acquired : mapping of (choice, option) to float
        Share of the requested touches that each option acquired, as from `acquired_share`.
    intervals : IntervalParameters
        Settings of the paired tests.
    former : mapping of str to str
        Option of each choice in the former default.

    Returns
    -------
    list of dict
        The ``former`` and the ``chosen`` option of each choice, and scores, acquired shares and p values by option. P
        values are against the former option, after Holm's correction over all choices.

    Raises
    ------
    RecognitionError
        If a variant is missing or can't be run, or no object was tested in all variants.
    """
    scores = _option_scores(cells)
    alternatives = [(name, option) for name, option in scores if option != former[name]]
    p_values = [
        _p_value(scores[name, option], scores[name, former[name]], intervals)
        for name, option in alternatives
    ]
    adjusted = dict(zip(alternatives, holm(p_values), strict=True))
    rows: list[Row] = []
    for name in dict.fromkeys(name for name, _ in scores):
        former_option, options = former[name], BY_NAME[name].options
        means = {option: float(scores[name, option].mean()) for option in options}
        admitted = [option for option in options if acquired[name, option] >= ENOUGH]
        better = [
            option
            for option in admitted
            if option == former_option
            or (means[option] > means[former_option] and adjusted[name, option] < SIGNIFICANCE)
        ]
        candidates = better if former_option in admitted else admitted
        rows.append(
            {
                "choice": name,
                "former": former_option,
                "chosen": max(candidates or [former_option], key=lambda option: means[option]),
                "scores": means,
                "acquired": {option: acquired[name, option] for option in options},
                "p_values": {
                    option: adjusted[name, option] for option in options if option != former_option
                },
            }
        )
    return rows


def _option_scores(cells: Mapping[CellKey, Cell]) -> dict[Option, NDArray[np.float64]]:
    """Return the mean accuracy of each option's variants per object, over objects that were tested in all variants."""
    names = scored_variants()
    cells_of = {name: _cells_of_variant(cells, name) for name in sorted({*chain(*names.values())})}
    every = [(name, cell) for name, of_variant in cells_of.items() for cell in of_variant]
    for name, cell in every:
        if cell.error is not None:
            raise RecognitionError(f"Variant {name} can't be run, so it has no score: {cell.error}")
    shared = frozenset.intersection(*(frozenset(cell.objects) for _, cell in every))
    if not shared:
        raise RecognitionError("No object was tested in all variants; at least one is needed.")
    scores = {
        name: np.mean(
            [cell.accuracy[[key in shared for key in cell.objects]] for cell in of_variant], axis=0
        )
        for name, of_variant in cells_of.items()
    }
    return {
        option: np.mean([scores[name] for name in of_option], axis=0)
        for option, of_option in names.items()
    }


def scored_variants() -> dict[Option, list[str]]:
    """Return the names of variants by scored choice and option.

    These variants have the base option of every other choice; only the map output may differ.
    """
    variants = all_variants()
    return {
        (choice, option): [
            variant.name
            for variant in variants
            if variant.options[choice] == option
            and is_base_but_for(variant.options, (choice, *CROSSED_SINGLY))
        ]
        for choice in VARIED_ALONE
        if choice not in NOT_SCORED
        for option in BY_NAME[choice].options
    }


def acquired_share(features: pa.Table, viewpoints: int, touches: int) -> float:
    """Return the share of the requested touches that reached the surface, over the scored strategies.

    `features` are rows of `tables.FEATURES`. Each strategy of `SCORED` was asked for `touches` touches from each of
    `viewpoints` viewpoints of each object.
    """
    scored = features.filter(pc.is_in(features.column("strategy"), pa.array(SCORED)))
    first = scored.filter(pc.less(scored.column("touch"), touches))
    out_of_reach = pc.is_in(first.column("contact_state"), pa.array(OUT_OF_REACH))
    requested = len(set(owners_of(features))) * viewpoints * touches * len(SCORED)
    return (first.num_rows - (pc.sum(out_of_reach).as_py() or 0)) / requested


def _p_value(
    first: NDArray[np.float64],
    second: NDArray[np.float64],
    intervals: IntervalParameters,
) -> float:
    """Return the p value of sign changes only, as in the rules that were written down."""
    shares = np.full(len(first), 1 / len(first))
    return sign_change_test(
        first - second, shares, intervals.permutations, 1 - intervals.confidence
    ).p_value


def _cells_of_variant(cells: Mapping[CellKey, Cell], name: str) -> list[Cell]:
    keys = [
        CellKey(name, "paper", strategy, classifier)
        for strategy in SCORED
        for classifier in TABLE_1
    ]
    if missing := [key for key in keys if key not in cells]:
        raise RecognitionError(f"Variant {name} has no result for {' '.join(missing[0][2:])}.")
    return [cells[key] for key in keys]


def write_choice(
    parts: Iterable[str | Path],
    output: str | Path,
    features: str | Path = "results/study_features/variants",
) -> None:
    """Apply the rules to the blocks `parts` of the study, and write the result as JSON.

    `features` is the folder of the recomputed features, for the second rule.
    """
    run = ExperimentParameters()
    cells, intervals = read_cells(parts), run.recognition.intervals
    chosen = choose_default(cells, intervals)
    if {*chain(*scored_variants().values())} <= {key[0] for key in cells}:
        acquired = _acquired(Path(features), run)
        chosen["options"] = choose_options(cells, acquired, intervals)
    write_json(chosen, output)


def _acquired(folder: Path, run: ExperimentParameters) -> dict[Option, float]:
    """Read the features of each option of each scored choice, and return the share of acquired touches."""
    outside = run.model_copy(update={"meshes": run.meshes.model_copy(update={"set": OUTSIDE})})
    planned = {plan.condition.name: plan for plan in plan_study(STUDY, outside).conditions}
    shares = {}
    for option, names in scored_variants().items():
        plan = planned[names[0]]
        table = read_table(FEATURES, folder / f"{plan.key}.parquet")
        touches = plan.parameters.recognition.touches or 0
        shares[option] = acquired_share(table, plan.parameters.viewpoints.total, touches)
    return shares


if __name__ == "__main__":
    write_choice(sys.argv[2:], sys.argv[1])
