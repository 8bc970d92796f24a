"""Which studies a run is asked for, and which of those that the report shows are of an earlier state."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from datetime import UTC, datetime
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

from visuohaptic.io import moved
from visuohaptic_workflow.keys import read_record

if TYPE_CHECKING:
    from visuohaptic.studies.study import Study


def is_asked_for(arguments: Sequence[str], study: Study) -> bool:
    """Whether a command line of Snakemake names a rule of a study, or a file."""
    return names_rules_of(arguments, study.name) or any(map(study.owns, arguments))


def names_rules_of(arguments: Iterable[str], study: str) -> bool:
    """Whether a command line names a rule of a study, also with the prefix that it has in another workflow's module."""
    rules = (f"study_{study}", f"{study}_all")
    return any(f"_{argument}".endswith(f"_{rule}") for argument in arguments for rule in rules)


def studies_to_plan(arguments: Sequence[str], studies: Mapping[str, Study]) -> dict[str, Study]:
    """Choose the studies that need rules: parts of the run, what is asked for, what has files, and what these take from.

    A study is asked for by its rules, its files, or, on the command line of a job, as value of wildcard ``study``.
    """
    waiting = [
        study
        for study in studies.values()
        if study.is_part_of_run
        or is_asked_for(arguments, study)
        or any(_names_step(argument, study) for argument in arguments)
        or any(any(Path().glob(pattern)) for pattern in study.patterns)
    ]
    chosen: set[str] = set()
    while waiting:
        study = waiting.pop()
        chosen.add(study.name)
        waiting += [
            other
            for other in studies.values()
            if other.name not in chosen and any(map(other.owns, study.taken))
        ]
    return {name: study for name, study in studies.items() if name in chosen}


def find_moved(arguments: Sequence[str], studies: Mapping[str, Study]) -> str | None:
    """Say of the first old name of a target on a command line where it is now.

    What a study of today has is no old name.
    """
    for option, argument in pairwise(("", *arguments)):
        if argument.startswith("-") or _PATHS_FOLLOW.fullmatch(option):
            continue
        if _is_of_any(argument, studies):
            continue
        if argument in moved.TARGETS:
            return f"{argument} is no target: {moved.TARGETS[argument]}."
        renamed = _OLD_WORD.sub(lambda found: moved.STUDIES[found[0]], argument)
        if renamed != argument and _is_of_any(renamed, studies):
            return f"{argument} is no target: it is now {renamed}."
    return None


_PATHS_FOLLOW = re.compile("-[ds]|--.*(directory|prefix|profile|snakefile|configfiles?)")
_OLD_WORD = re.compile(rf"(?<![a-z])({'|'.join(moved.STUDIES)})(?![a-z])")


def _is_of_any(argument: str, studies: Mapping[str, Study]) -> bool:
    return any(
        is_asked_for([argument], study) or _names_step(argument, study)
        for study in studies.values()
    )


def _names_step(argument: str, study: Study) -> bool:
    rule, _, wildcards = argument.partition(":")
    named = any(f"_{rule}".endswith(f"_{step.name}") for step in study.steps)
    return named or f"study={study.name}" in wildcards.split(",")


def find_earlier_studies(shown: Mapping[str, Mapping[str, Any]]) -> dict[str, str]:
    """Find the studies that today's parameters, code and tables would not give, with the dates of their figures.

    `shown` has of each study its ``figures``, a file, and ``keys``: today's key of what makes them, by record.
    """
    return {
        name: datetime.fromtimestamp(figures.stat().st_mtime, UTC).strftime("%Y-%m-%d")
        for name, study in shown.items()
        if (figures := Path(study["figures"])).is_file()
        and any(read_record(record).get("key") != key for record, key in study["keys"].items())
    }
