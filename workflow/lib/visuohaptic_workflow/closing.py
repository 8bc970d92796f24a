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
    from visuohaptic.stability.rows import broken_tolerances

    meshes = sorted(Path("results/meshes").glob("*/*/*.ply"), key=object_of)
    reasons = {object_of(mesh): set_aside_reason(mesh) for mesh in meshes}
    exceeded = broken_tolerances(sorted(Path("results/stability").rglob("*.parquet")))
    return [
        *(f"{key} was left out: {reason}" for key, reason in reasons.items() if reason),
        *(f"warning: {sentence}" for sentence in exceeded),
        *(describe_results() if report_is_current else []),
    ]


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
