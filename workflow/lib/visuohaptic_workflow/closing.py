"""End a run: move files of former jobs aside, and describe results and rejected objects."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Collection, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from visuohaptic.geometry.surface import notes_of, object_of, set_aside_reason
from visuohaptic.report.comparison import PipelineTable, pipeline_tables
from visuohaptic.report.wording import percent, percent_points, points, probability, strategy_name
from visuohaptic.stability.rows import broken_tolerances
from visuohaptic_workflow.keys import read_record

METRICS = "reports/metrics.json"
REPORT = "reports/report.html"
RECORDS = [Path("results", kind) for kind in ("records", "study_records", "model_records")]
"""Folders with records of jobs: of the run, of studies, and of models."""
ASIDE = Path(".cache/aside")


def lines_at_end(*, report_is_current: bool) -> list[str]:
    """Return the lines to print at the end of a run; accuracies only if the report is current."""
    meshes = sorted(Path("results/meshes").glob("*/*/*/*.ply"), key=object_of)
    reasons = {object_of(mesh): set_aside_reason(mesh) for mesh in meshes}
    exceeded = broken_tolerances(sorted(Path("results/stability").rglob("*.parquet")))
    return [
        *(f"{key} was left out: {reason}" for key, reason in reasons.items() if reason),
        *(f"warning: {object_of(mesh)}: {note}" for mesh in meshes for note in notes_of(mesh)),
        *(f"warning: {sentence}" for sentence in exceeded),
        *(describe_results() if report_is_current else []),
    ]


def describe_results(metrics: str | Path = METRICS, report: str | Path = REPORT) -> list[str]:
    """Return lines with the accuracies of each pipeline's most accurate classifier, and the report's path, if they exist."""
    lines = []
    if Path(metrics).is_file():
        try:
            lines += _describe_figures(json.loads(Path(metrics).read_text(encoding="utf-8")))
        except (ValueError, KeyError, TypeError):
            lines.append(f"{metrics} holds no metrics of this workflow.")
    if Path(report).is_file():
        lines.append(f"The report is at {report}.")
    return lines


def _describe_figures(metrics: Mapping[str, Any]) -> list[str]:
    lines = []
    for table in pipeline_tables(metrics):
        figures = (
            f"{strategy_name(strategy)} {percent(figure.mean)}{_interval(figure.low, figure.high)}"
            for strategy in table.strategies
            if (figure := table.headline.accuracy.get(strategy)) is not None
        )
        lines.append(
            f"Pipeline {table.name}, {table.headline.name}, correctly classified: {', '.join(figures)}."
        )
        lines += _describe_draws(table)
    return lines


def _describe_draws(table: PipelineTable) -> Iterator[str]:
    """Yield the lead of fixation over each strategy with several draws, and the standard deviation over draws."""
    for strategy, compared in table.headline.comparisons.items():
        lead, draws = compared.difference, compared.draws
        if draws is None or draws.count < 2:
            continue
        ends = (
            ""
            if lead.low is None or lead.high is None
            else f"{points(lead.low)} to {points(lead.high)}; "
        )
        yield (
            f"Fixation minus {strategy_name(strategy)}, mean of {draws.count} draws: {points(lead.mean)} points "
            f"({ends}p {probability(compared.p_value)}); one draw moves it by "
            f"±{percent_points(draws.standard_deviation)}."
        )


def _interval(low: float | None, high: float | None) -> str:
    return "" if low is None or high is None else f" ({100 * low:.1f} to {100 * high:.1f})"


def put_aside(named: Collection[str]) -> Iterator[str]:
    """Move files of former jobs, found by their records, to `ASIDE`, and yield a sentence if any were moved.

    Without this, a reader of a folder would read rows of an object twice after blocks changed.

    Parameters
    ----------
    named : collection of str
        The files of current jobs, which stay.
    """
    stale = []
    records = {str(record) for folder in RECORDS for record in folder.rglob("*.json")}
    # A current job may share its log with a former job.
    current = map(read_record, records.intersection(named))
    named = {*named, *(kept["log"] for kept in current if kept)}
    for record in sorted(records.difference(named)):
        stale.append(record)
        if kept := read_record(record):
            stale += [*kept["tables"], kept["log"]]
    target = ASIDE / time.strftime("%Y-%m-%d-%H%M%S")
    moved = [file for file in dict.fromkeys(stale) if file not in named and os.path.lexists(file)]
    for file in map(Path, moved):
        (target / file).parent.mkdir(parents=True, exist_ok=True)
        file.rename(target / file)
        with suppress(OSError):  # ends at the first folder that is not empty
            for folder in file.parents[:-2]:
                folder.rmdir()
    if moved:
        yield f"{len(moved)} files of former jobs were moved to {target}."
