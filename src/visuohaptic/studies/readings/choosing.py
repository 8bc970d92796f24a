"""Which reading is the package's default: the rule, applied to objects outside the paper's set.

The rule was written down before it was applied. It looks at readings of the part ``recognition``:

1. The score of a reading is the mean over objects of the share of an object's sequences that are
   correctly classified, averaged over the paper's five classifiers and both strategies, so that no
   classifier and no strategy is favoured. A reading in which one of these ten can't be run has none.
2. The best reading has the highest score. A reading stays a candidate unless its score is
   significantly lower than the best one's (paired over objects, sign changes, at 0.05).
3. Of the candidates, the default is the one that differs from the default of before in the fewest
   choices; of these, the one with the highest score.

`python -m visuohaptic.studies.readings.choosing chosen.json results/study_blocks/readings/*.parquet`
applies it.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from visuohaptic.errors import RecognitionError
from visuohaptic.recognition.intervals import compare_paired
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.recognition.published import TABLE_1
from visuohaptic.seeds import spawn_generator
from visuohaptic.studies.figures import Cell, CellKey, read_cells, write_json
from visuohaptic.studies.readings.choices import CHOICES
from visuohaptic.studies.readings.design import STRATEGIES, Options, all_readings
from visuohaptic.studies.readings.leads import SIGNIFICANT

FORMER_DEFAULT: Options = {choice.name: choice.base for choice in CHOICES}
"""The default before the rule was applied."""


@dataclass(frozen=True)
class Candidate:
    """A reading that the rule looks at.

    Attributes
    ----------
    reading : str
        Its name.
    score : float
        Its accuracy over all classifiers and strategies.
    behind, p_value : float
        How far it is behind the best score, and the two-sided p value of that.
    changed : dict of str to str
        Its options that differ from the former default's.
    """

    reading: str
    score: float
    behind: float
    p_value: float
    changed: dict[str, str]


@dataclass(frozen=True)
class Chosen:
    """What the rule says.

    Attributes
    ----------
    objects, readings, candidates : int
        How many objects and readings the rule saw, and how many readings were candidates.
    chosen, best, former : Candidate
        The new default, the reading with the highest score, and the default of before.
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
    """Apply the rule to the cells of study `readings`, as `read_cells` gives them.

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


def _cells_of_reading(cells: Mapping[CellKey, Cell], name: str) -> list[Cell]:
    keys = [
        (name, "paper", strategy, classifier) for strategy in STRATEGIES for classifier in TABLE_1
    ]
    if missing := [key for key in keys if key not in cells]:
        raise RecognitionError(f"Reading {name} has no result for {' '.join(missing[0][2:])}.")
    return [cells[key] for key in keys]


def write_choice(parts: Iterable[str | Path], output: str | Path) -> None:
    """Write what the rule says of a study's blocks as JSON."""
    from visuohaptic.parameters import ExperimentParameters

    run = ExperimentParameters()
    chosen = choose_default(read_cells(parts), run.recognition.intervals, run.seed)
    write_json(asdict(chosen), output)


if __name__ == "__main__":
    write_choice(sys.argv[2:], sys.argv[1])
