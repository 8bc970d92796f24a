"""The section of the report on looking, touching and both."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from eye_and_touch.study import CHECKED, LOOK, PRODUCT, STUDY, TOUCH
from eye_and_touch.tables import EYE_AND_TOUCH
from visuohaptic.report.drawing import style
from visuohaptic.report.estimates import Row, estimate_of, read_json
from visuohaptic.report.figures import draw_lines, label_axes, whole_percent
from visuohaptic.report.section import ReportContext, Section, SourceTable, Values
from visuohaptic.report.wording import counted, percent

TABLE, FIGURES = STUDY.shown

ANSWERS = {LOOK: "look", TOUCH: "touch", PRODUCT: "product", CHECKED: "checked product"}
"""Answers that are shown: name in `EYE_AND_TOUCH`, and label."""


def senses_figures(path: Path) -> Row:
    """Read ``reports/eye_and_touch.json``.

    Returns its ``curves``, ``curve_rows`` with accuracies as figures, a ``sentence``, and ``rows``: one row per sight
    with an estimate of each answer. Raises `ReportError` if the file holds other content.
    """

    def arrange(summary: Row) -> Row:
        rows = [
            {"sight": sight["sight"]}
            | {answer: estimate_of(sight["answers"][answer], "accuracy") for answer in ANSWERS}
            for sight in summary["sights"]
        ]
        curves = summary["curves"]
        return {
            "sentence": _sentence(summary, rows),
            "rows": rows,
            "curves": curves,
            "curve_rows": [{**row, "accuracy": estimate_of(row, "accuracy")} for row in curves],
        }

    way_out = "run `snakemake -j2 eye_and_touch_all` again"
    return read_json(path, arrange, "holds no figures of study eye_and_touch", way_out)


def _sentence(summary: Row, rows: Sequence[Row]) -> str:
    """Write the accuracies of looking, touching and both in clean sight and in the poorest sight."""
    clean, poorest = rows[0], min(rows, key=lambda row: row[LOOK].mean)
    price, touches = summary["prices"], summary["touches"]
    seconds = price["look_seconds"] + touches * price["touch_seconds"]
    return (
        f"A look of {price['look_seconds']:g} s classifies {percent(clean[LOOK].mean)} of the views "
        f"correctly, {counted(touches, 'touch')} in {seconds:g} s {percent(clean[TOUCH].mean)}, both "
        f"together {percent(clean[CHECKED].mean)}; in the poorest sight ({poorest['sight']}) the eye "
        f"alone reaches {percent(poorest[LOOK].mean)}, and both, where views unlike those of training "
        f"are left out, {percent(poorest[CHECKED].mean)}."
    )


def eye_and_touch_values(context: ReportContext) -> Values | None:
    """Return the values of the section; None if the run has no figures of the study."""
    path = context.run.existing_file(FIGURES)
    if path is None:
        return None
    return {"senses": senses_figures(path), "answers": ANSWERS, "draw_times": draw_times}


@style()
def draw_times(curves: Sequence[Mapping[str, Any]]) -> Figure:
    """Draw accuracy after a look and after each further touch against the robot's time, one line per strategy.

    `curves` come from ``reports/eye_and_touch.json``. Only the look and the checked product are drawn.
    """
    looks = [row for row in curves if row["answer"] == LOOK]
    lines: dict[str, Any] = {}
    for row in (row for row in curves if row["answer"] == CHECKED):
        lines.setdefault(row["strategy"], [*looks]).append(row)
    points = {
        strategy: zip(*sorted((row["seconds"], row["accuracy"]) for row in line), strict=True)
        for strategy, line in lines.items()
    }
    chart, axes = draw_lines(points, 190)
    axes.set_xscale("log")
    return label_axes(
        chart, "the robot's time, s", "correctly classified", xformat="{x:g}", yformat=whole_percent
    )


SECTION = Section(
    STUDY.name,
    STUDY.title,
    eye_and_touch_values,
    (SourceTable("Looking, touching and both", EYE_AND_TOUCH, TABLE),),
)
