"""Find the studies that a command line requests, and the studies that need rules."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from visuohaptic.base.errors import ParameterError
from visuohaptic_workflow.sweeping import is_stored

if TYPE_CHECKING:
    from visuohaptic.studies.study import Study


def names_of_run(studies: Mapping[str, Study], more: Iterable[str]) -> list[str]:
    """Return the names of the studies that every run makes: parts of the run, and `workflow.studies` as `more`.

    Raises `ParameterError` for a name without a study.
    """
    for name in more:
        if name not in studies:
            raise ParameterError(
                f"workflow.studies: {name!r} is no study; {', '.join(sorted(studies))} are allowed."
            )
    return [name for name, study in studies.items() if study.is_part_of_run or name in more]


def is_asked_for(arguments: Sequence[str], study: Study) -> bool:
    """Return whether a command line of Snakemake names a rule or file of a study."""
    return names_rules_of(arguments, study) or any(map(study.owns, arguments))


def names_rules_of(arguments: Iterable[str], study: Study) -> bool:
    """Return whether a command line names a rule of a study, with or without the prefix of a workflow module."""
    rules = [f"study_{study.name}", *([f"{study.name}_all"] if study.is_coded else [])]
    return any(f"_{argument}".endswith(f"_{rule}") for argument in arguments for rule in rules)


def studies_to_plan(
    arguments: Sequence[str], studies: Mapping[str, Study], of_run: Collection[str] = ()
) -> dict[str, Study]:
    """Return the studies that need rules.

    These are studies named in `of_run`, requested studies, studies with files, and studies whose files these take. A
    command line requests a study by a rule, by a file, or, in a job, by the value of wildcard ``study``.
    """
    waiting = [
        study
        for study in studies.values()
        if study.name in of_run
        or is_asked_for(arguments, study)
        or any(_names_step(argument, study) for argument in arguments)
        or has_files(study)
    ]
    chosen: set[str] = set()
    while waiting:
        study = waiting.pop()
        chosen.add(study.name)
        waiting += [
            other
            for other in studies.values()
            if other.name not in chosen and any(map(other.owns, study.all_inputs))
        ]
    return {name: study for name, study in studies.items() if name in chosen}


def has_files(study: Study) -> bool:
    """Return whether a study has files: in the folders of results, or stale files in the store."""
    records = (pattern for pattern in study.patterns if pattern.startswith("results/study_records"))
    return any(any(Path().glob(pattern)) for pattern in study.patterns) or any(
        map(is_stored, records)
    )


def _names_step(argument: str, study: Study) -> bool:
    rule, _, wildcards = argument.partition(":")
    named = any(f"_{rule}".endswith(f"_{step.name}") for step in study.steps)
    return named or f"study={study.name}" in wildcards.split(",")
