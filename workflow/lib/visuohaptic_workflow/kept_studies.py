"""Studies that the report shows: which of them are asked for, and which are of an earlier state."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterable, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path, PurePosixPath
from typing import Any

from visuohaptic_workflow.plan import PlannedJob
from visuohaptic_workflow.records import expected_record, fits_record

_ARGUMENTS = "VISUOHAPTIC_ARGUMENTS"
"""The variable of the environment that holds the run's command line."""

RULES_OF_STUDY: Mapping[str, Sequence[str]] = {
    "certainty": ("certainty",),
    "curves": ("candidates_of_study", "adaptive_of_study", "touches_needed"),
    "readings": ("readings", "readings_page"),
}
"""What is measured beside the conditions of a study, by the rules that do it."""

_FOLDERS_BY_STUDY = frozenset(
    [
        *("studies", "study_blocks", "study_features"),
        *("figures_of_study", "block_of_study", "features_of_study"),
    ]
)
"""Folders, also of records, in which a study has a file or folder of its name."""

_FILES_OF_STUDY: Mapping[str, Sequence[str]] = {
    "cost": ("cost_seconds",),
    "curves": ("study_candidates", "study_adaptive"),
    "readings": ("reading",),
}
"""Other names of files and folders that belong to a study, beside those of its rules."""

_NEEDED = ("results/records/figures_of_study/", "results/records/block_of_study/")


def given_arguments(*, is_main: bool) -> list[str]:
    """Give the command line of the run, also in the processes of its jobs, which have command lines of their own.

    Parameters
    ----------
    is_main : bool
        Whether this process is the run's own, which hands its command line down.

    Returns
    -------
    list of str
        Its arguments; none in a job that has not inherited the run's environment.
    """
    if is_main:
        os.environ[_ARGUMENTS] = json.dumps(sys.argv[1:])
    return json.loads(os.environ.get(_ARGUMENTS, "[]"))


def studies_asked_for(arguments: Sequence[str], studies: Iterable[str]) -> set[str]:
    """Find the studies that a command line of Snakemake asks for.

    Parameters
    ----------
    arguments : sequence of str
        The command line.
    studies : iterable of str
        Names of all studies.

    Returns
    -------
    set of str
        Those of which a rule is named, or a file.
    """
    return {
        name
        for name in studies
        if names_rule(arguments, f"study_{name}")
        or names_rule(arguments, f"{name}_all")
        or any(_is_file_of(name, argument) for argument in arguments)
    }


def names_rule(arguments: Iterable[str], rule: str) -> bool:
    """Whether a command line names a rule, also with the prefix that it has in another workflow's module."""
    return any(argument == rule or argument.endswith(f"_{rule}") for argument in arguments)


def _is_file_of(study: str, file: str) -> bool:
    folder, *names = PurePosixPath(file).parts or ("",)
    if folder not in {"results", "reports"}:
        return False
    first, *deeper = [PurePosixPath(name).stem for name in names if name != "records"] or [""]
    if first in _FOLDERS_BY_STUDY:
        return deeper[:1] == [study]
    others = (*_FILES_OF_STUDY.get(study, ()), *RULES_OF_STUDY.get(study, ()))
    return (first == study and not deeper) or first in others


def belongs_to(job: PlannedJob, study: str) -> bool:
    """Whether a job is part of a study."""
    named = (job.wildcards.get(wildcard) for wildcard in ("study", "weighed"))
    return study in named or job.name in RULES_OF_STUDY.get(study, ())


def expected_records(jobs: Iterable[PlannedJob], study: str) -> dict[str, str]:
    """Give what the records of a study would say of parameters, code and names of files.

    Parameters
    ----------
    jobs : iterable of PlannedJob
        All jobs.
    study : str
        Its name.

    Returns
    -------
    dict of str
        By the record's path.
    """
    return {job.record: expected_record(job) for job in jobs if belongs_to(job, study)}


def find_earlier_studies(shown: Mapping[str, Mapping[str, Any]]) -> dict[str, str]:
    """Find the studies that today's tables, parameters and code would not give.

    Parameters
    ----------
    shown : mapping of str to mapping
        By study: its ``figures``, a file; and ``records``, as `expected_records` gives them.

    Returns
    -------
    dict of str
        By study, the date of its figures; a study without figures is left out.
    """
    return {
        name: datetime.fromtimestamp(figures.stat().st_mtime, UTC).strftime("%Y-%m-%d")
        for name, study in shown.items()
        if (figures := Path(study["figures"])).is_file()
        and not all(
            fits_record(record, expected)
            for record, expected in study["records"].items()
            # What is measured beside the conditions may be missing, and is not shown then.
            if Path(record).exists() or record.startswith(_NEEDED)
        )
    }
