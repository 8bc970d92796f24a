"""Find the studies that a command line requests, and the studies that need rules."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path

from visuohaptic.base.errors import ParameterError
from visuohaptic.studies.study import FIGURES, Study
from visuohaptic_workflow.sweeping import is_stored


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
    """Return the names of the studies with a rule or a file that a command line of Snakemake names."""
    studies = list(studies)
    by_file = {study.name for study in studies if any(map(study.owns, arguments))}
    return by_file | asked_by_rule(arguments, studies)


def asked_by_rule(arguments: Iterable[str], studies: Iterable[Study]) -> set[str]:
    """Return the names of the studies with a rule that a command line names, with or without a workflow module's prefix.

    Of rules with the same end, the longest name counts: `more_touches_all` is no rule of a study `touches`.
    """
    owners: dict[str, str] = {}
    for study in studies:
        owners[f"study_{study.name}"] = study.name
        if study.is_coded:
            owners[f"{study.name}_all"] = study.name
    return _owners_of(arguments, owners)


def _owners_of(rules: Iterable[str], owners: Mapping[str, str]) -> set[str]:
    """Return the studies of rules. Names of rules may have a prefix; `owners` has the study of each rule."""
    found = set()
    for rule in rules:
        named = [name for name in owners if f"_{rule}".endswith(f"_{name}")]
        found |= {owners[max(named, key=len)]} if named else set()
    return found


def say_faults(
    faults: Mapping[str, ParameterError],
    studies: Collection[Study],
    arguments: Sequence[str],
    more: Collection[str] = (),
) -> list[str]:
    """Return a sentence per file of a study that can't be read.

    `faults` has the errors by name of the study (`registry.find_studies`). Raises the error if a study is requested, by
    the command line or by `workflow.studies` as `more`.
    """
    for name, error in faults.items():
        if name in more or name in asked_for(arguments, [*studies, Study(name, name)]):
            raise error
    return [f"{error} Study {name} is left out." for name, error in faults.items()]


def say_left_out(
    moved: Collection[str], studies: Collection[Study], arguments: Sequence[str], options: str = ""
) -> list[str]:
    """Return a sentence on the studies that leave the report, and another on studies whose file is deleted.

    Parameters
    ----------
    moved : collection of str
        The files that leave their places.
    studies : collection of Study
        The studies that have rules.
    arguments : sequence of str
        The command line of Snakemake. A study that it names is made again.
    options : str
        The options of the command line that set values, such as ``--config seed=3``.
    """
    sentences = []
    asked = asked_for(arguments, studies)
    left_out = [
        study.name
        for study in studies
        if study.name not in asked and not set(study.shown).isdisjoint(moved)
    ]
    if left_out:
        targets = " ".join(f"study_{name}" for name in left_out)
        command = f"snakemake -j2 {options} -- {targets}" if options else f"snakemake -j2 {targets}"
        sentences.append(
            f"The report leaves out {_in_words(left_out)}: `{command}` measures with today's values."
        )
    known = {study.name for study in studies}
    named = {name for file in moved for name in _names_in(file) if name not in known}
    if named:
        sentences.append(
            f"The report leaves out {_in_words(sorted(named))}, whose file is deleted or can't be read."
        )
    return sentences


def _names_in(file: str) -> list[str]:
    """Return the name of the study that a file with figures belongs to, or nothing."""
    found = (re.fullmatch(figures.format(r"(\w+)"), file) for figures in FIGURES)
    return [match[1] for match in found if match]


def _in_words(names: Sequence[str]) -> str:
    return f"{'study' if len(names) == 1 else 'studies'} {', '.join(names)}"


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
