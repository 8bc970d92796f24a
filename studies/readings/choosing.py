"""Which reading is the package's default: the rules, applied to objects outside the paper's set.

They were written down before they were applied, and are applied once. They never look at how far one
strategy is ahead of another. The first looks at readings of the part ``recognition``:

1. The score of a reading is the mean over objects of the share of an object's sequences that are
   correctly classified, averaged over the paper's five classifiers and the strategies that touch
   places in reach (`SCORED`), so that no classifier and no strategy is favoured. A reading in which one
   of these can't be run has none.
2. The best reading has the highest score. A reading stays a candidate unless its score is
   significantly lower than the best one's (paired over objects, sign changes, at 0.05).
3. Of the candidates, the default is the one that differs from the default of before in the fewest
   choices; of these, the one with the highest score.

What they said is kept in `chosen.json`.

The second rule looks at the choices of touches, which are varied alone (parts ``further`` and
``single``), one choice after the other:

1. The score of an option is that of its readings, averaged over the four map outputs, on the objects
   that all of these readings could be tested on.
2. An option whose share of touches acquired is below `ENOUGH` is out: of the touches asked for, over
   all objects, viewpoints and scored strategies, those made at a place in reach.
3. The default of before stays, unless it is out or an option has a significantly higher score (paired over
   objects, sign changes, at 0.05 after Holm's correction for all options that are compared). Of such
   options the one with the highest score is the default; if the default of before is out, the option with
   the highest score that is not. If all are out, it stays.

Which random touches fixation is compared with, the order of touches and what is tested are no matter of
scores: `NOT_SCORED` keep their options.

`python -m readings.choosing chosen.json results/study_blocks/readings/*.parquet`
applies the first rule, and the second where its readings are among the blocks; the shares of touches
acquired are then read from `results/study_features/readings/`.
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

from readings.choices import BY_NAME, OPPONENTS, Choice
from readings.design import (
    BASE,
    CROSSED_SINGLY,
    STRATEGIES,
    VARIED_ALONE,
    Options,
    all_readings,
    is_base_but_for,
)
from readings.leads import SIGNIFICANT
from readings.stored import OUTSIDE
from readings.study import STUDY
from visuohaptic.errors import RecognitionError
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.intervals import PairedComparison, compare_paired, holm
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.recognition.published import TABLE_1
from visuohaptic.seeds import spawn_generator
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


def choose_default(
    cells: Mapping[CellKey, Cell],
    intervals: IntervalParameters,
    seed: int,
    former: Options = FORMER_DEFAULT,
) -> Row:
    """Apply the first rule to the cells of study `readings`, as `read_cells` gives them.

    Gives how many objects and readings the rule saw, how many were candidates, and the new default,
    the best reading and the former default: each with its ``score``, how far it is ``behind`` the
    best, the p value of that, and the options that ``changed`` from the former default. Raises
    `RecognitionError` if a reading of the part ``recognition`` is missing: the rule compares all of
    them.
    """
    readings = {one.name: one for one in all_readings() if one.part == "recognition"}
    scores: dict[str, NDArray[np.float64]] = {}
    objects: set[tuple[tuple[str, str], ...]] = set()
    for name in readings:
        found = _cells_of_reading(cells, name)
        if all(cell.error is None for cell in found):
            objects |= {cell.objects for cell in found}
            scores[name] = np.mean([cell.accuracy for cell in found], axis=0)
    if len(objects) != 1:
        raise RecognitionError(
            f"The readings were tested on {len(objects)} different sets of objects; the rule "
            "compares readings on the same ones."
        )
    best = max(scores, key=lambda name: float(scores[name].mean()))
    listed: dict[str, Row] = {}
    for name, score in scores.items():
        behind = _compared(scores[best], score, intervals, seed)
        options = readings[name].options.items()
        listed[name] = {
            "reading": name,
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
        "readings": len(listed),
        "candidates": len(candidates),
        "chosen": min(candidates, key=lambda one: (len(one["changed"]), -one["score"])),
        "best": listed[best],
        "former": next(one for one in listed.values() if not one["changed"]),
    }


def _compared(
    first: NDArray[np.float64],
    second: NDArray[np.float64],
    intervals: IntervalParameters,
    seed: int,
) -> PairedComparison:
    generator = spawn_generator(seed, "studies", "comparison")
    return compare_paired(first, second, np.ones(len(first)), intervals, generator)


def choose_options(
    cells: Mapping[CellKey, Cell],
    acquired: Mapping[tuple[str, str], float],
    intervals: IntervalParameters,
    seed: int,
    former: Options = FORMER_DEFAULT,
) -> list[Row]:
    """Apply the second rule: one answer for each choice of touches that is scored, in order.

    Each has the former option and the one that is ``chosen``, the scores of all options, the shares
    of touches ``acquired``, which are given by choice and option, and the p values against the
    former option, after Holm's correction over all choices. Raises `RecognitionError` if a reading
    is missing or can't be run, or no object was tested in all of them.
    """
    names = scored_readings()
    shared = _shared_objects(cells, {*chain(*names.values())})
    scores = {
        option: np.mean([_score(cells, name, shared) for name in of_option], axis=0)
        for option, of_option in names.items()
    }
    others = [(name, option) for name, option in scores if option != former[name]]
    p_values = [
        _compared(scores[name, option], scores[name, former[name]], intervals, seed).p_value
        for name, option in others
    ]
    adjusted = dict(zip(others, holm(p_values), strict=True))
    return [
        _choose_option(choice, scores, acquired, adjusted, former) for choice in scored_choices()
    ]


def scored_choices() -> list[Choice]:
    """Give the choices of which the second rule chooses an option."""
    varied = [BY_NAME[name] for name in VARIED_ALONE]
    return [choice for choice in varied if choice.name not in NOT_SCORED]


def scored_readings() -> dict[tuple[str, str], list[str]]:
    """Name, by scored choice and option, the readings with the base of every other choice, and any map output."""
    readings = all_readings()
    return {
        (choice.name, option): [
            one.name
            for one in readings
            if one.options[choice.name] == option
            and is_base_but_for(one.options, (choice.name, *CROSSED_SINGLY))
        ]
        for choice in scored_choices()
        for option in choice.options
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


def _choose_option(
    choice: Choice,
    scores: Mapping[tuple[str, str], NDArray[np.float64]],
    acquired: Mapping[tuple[str, str], float],
    p_values: Mapping[tuple[str, str], float],
    former: Options,
) -> Row:
    name, own = choice.name, former[choice.name]
    means = {option: float(scores[name, option].mean()) for option in choice.options}
    shares = {option: acquired[name, option] for option in choice.options}
    adjusted = {option: p_values[name, option] for option in choice.options if option != own}
    admitted = [option for option in choice.options if shares[option] >= ENOUGH]
    better = [
        option
        for option in admitted
        if option == own or (means[option] > means[own] and adjusted[option] < SIGNIFICANT)
    ]
    candidates = better if own in admitted else admitted
    chosen = max(candidates, key=lambda option: means[option]) if candidates else own
    return {
        "choice": name,
        "former": own,
        "chosen": chosen,
        "scores": means,
        "acquired": shares,
        "p_values": adjusted,
    }


def _shared_objects(
    cells: Mapping[CellKey, Cell], names: Iterable[str]
) -> frozenset[tuple[str, str]]:
    """Give the objects that all readings were tested on."""
    found: list[Cell] = []
    for name in sorted(names):
        found += _cells_of_reading(cells, name)
        if failed := [cell.error for cell in found if cell.error is not None]:
            raise RecognitionError(f"Reading {name} can't be run, so it has no score: {failed[0]}")
    shared = frozenset.intersection(*(frozenset(cell.objects) for cell in found))
    if not shared:
        raise RecognitionError(
            "No object was tested in all readings; the rule compares on one at least."
        )
    return shared


def _score(
    cells: Mapping[CellKey, Cell], name: str, objects: frozenset[tuple[str, str]]
) -> NDArray[np.float64]:
    """Average a reading's accuracy on each of some objects over strategies and classifiers."""
    found = _cells_of_reading(cells, name)
    return np.mean(
        [cell.accuracy[[one in objects for one in cell.objects]] for cell in found], axis=0
    )


