"""What the report says of the paper under all its readings.

Folder ``studies/readings`` of the repository holds that study: its tables and rules give the verdict and the
sentences, which a run of it writes and `readings.json` beside this file keeps.
"""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict

from visuohaptic.report.estimates import read_json
from visuohaptic.studies.stored import Source

Verdict = Literal["yes", "no", "depends", "not shown"]

KEPT = "readings.json"


class Spread(BaseModel):
    """Readings on one set of objects, and in how many fixation leads or trails significantly."""

    model_config = ConfigDict(frozen=True)

    objects: int
    readings: int
    ahead: int
    behind: int


class ReadingsSummary(BaseModel):
    """What all readings say together: whether fixation leads, by the rule in docs/readings.md, and of how many.

    `literal` are accuracies of the most literal reading, by strategy and classifier; `source` is None for this run.
    """

    model_config = ConfigDict(frozen=True)

    verdict: Verdict
    spread: tuple[Spread, ...] = ()
    sentences: tuple[str, ...] = ()
    literal: dict[str, dict[str, float]] = {}
    source: Source | None = None


def read_readings(path: Path | None = None) -> ReadingsSummary:
    """Read what a run of the study wrote, ``reports/readings.json``, else what is kept with the package."""
    if path is None:
        kept = files("visuohaptic.report").joinpath(KEPT).read_text("utf-8")
        return ReadingsSummary.model_validate_json(kept)
    return read_json(
        path,
        lambda found: ReadingsSummary.model_validate(found["report"]),
        "has no summary of the readings",
        "run `snakemake -j2 readings_all` again, or delete the file",
    )
