"""End a run: move files of former jobs, and list left-out objects, warnings and accuracies."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from visuohaptic.geometry.surface import notes_of, object_of, set_aside_reason
from visuohaptic.io.job_logs import read_warnings
from visuohaptic.report.comparison import PipelineTable, pipeline_tables
from visuohaptic.report.leads import run_leads
from visuohaptic.report.wording import (
    counted,
    listed_in_short,
    percent,
    points,
    probability,
    strategy_name,
)
from visuohaptic.stability.rows import broken_tolerances

METRICS = "reports/metrics.json"
REPORT = "reports/report.html"
WORDS = {"seeing": "Seeing", "salience": "Salience"}
"""First words of the printed lines by name of the lead."""
MOST_LINES = 20
"""Largest number of left-out objects, and of notes of meshes, that are printed, as in the report."""


def lines_at_end(logs: Iterable[str | Path] = (), *, report_is_current: bool) -> list[str]:
    """Return the lines to print at the end of a run.

    The lines name each left-out object with the reason, then warn of notes of meshes and of exceeded tolerances
    (`stability.rows.broken_tolerances`). The warnings in the logs of jobs, `logs`, come once each. Only if the report is current, lines on objects without a second object of
    their class and the lines of `describe_results` follow. Files are read from folders ``results`` and ``reports`` of
    the working directory.
    """
    meshes = _meshes()
    reasons = {object_of(mesh): set_aside_reason(mesh) for mesh in meshes}
    exceeded = broken_tolerances(sorted(Path("results/stability").rglob("*.parquet")))
    notes = [f"warning: {object_of(mesh)}: {note}" for mesh in meshes for note in notes_of(mesh)]
    return [
        *lines_of_left_out(),
        *_first_lines(notes),
        *(f"warning: {sentence}" for sentence in exceeded),
        *_first_lines(read_warnings(logs)),
        *(
            _only_objects([key for key, reason in reasons.items() if not reason])
            * report_is_current
        ),
        *(describe_results() if report_is_current else []),
    ]


def lines_of_left_out() -> list[str]:
    """Return a line with the reason per object that was left out, by the files in ``results/meshes``."""
    reasons = {object_of(mesh): set_aside_reason(mesh) for mesh in _meshes()}
    return _first_lines(
        [f"{key} was left out: {reason}" for key, reason in reasons.items() if reason]
    )


def _meshes() -> list[Path]:
    return sorted(Path("results/meshes").glob("*/*/*/*.ply"), key=object_of)


def _first_lines(lines: Sequence[str]) -> list[str]:
    """Return the first `MOST_LINES` lines, and a line that counts the rest."""
    more = len(lines) - MOST_LINES
    rest = [f"Lines of this kind that the report has, but this list has not: {more:,}."]
    return [*lines[:MOST_LINES], *rest * (more > 0)]


def _only_objects(keys: Sequence[str]) -> list[str]:
    """Return a sentence on the objects that no other object shares a class with; empty without such objects."""
    classes = Counter(key.split("/")[0] for key in keys)
    single = [key for key in keys if classes[key.split("/")[0]] == 1]
    needed = "Touched, but not recognised, because recognition needs two objects per class:"
    return [f"{needed} {listed_in_short(single)}."] if single else []


def describe_results(metrics: str | Path = METRICS, report: str | Path = REPORT) -> list[str]:
    """Return lines with the accuracies of each pipeline's headline classifier, and a line with the report's path.

    Accuracies are in percent by strategy. A line per question, seeing and salience, has the lead of fixations.

    Parameters
    ----------
    metrics : str or Path
        Path of ``metrics.json``. A missing file adds no lines; an invalid file adds a line that says so.
    report : str or Path
        Path of the report. A missing file adds no line.
    """
    lines = []
    if Path(metrics).is_file():
        try:
            lines += _describe_accuracies(json.loads(Path(metrics).read_text(encoding="utf-8")))
        except (ValueError, KeyError, TypeError):
            lines.append(f"{metrics} holds no metrics of this workflow.")
    if Path(report).is_file():
        lines.append(f"The report is at {report}.")
    return lines


def _describe_accuracies(metrics: Mapping[str, Any]) -> list[str]:
    """Return a line per pipeline with its accuracies, followed by its lines of `_describe_leads`."""
    lines: list[str] = []
    for table in pipeline_tables(metrics):
        figures = (
            f"{strategy_name(strategy)} {percent(figure.mean)}{_interval(figure.low, figure.high)}"
            for strategy in table.strategies
            if (figure := table.headline.accuracy.get(strategy)) is not None
        )
        lines.append(
            f"Pipeline {table.name}, {table.headline.name}, correctly classified: {', '.join(figures)}."
        )
        lines += _describe_leads(metrics, table)
    return lines


def _describe_leads(metrics: Mapping[str, Any], table: PipelineTable) -> Iterator[str]:
    """Yield the leads of fixations, of the headline classifier of a pipeline, one line per question."""
    # The pose and the known frame, which a line does not name, are those of any run.
    for lead in run_leads(metrics, {table.name: table.headline.key}, "none", "full"):
        if lead.name not in WORDS:
            continue
        first, second = lead.places
        ends = ""
        if lead.difference.low is not None and lead.difference.high is not None:
            ends = f"{points(lead.difference.low)} to {points(lead.difference.high)}; "
        yield (
            f"{WORDS[lead.name]}, {first} minus {second}: {points(lead.difference.mean)} points ({ends}p "
            f"{probability(lead.p_value)}; {counted(lead.draws, 'draw')} of the places)."
        )


def _interval(low: float | None, high: float | None) -> str:
    """Return the ends of an interval in percent, in brackets after a blank; an empty string without ends."""
    return "" if low is None or high is None else f" ({100 * low:.1f} to {100 * high:.1f})"
