"""Studies that the report shows: which of them are asked for, and which are of an earlier state."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from visuohaptic_workflow.plan import PlannedJob
from visuohaptic_workflow.records import expected_record, fits_record

RULES_OF_STUDY: Mapping[str, Sequence[str]] = {
    "certainty": ("certainty",),
    "curves": ("candidates_of_study", "adaptive_of_study", "touches_needed"),
    "readings": ("readings", "readings_page"),
}
"""What is measured beside the conditions of a study, by the rules that do it."""

_NEEDED = ("results/records/figures_of_study/", "results/records/block_of_study/")


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
        Those of which the target is named, or a file.
    """
    return {
        name
        for name in studies
        if {f"study_{name}", f"{name}_all"} & set(arguments)
        or any(f"/{name}" in argument for argument in arguments)
    }


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
