"""The section of the report on accuracy against touches: curves, areas, and a verdict."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from markupsafe import Markup
from matplotlib.figure import Figure

from touch_curves.study import STUDY
from touch_curves.tables import TOUCHES_NEEDED
from visuohaptic.evaluation.intervals import SIGNIFICANCE, holm
from visuohaptic.report.comparison import REFERENCE
from visuohaptic.report.drawing import look, style
from visuohaptic.report.estimates import Estimate, Row, estimate_of
from visuohaptic.report.figures import draw_lines, label_axes, whole_percent
from visuohaptic.report.section import ReportContext, Section, SourceTable, Values, figures_of
from visuohaptic.report.studies import by_cell, read_figures
from visuohaptic.report.wording import (
    counted,
    listed,
    percent,
    points,
    probability,
    strategy_name,
    strategy_place,
    titled,
)
from visuohaptic.tables.schema import read_table

NEEDED = "results/touches_needed.parquet"


def touch_curves_values(context: ReportContext) -> Values | None:
    """Return the values of the section, first of pipeline `paper`; None if the run has no figures of the study."""
    needed = context.run.existing_file(NEEDED)
    points_of = read_figures(context.run.extra_path("studies"), STUDY.name)
    if not points_of or needed is None:
        return None
    points_by_cell = by_cell(points_of)
    pipelines = [
        curves(*key, rows, points_by_cell.get(key, []))
        for key, rows in by_cell(read_table(TOUCHES_NEEDED, needed).to_pylist()).items()
    ]
    return {"pipelines": pipelines, "draw_curves": draw_curves} if pipelines else None


def curves(pipeline: str, classifier: str, needed: Sequence[Row], points_of: list[Row]) -> Row:
    """Return the values of one pipeline and classifier.

    ``rows`` are `needed`, rows of `TOUCHES_NEEDED`, with ``adjusted_p`` over the strategies, the largest area first.
    ``by_touches`` has one row per number of touches, with the ``accuracy`` of each strategy. ``refused`` has a
    sentence per strategy that was refused.
    """
    compared = [row for row in needed if row["p_value"] is not None]
    adjusted = holm([row["p_value"] for row in compared])
    adjusted_of = {row["strategy"]: value for row, value in zip(compared, adjusted, strict=True)}
    rows = [
        {**row, "adjusted_p": adjusted_of.get(row["strategy"]), "needed": touches_needed(row)}
        for row in needed
    ]
    rows.sort(key=lambda row: -row["area"])
    failed = [row for row in points_of if row.get("error")]
    by_touches: dict[int, dict[str, Estimate | None]] = {}
    for row in points_of:
        accuracy = estimate_of(row, "accuracy")
        by_touches.setdefault(row["place"] + 1, {})[row["strategy"]] = accuracy
    return {
        "pipeline": pipeline,
        "classifier": classifier,
        "rows": [
            {**row, "area": estimate_of(row, "area"), "gain": estimate_of(row, "gain")}
            for row in rows
        ],
        "points": points_of,
        "strategies": sorted((row["strategy"] for row in rows), key=strategy_place),
        "by_touches": [
            {"touches": touches, "accuracy": accuracy}
            for touches, accuracy in sorted(by_touches.items())
        ],
        "verdict": verdict(rows) if rows else "",
        "refused": [
            titled(f"{strategy_name(name)} has no area under the curve: {error}")
            for name, error in {row["strategy"]: row["error"] for row in failed}.items()
        ],
    }


def touches_needed(row: Row) -> Markup:
    """Write the number of touches that a strategy needs, with its interval."""
    most = row["most_touches"]
    text = Markup("{}").format(f"never up to {most}" if row["touches"] is None else row["touches"])
    if row["touches_low"] is None:
        return text
    high = f"more than {most}" if row["touches_high"] is None else row["touches_high"]
    return text + Markup('<span class="interval">{} to {}</span>').format(row["touches_low"], high)


def verdict(ranked: Sequence[Row]) -> str:
    """Write whether attention has the largest area, and which differences are significant; `ranked` are rows of `curves`."""
    best = ranked[0]
    first = (
        f"The largest area under the curve of 1 to {counted(best['most_touches'], 'touch')} is that of "
        f"{strategy_name(best['strategy'])}, {percent(best['area'])} of the area of perfect classification"
    )
    others = [row for row in ranked if row["gain"] is not None]
    if not others:
        return f"{first}."
    ahead = [row for row in others if row["gain"] < 0]
    wins = "attention does not win" if ahead else "attention wins"
    gaps = listed([f"{strategy_name(row['strategy'])} {points(row['gain'])}" for row in others])
    settled = [strategy_name(row["strategy"]) for row in others if row["adjusted_p"] < SIGNIFICANCE]
    least = probability(min(row["adjusted_p"] for row in others))
    chance = (
        f"beyond chance is the difference to {listed(settled)} (p after Holm's correction below {SIGNIFICANCE:g})"
        if settled
        else f"no difference is beyond chance (the least p after Holm's correction is {least})"
    )
    return (
        f"{first}: {wins}. Percentage points by which {strategy_name(REFERENCE)} are ahead of others: "
        f"{gaps}; with {counted(others[0]['objects'], 'object')} {chance}."
    )


@style()
def draw_curves(table: Sequence[Row]) -> Figure:
    """Draw accuracy against touches by strategy.

    `table` has rows of `tables.STUDY_FIGURES` of the study, of one pipeline and classifier.
    """
    rows = [row for row in table if row["accuracy"] is not None]
    strategies = sorted({row["strategy"] for row in rows}, key=strategy_place)
    lines, intervals = {}, {}
    for number, strategy in enumerate(strategies):
        own = sorted((row for row in rows if row["strategy"] == strategy), key=_place_in_study)
        aside = 0.06 * (number - (len(strategies) - 1) / 2)
        touches = np.array([_place_in_study(row) + 1 for row in own]) + aside
        lines[strategy] = touches, [row["accuracy"] for row in own]
        intervals[strategy] = [[_end(row, end) for row in own] for end in ("low", "high")]
    chart, axes = draw_lines(lines, 215)
    for strategy, (low, high) in intervals.items():
        colour, _ = look(strategy_place(strategy))
        axes.vlines(lines[strategy][0], low, high, colors=colour, linewidth=0.8, alpha=0.6)
    lowest = min(_end(row, "low") for row in rows)
    axes.set_ylim(min(math.floor(10 * lowest), 9) / 10, 1)
    axes.set_xticks(sorted({_place_in_study(row) + 1 for row in rows}))
    return label_axes(chart, "touches", "correctly classified", yformat=whole_percent)


def _place_in_study(row: Mapping[str, Any]) -> int:
    return int(row["place"])


def _end(row: Mapping[str, Any], end: str) -> float:
    """Return an end of the interval, or the accuracy if there is no interval, as for a single object."""
    return float(row["accuracy"] if row[end] is None else row[end])


SECTION = Section(
    STUDY.name,
    STUDY.title,
    touch_curves_values,
    (SourceTable("Area and touches needed", TOUCHES_NEEDED, NEEDED), figures_of(STUDY.name)),
)
