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


def asked_for(arguments: Sequence[str], studies: Iterable[Study]) -> set[str]:
    """Return the names of the studies of which a command line of Snakemake names a rule or a file."""
    studies = list(studies)
    by_file = {study.name for study in studies if any(map(study.owns, arguments))}
    return by_file | asked_by_rule(arguments, studies)


def asked_by_rule(arguments: Iterable[str], studies: Iterable[Study]) -> set[str]:
    """Return the names of the studies of which a command line names a rule, with or without a workflow module's prefix.

    Of rules with the same end, the longest name counts: `more_touches_all` is no rule of a study `touches`.
    """
    owners: dict[str, str] = {}
    for study in studies:
        owners[f"study_{study.name}"] = study.name
        if study.is_coded:
            owners[f"{study.name}_all"] = study.name
    return _owners_of(arguments, owners)


def _owners_of(rules: Iterable[str], owners: Mapping[str, str]) -> set[str]:
    """Return the studies of rules, whose names may have a prefix; `owners` has the study of each rule."""
    found = set()
    for rule in rules:
        named = [name for name in owners if f"_{rule}".endswith(f"_{name}")]
        found |= {owners[max(named, key=len)]} if named else set()
    return found


def studies_to_plan(
    arguments: Sequence[str], studies: Mapping[str, Study], of_run: Collection[str] = ()
) -> dict[str, Study]:
    """Return the studies that need rules.

    These are studies named in `of_run`, requested studies, studies with files, and studies whose files these take. A
    command line requests a study by a rule, by a file, or, in a job, by the value of wildcard ``study``.
    """
    steps = {step.name: study.name for study in studies.values() for step in study.steps}
    jobs = [argument.partition(":") for argument in arguments]
    of_jobs = {value for *_, wildcards in jobs for value in wildcards.split(",")}
    asked = {*of_run, *asked_for(arguments, studies.values())}
    asked |= _owners_of((rule for rule, *_ in jobs), steps)
    waiting = [
        study
        for study in studies.values()
        if study.name in asked or f"study={study.name}" in of_jobs or has_files(study)
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