def _cells_of_reading(cells: Mapping[CellKey, Cell], name: str) -> list[Cell]:
    keys = [(name, "paper", strategy, classifier) for strategy in SCORED for classifier in TABLE_1]
    if missing := [key for key in keys if key not in cells]:
        raise RecognitionError(f"Reading {name} has no result for {' '.join(missing[0][2:])}.")
    return [cells[key] for key in keys]


def write_choice(
    parts: Iterable[str | Path],
    output: str | Path,
    features: str | Path = "results/study_features/readings",
) -> None:
    """Write what the rules say of a study's blocks as JSON.

    The second rule is left out where its readings are not among the blocks. `features` is the folder
    of the features that the study recomputed.
    """
    run = ExperimentParameters()
    cells, intervals = read_cells(parts), run.recognition.intervals
    chosen = choose_default(cells, intervals, run.seed)
    if {*chain(*scored_readings().values())} <= {key[0] for key in cells}:
        acquired = _acquired(Path(features), run)
        chosen["options"] = choose_options(cells, acquired, intervals, run.seed)
    write_json(chosen, output)


def _acquired(folder: Path, run: ExperimentParameters) -> dict[tuple[str, str], float]:
    """Read the share of touches acquired by each option of each scored choice."""
    outside = run.model_copy(update={"meshes": run.meshes.model_copy(update={"set": OUTSIDE})})
    planned = {one.condition.name: one for one in plan_study(STUDY, outside).conditions}
    found = {}
    for option, names in scored_readings().items():
        one = planned[names[0]]
        table = read_table(FEATURES, folder / f"{one.key}.parquet")
        touches = one.parameters.recognition.touches or 0
        found[option] = acquired_share(table, one.parameters.viewpoints.total, touches)
    return found


if __name__ == "__main__":
    write_choice(sys.argv[2:], sys.argv[1])
