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
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray

from readings.choices import BY_NAME, CHOICES, OPPONENTS, Choice
from readings.design import (
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
from visuohaptic.recognition.intervals import compare_paired, holm
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.recognition.published import TABLE_1
from visuohaptic.seeds import spawn_generator
from visuohaptic.studies.conditions import plan_study
from visuohaptic.studies.figures import Cell, CellKey, read_cells, write_json
from visuohaptic.tables.phases import FEATURES, OUT_OF_REACH, owners_of
from visuohaptic.tables.schema import read_table

FORMER_DEFAULT: Options = {
    **{choice.name: choice.base for choice in CHOICES},
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


@dataclass(frozen=True)
class Candidate:
    """A reading that the rule looks at: `score` is its accuracy over all classifiers and strategies.

    `behind` says how far that is behind the best score, with the two-sided `p_value`; `changed` has
    its options that differ from the former default's.
    """

    reading: str
    score: float
    behind: float
    p_value: float
    changed: dict[str, str]


@dataclass(frozen=True)
class Chosen:
    """What the rule says: the new default, the reading with the highest score, and the default of before.

    It saw so many objects and readings, of which `candidates` were candidates.
    """

    objects: int
    readings: int
    candidates: int
    chosen: Candidate
    best: Candidate
    former: Candidate


def choose_default(
    cells: Mapping[CellKey, Cell],
    intervals: IntervalParameters,
    seed: int,
    former: Options = FORMER_DEFAULT,
) -> Chosen:
    """Apply the first rule to the cells of study `readings`, as `read_cells` gives them.

    Raises `RecognitionError` if a reading of the part ``recognition`` is missing: the rule compares
    all of them.
    """
    readings = [one for one in all_readings() if one.part == "recognition"]
    scores: dict[str, NDArray[np.float64]] = {}
    objects: set[tuple[tuple[str, str], ...]] = set()
    for reading in readings:
        found = _cells_of_reading(cells, reading.name)
        if all(cell.error is None for cell in found):
            objects |= {cell.objects for cell in found}
            scores[reading.name] = np.mean([cell.accuracy for cell in found], axis=0)
    if len(objects) != 1:
        raise RecognitionError(
            f"The readings were tested on {len(objects)} different sets of objects; the rule "
            "compares readings on the same ones."
        )
    weights = np.ones(len(next(iter(objects))))
    best = max(scores, key=lambda name: float(scores[name].mean()))
    listed: dict[str, Candidate] = {}
    for reading in readings:
        if reading.name not in scores:
            continue
        generator = spawn_generator(seed, "studies", "comparison")
        compared = compare_paired(scores[best], scores[reading.name], weights, intervals, generator)
        listed[reading.name] = Candidate(
            reading=reading.name,
            score=float(scores[reading.name].mean()),
            behind=compared.difference.mean,
            p_value=compared.p_value,
            changed={
                name: option for name, option in reading.options.items() if option != former[name]
            },
        )
    candidates = [
        one for one in listed.values() if one.reading == best or one.p_value >= SIGNIFICANT
    ]
    return Chosen(
        objects=len(weights),
        readings=len(listed),
        candidates=len(candidates),
        chosen=min(candidates, key=lambda one: (len(one.changed), -one.score)),
        best=listed[best],
        former=next(one for one in listed.values() if not one.changed),
    )


@dataclass(frozen=True)
class ChosenOption:
    """What the second rule says of a choice: its option of before and the default.

    `scores` has the accuracy of each option, `acquired` its share of touches acquired, `p_values`
    that of each other option against the former one, after Holm's correction over all choices.
    """

    choice: str
    former: str
    chosen: str
    scores: dict[str, float]
    acquired: dict[str, float]
    p_values: dict[str, float]


def choose_options(
    cells: Mapping[CellKey, Cell],
    acquired: Mapping[tuple[str, str], float],
    intervals: IntervalParameters,
    seed: int,
    former: Options = FORMER_DEFAULT,
) -> list[ChosenOption]:
    """Apply the second rule: one answer for each choice of touches that is scored, in order.

    `acquired` has the share of touches acquired by choice and option. Raises `RecognitionError` if
    a reading is missing or can't be run, or no object was tested in all of them.
    """
    names = {
        (choice.name, option): readings_of_option(choice.name, option)
        for choice in scored_choices()
        for option in choice.options
    }
    shared = _shared_objects(cells, {name for of_option in names.values() for name in of_option})
    scores = {
        option: np.mean([_score(cells, name, shared) for name in of_option], axis=0)
        for option, of_option in names.items()
    }
    others = [(name, option) for name, option in scores if option != former[name]]
    weights = np.ones(len(next(iter(scores.values()))))
    p_values = []
    for name, option in others:
        own = scores[name, former[name]]
        generator = spawn_generator(seed, "studies", "comparison")
        compared = compare_paired(scores[name, option], own, weights, intervals, generator)
        p_values.append(compared.p_value)
    adjusted = dict(zip(others, holm(p_values), strict=True))
    return [
        _choose_option(choice, scores, acquired, adjusted, former) for choice in scored_choices()
    ]


def scored_choices() -> list[Choice]:
    """Give the choices of which the second rule chooses an option."""
    varied = [BY_NAME[name] for name in VARIED_ALONE]
    return [choice for choice in varied if choice.name not in NOT_SCORED]


def readings_of_option(choice: str, option: str) -> list[str]:
    """Name the readings that have an option, the base of every other choice, and any map output."""
    return [
        one.name
        for one in all_readings()
        if one.options[choice] == option and is_base_but_for(one.options, (choice, *CROSSED_SINGLY))
    ]


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
) -> ChosenOption:
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
    return ChosenOption(name, own, chosen, means, shares, adjusted)


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
    chosen = asdict(choose_default(cells, intervals, run.seed))
    measured = {key[0] for key in cells}
    needed = {
        name
        for choice in scored_choices()
        for option in choice.options
        for name in readings_of_option(choice.name, option)
    }
    if needed <= measured:
        acquired = _acquired(Path(features), run)
        options = choose_options(cells, acquired, intervals, run.seed)
        chosen["options"] = [asdict(one) for one in options]
    write_json(chosen, output)


def _acquired(folder: Path, run: ExperimentParameters) -> dict[tuple[str, str], float]:
    """Read the share of touches acquired by each option of each scored choice."""
    outside = run.model_copy(update={"meshes": run.meshes.model_copy(update={"set": OUTSIDE})})
    plan = plan_study(STUDY, outside)
    planned = {one.condition.name: one for one in plan.conditions}
    found = {}
    for choice in scored_choices():
        for option in choice.options:
            one = planned[readings_of_option(choice.name, option)[0]]
            table = read_table(FEATURES, folder / f"{one.key}.parquet")
            viewpoints, touches = (
                one.parameters.viewpoints.total,
                one.parameters.recognition.touches,
            )
            found[choice.name, option] = acquired_share(table, viewpoints, touches or 0)
    return found


if __name__ == "__main__":
    write_choice(sys.argv[2:], sys.argv[1])
