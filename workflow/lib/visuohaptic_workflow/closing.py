"""What a run does at its end: it puts aside what is no longer named, and says what it found and left out."""

from __future__ import annotations

import json
import os
import time
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from visuohaptic.geometry.surface import notes_of, object_of, set_aside_reason
from visuohaptic.report.comparison import PipelineTable, read_tables
from visuohaptic.report.wording import (
    listed_in_short,
    percent,
    percent_points,
    points,
    probability,
    strategy_name,
)
from visuohaptic.stability.rows import broken_tolerances
from visuohaptic_workflow.keys import read_record

METRICS = "reports/metrics.json"
REPORT = "reports/report.html"
RECORDS = [Path("results", kind) for kind in ("records", "study_records", "model_records")]
"""Where jobs leave their records: those of a run, of studies, and of models."""
ASIDE = Path(".cache/aside")


def lines_at_end(*, report_is_current: bool) -> list[str]:
    """Return what a run prints at its end. Single objects and figures are printed only if the report is current."""
    meshes = sorted(Path("results/meshes").glob("*/*/*/*.ply"), key=object_of)
    reasons = {object_of(mesh): set_aside_reason(mesh) for mesh in meshes}
    exceeded = broken_tolerances(sorted(Path("results/stability").rglob("*.parquet")))
    return [
        *(f"{key} was left out: {reason}" for key, reason in reasons.items() if reason),
        *(f"warning: {object_of(mesh)}: {note}" for mesh in meshes for note in notes_of(mesh)),
        *(f"warning: {sentence}" for sentence in exceeded),
        *(
            _only_objects([key for key, reason in reasons.items() if not reason])
            * report_is_current
        ),
        *(describe_results() if report_is_current else []),
    ]


def _only_objects(keys: Sequence[str]) -> list[str]:
    """Return a sentence on the objects that no other object shares a class with; empty without such objects."""
    classes = Counter(key.split("/")[0] for key in keys)
    single = [key for key in keys if classes[key.split("/")[0]] == 1]
    needed = "Touched, but not recognised, because recognition needs two objects per class:"
    return [f"{needed} {listed_in_short(single)}."] if single else []


def describe_results(metrics: str | Path = METRICS, report: str | Path = REPORT) -> list[str]:
    """Give each pipeline's best classifier with its accuracy by strategy, and the report's path, as far as they are there."""
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
    for table in read_tables(metrics):
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
    """Say how far fixation leads each strategy that was drawn several times, and how far one draw moves that."""
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
    """Move what records name, but for the files of today's jobs, to a folder beside the results, and say so in a sentence.

    A reader of a folder would meet an object's rows twice where blocks were other ones. Nothing else is touched.
    """
    stale = []
    records = {str(record) for folder in RECORDS for record in folder.rglob("*.json")}
    # A job whose record has another place than before writes the log of before.
    of_today = map(read_record, records.intersection(named))
    named = {*named, *(kept["log"] for kept in of_today if kept)}
    for record in sorted(records.difference(named)):
        kept = read_record(record)
        stale += [record, *(kept["tables"] if kept else ()), *([kept["log"]] if kept else ())]
    target = ASIDE / time.strftime("%Y-%m-%d-%H%M%S")
    moved = [file for file in dict.fromkeys(stale) if file not in named and os.path.lexists(file)]
    for file in map(Path, moved):
        (target / file).parent.mkdir(parents=True, exist_ok=True)
        file.rename(target / file)
        with suppress(OSError):  # until a folder that holds something
            for folder in file.parents[:-2]:
                folder.rmdir()
    if moved:
        yield f"{len(moved)} files that today's run no longer names were put into {target}."
