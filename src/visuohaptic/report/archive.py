"""What a page carries of its run for other programs, so that a report alone can be compared with another."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any, Literal

from pydantic import BaseModel, ValidationError

from visuohaptic.errors import ReportError
from visuohaptic.report.provenance import (
    PhaseSeconds,
    describe_machine,
    find_commit,
    find_versions,
)
from visuohaptic.report.run import Run

_SUMMARY = re.compile(r'<script type="application/json" id="run-summary">(.*?)</script>', re.DOTALL)


class Archive(BaseModel):
    """A run as its report carries it: whole `metrics.json` and `params.yaml`, and what `provenance` found.

    `form` is raised where an older reader would misread what is written.
    """

    form: Literal[1] = 1
    metrics: dict[str, Any]
    parameters: dict[str, Any]
    seconds: tuple[PhaseSeconds, ...]
    commit: str
    machine: dict[str, str]
    versions: dict[str, str]


def summarise_run(run: Run, seconds: Sequence[PhaseSeconds]) -> dict[str, Any]:
    """Give what the page carries, JSON-able."""
    return Archive(
        metrics=dict(run.metrics),
        parameters=run.parameters.model_dump(mode="json", exclude={"workflow"}),
        seconds=tuple(seconds),
        commit=find_commit(),
        machine=dict(describe_machine()),
        versions=dict(find_versions()),
    ).model_dump(mode="json")


def read_archive(page: str, source: str) -> Archive:
    """Read what a page carries; `ReportError` if it is no report of this workflow, or of another form."""
    found = _SUMMARY.search(page)
    try:
        return Archive.model_validate_json(found[1] if found else "")
    except ValidationError as error:
        (fault, *_) = error.errors()
        raise ReportError(
            f"{source} carries no run that can be read ({'.'.join(map(str, fault['loc']))}: {fault['msg']}); "
            "a report that `visuohaptic report` or `snakemake -j2` wrote is needed."
        ) from error
