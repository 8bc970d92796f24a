"""What a page carries of its run for other programs, so that a report alone can be compared with another."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from visuohaptic.errors import ReportError
from visuohaptic.report.provenance import (
    PhaseSeconds,
    describe_machine,
    find_commit,
    find_versions,
)
from visuohaptic.report.run import Run

FORM = 1
"""Raised where an older reader would misread what is written."""

_SUMMARY = re.compile(r'<script type="application/json" id="run-summary">(.*?)</script>', re.DOTALL)


@dataclass(frozen=True)
class Archive:
    """A run as its report carries it: whole `metrics.json` and `params.yaml`, and what `provenance` found."""

    metrics: Mapping[str, Any]
    parameters: Mapping[str, Any]
    seconds: tuple[PhaseSeconds, ...]
    commit: str
    machine: Mapping[str, str]
    versions: Mapping[str, str]


def summarise_run(run: Run, seconds: Sequence[PhaseSeconds]) -> dict[str, Any]:
    """Give what the page carries, JSON-able."""
    archive = Archive(
        metrics=run.metrics,
        parameters=run.parameters.model_dump(mode="json", exclude={"workflow"}),
        seconds=tuple(seconds),
        commit=find_commit(),
        machine=dict(describe_machine()),
        versions=dict(find_versions()),
    )
    return {"form": FORM, **asdict(archive)}


def read_archive(page: str, source: str) -> Archive:
    """Read what a page carries.

    Raises `ReportError` if it is no report of this workflow, or of another version's form.
    """
    from pydantic import TypeAdapter

    found = _SUMMARY.search(page)
    if found is None:
        raise ReportError(
            f"{source} carries no run; a report that `visuohaptic report` or `snakemake -j2` "
            "wrote is needed."
        )
    try:
        values = json.loads(found[1])
        if values["form"] != FORM:
            raise ReportError(
                f"{source} is of form {values['form']}, and form {FORM} is read here; write the "
                "report again."
            )
        return TypeAdapter(Archive).validate_python(values)
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise ReportError(
            f"{source} carries a run that can't be read ({error!r}); write the report again."
        ) from error
