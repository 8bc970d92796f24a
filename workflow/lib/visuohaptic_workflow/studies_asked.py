"""Which studies a run is asked for, and which of those that the report shows are of an earlier state."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path, PurePosixPath
from typing import Any

from visuohaptic_workflow.keys import Job, read_record

RULES_OF_STUDY: Mapping[str, Sequence[str]] = {
    "certainty": ("certainty",),
    "looking": ("looking",),
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


def studies_asked_for(arguments: Sequence[str], studies: Iterable[str]) -> set[str]:
    """Find the studies of which a command line of Snakemake names a rule, or a file."""
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


def belongs_to(job: Job, study: str) -> bool:
    """Whether a job is part of a study."""
    named = (job.wildcards.get(wildcard) for wildcard in ("study", "weighed"))
    return study in named or job.rule in RULES_OF_STUDY.get(study, ())


def find_earlier_studies(shown: Mapping[str, Mapping[str, Any]]) -> dict[str, str]:
    """Find the studies that today's parameters, code and tables would not give.

    Parameters
    ----------
    shown : mapping of str to mapping
        By study: its ``figures``, a file; and ``keys``: today's key of what makes them, by record.

    Returns
    -------
    dict of str
        By study, the date of its figures; a study without figures is left out.
    """
    return {
        name: datetime.fromtimestamp(figures.stat().st_mtime, UTC).strftime("%Y-%m-%d")
        for name, study in shown.items()
        if (figures := Path(study["figures"])).is_file()
        and any(read_record(record).get("key") != key for record, key in study["keys"].items())
    }
