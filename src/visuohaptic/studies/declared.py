"""All studies of a run: those of the package and a user's own."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.ablations import ablation_study
from visuohaptic.studies.conditions import Plan, Planned, Study
from visuohaptic.studies.cost.settings import cost_study
from visuohaptic.studies.curves.settings import curve_study
from visuohaptic.studies.effects.accuracy import effect_study
from visuohaptic.studies.own import read_study

PACKAGED: dict[str, Callable[[ExperimentParameters], Study]] = {
    "cost": cost_study,
    "curves": curve_study,
    "ablations": ablation_study,
    "effects": effect_study,
}
"""Studies that come with the package, by name."""

MOST_BLOCKS = 8
MOST_CONDITIONS_A_BLOCK = 25


def declared_studies(run: ExperimentParameters, own: Iterable[str | Path]) -> dict[str, Study]:
    """Give every study by its name, those of the package before those in the user's own files."""
    studies = [make(run) for make in PACKAGED.values()]
    studies += [read_study(path, run, reserved=PACKAGED) for path in sorted(map(Path, own))]
    return {study.name: study for study in studies}


def make_blocks(plan: Plan, conditions_per_job: int | None) -> dict[str, list[Planned]]:
    """Cut a study into blocks that a job each measures, by names such as ``0000-0024``.

    What shares features stands together. Without `conditions_per_job` a block has an eighth of the
    conditions, at most 25.
    """
    count = len(plan.conditions)
    step = conditions_per_job or min(-(-count // MOST_BLOCKS), MOST_CONDITIONS_A_BLOCK)
    ordered = sorted(
        plan.conditions, key=lambda one: (one.key or "", one.parameters.model_dump_json())
    )
    return {
        f"{start:04d}-{min(start + step, count) - 1:04d}": ordered[start : start + step]
        for start in range(0, count, step)
    }
