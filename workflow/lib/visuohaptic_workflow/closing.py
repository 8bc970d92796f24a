"""What a run says at its end: the figures, where the report is, and what was left out."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from visuohaptic.geometry.surface import object_of, set_aside_reason

METRICS = "reports/metrics.json"
REPORT = "reports/report.html"


def lines_at_end(*, report_is_current: bool) -> list[str]:
    """Give all that a run says at its end; figures only of a current report, as others are another run's."""
    results = describe_results() if report_is_current else []
    return [*objects_left_out(), *tolerances_exceeded(), *results]


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


def objects_left_out(meshes: str | Path = "results/meshes") -> list[str]:
    """Name the objects among the prepared meshes that can't be used, sorted, each with the reason."""
    return [
        f"{object_of(mesh)} was left out: {reason}"
        for mesh in sorted(Path(meshes).glob("*/*/*.ply"), key=object_of)
        if (reason := set_aside_reason(mesh))
    ]


def tolerances_exceeded(results: str | Path = "results") -> list[str]:
    """Name the tolerances that objects exceeded, in a warning each."""
    from visuohaptic.stability.rows import broken_tolerances

    sentences = broken_tolerances(sorted(Path(results, "stability").rglob("*.parquet")))
    return [f"warning: {sentence}" for sentence in sentences]


def _describe_figures(metrics: Mapping[str, Any]) -> list[str]:
    from visuohaptic.report.comparison import read_tables
    from visuohaptic.report.wording import percent, strategy_name

    lines = []
    for table in read_tables(metrics):
        figures = (
            f"{strategy_name(strategy)} {percent(figure.mean)}{_interval(figure.low, figure.high)}"
            for strategy in table.strategies
            if (figure := table.best.accuracy.get(strategy)) is not None
        )
        lines.append(
            f"Pipeline {table.name}, {table.best.name}, correctly classified: {', '.join(figures)}."
        )
    return lines


def _interval(low: float | None, high: float | None) -> str:
    return "" if low is None or high is None else f" ({100 * low:.1f} to {100 * high:.1f})"
