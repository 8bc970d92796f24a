"""Which studies a run is asked for, and which of those that the report shows are of an earlier state."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

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
