"""All studies of a run: those of the package and a user's own."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from itertools import accumulate
from operator import itemgetter
from pathlib import Path

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.ablations import ablation_study
from visuohaptic.studies.conditions import Plan, Planned, Study
from visuohaptic.studies.cost.settings import make_study
from visuohaptic.studies.curves.settings import curve_study
from visuohaptic.studies.effects.accuracy import effect_study
from visuohaptic.studies.own import read_study
from visuohaptic.studies.readings.design import make_readings_study

PACKAGED: dict[str, Callable[[ExperimentParameters], Study]] = {
    "frontier": partial(make_study, "frontier"),
    "cost": partial(make_study, "cost"),
    "curves": curve_study,
    "ablations": ablation_study,
    "effects": effect_study,
    "readings": make_readings_study,
}
"""Studies that come with the package, by name."""

RESERVED = (*PACKAGED, "certainty", "looking")
"""Names that no own study may have: those of the package, and of measurements without conditions."""

MOST_BLOCKS = 8
MOST_CONDITIONS_A_BLOCK = 25


def declared_studies(run: ExperimentParameters, own: Iterable[str | Path]) -> dict[str, Study]:
    """Give every study by its name, those of the package before those in the user's own files."""
    studies = [make(run) for make in PACKAGED.values()]
    studies += [read_study(path, run, reserved=RESERVED) for path in sorted(map(Path, own))]
    return {study.name: study for study in studies}


def make_blocks(plan: Plan, conditions_per_job: int | None) -> dict[str, list[Planned]]:
    """Cut a study into blocks that a job each measures, by names such as ``0000-0024``.

    Parameters
    ----------
    plan : Plan
        The study's conditions.
    conditions_per_job : int or None
        How many in a block, or some more; None for an eighth of them, at most 25.

    Returns
    -------
    dict of str to list of Planned
        By the block's name, such as 0000-0024.
    """
    count = len(plan.conditions)
    step = conditions_per_job or min(-(-count // MOST_BLOCKS), MOST_CONDITIONS_A_BLOCK)

    # Conditions that differ in the vote alone are trained once, by one job.
    trained: dict[tuple[str, str], list[Planned]] = {}
    for one in plan.conditions:
        trained.setdefault((one.key or "", one.parameters.model_dump_json()), []).append(one)
    blocks: list[list[Planned]] = [[]]
    for _, alike in sorted(trained.items(), key=itemgetter(0)):
        if len(blocks[-1]) >= step:
            blocks.append([])
        blocks[-1] += alike
    ends = [0, *accumulate(map(len, blocks))]
    return {
        f"{start:04d}-{end - 1:04d}": block
        for start, end, block in zip(ends, ends[1:], blocks, strict=False)
    }
