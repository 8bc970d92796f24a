"""Studies: how accuracy changes with what each condition changes, or with touches, in rows and in words."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from markupsafe import Markup

from visuohaptic.recognition.intervals import holm
from visuohaptic.report.comparison import PAPER_PIPELINE, REFERENCE, SIGNIFICANCE
from visuohaptic.report.estimates import Row, figure_of, share_above_interval
from visuohaptic.report.run import Run
from visuohaptic.report.wording import (
    counted,
    listed,
    listed_in_short,
    percent,
    points,
    probability,
    strategy_name,
    strategy_place,
    titled,
)
from visuohaptic.studies.registry import PACKAGED, section_files
from visuohaptic.tables.schema import read_table
from visuohaptic.tables.studies import STUDY_FIGURES, TOUCHES_NEEDED

MOST_NAMED = 5
"""Conditions that a sentence names; more are counted."""

RECOMPUTED = {
    "recognition": "nothing but the recognition",
    "features": "descriptors",
    "touches": "touches",
    "views": "views, fixations and touches",
}


def read_figures(folder: str | Path | None, study: str) -> list[dict[str, Any]]:
    """Read `tables.STUDY_FIGURES` of a study from a folder; empty where it was not measured."""
    path = None if folder is None else Path(folder) / f"{study}.parquet"
    if path is None or not path.is_file():
        return []
    rows: list[dict[str, Any]] = read_table(STUDY_FIGURES, path).to_pylist()
    return sorted(rows, key=lambda row: int(row["place"]))


def read_study(
    folder: str | Path | None, study: str, words: Callable[[str], str] = str
) -> Row | None:
    """Read a study's `tables.STUDY_FIGURES` for the page; None where it was not measured.

    `words` writes a condition's name for readers. Gives its ``title``, and its ``tables``, one a pipeline and classifier, the paper's pipeline first.
    """
    rows = read_figures(folder, study)
    if not rows:
        return None
    cells = [{**row, "words": words(row["condition"])} for row in rows]
    tables = [_study_table(*key, own) for key, own in _by_cell(cells).items()]
    return {"title": rows[0]["title"], "tables": tables}


def _by_cell(rows: Sequence[Row]) -> dict[tuple[str, str], list[Row]]:
    """Part rows by pipeline and classifier, the paper's pipeline first."""
    keys = {(row["pipeline"], row["classifier"]) for row in rows}
    return {
        key: [row for row in rows if (row["pipeline"], row["classifier"]) == key]
        for key in sorted(keys, key=lambda key: (key[0] != PAPER_PIPELINE, key))
    }


def _study_table(pipeline: str, classifier: str, cells: list[Row]) -> Row:
    """Give rows of `tables.STUDY_FIGURES` as ``rows``, a condition each, and in ``sentences``; ``opponents`` are compared with fixation."""
    rows: dict[str, dict[str, Any]] = {}
    for cell in cells:
        row = rows.setdefault(cell["condition"], {**cell, "seconds": 0.0, "cells": {}})
        row["cells"][cell["strategy"]] = cell
        row["seconds"] += cell["seconds"] or 0.0
    strategies = sorted({cell["strategy"] for cell in cells})
    said = {
        one: _sentence([cell for cell in cells if cell["strategy"] == one]) for one in strategies
    }
    return {
        "pipeline": pipeline,
        "classifier": classifier,
        "cells": cells,
        "rows": list(rows.values()),
        "strategies": strategies,
        "opponents": sorted({cell["strategy"] for cell in cells if cell["lead"] is not None}),
        "sentences": [
            titled(text if len(said) == 1 else f"{strategy_name(one)}: {text}")
            for one, text in said.items()
            if text
        ],
    }


def names_of_own_studies(run: Run) -> list[str]:
    """Name the measured studies that neither come with the package nor bring a section of their own."""
    shown = {*PACKAGED, *section_files(run.files.studies)}
    return [file.stem for file in run.parts("studies") if file.stem not in shown]


def accuracy_or_error(cell: Row) -> str:
    """Write the accuracy of a row of `tables.STUDY_FIGURES`, or why it has none."""
    found = figure_of(cell, "accuracy")
    return f"failed: {cell['error']}" if found is None else share_above_interval(found)


def _sentence(cells: Sequence[Row]) -> str:
    """Say what loses and what gains most, and which changes are beyond chance."""
    others = [row for row in cells if row["adjusted_p"] is not None]
    if not others:
        return ""
    worst, best = (pick(others, key=lambda row: row["difference"]) for pick in (min, max))
    said = [
        f"{words} “{row['words']}” ({points(row['difference'])} percentage points)"
        for words, row, there in (
            ("most is lost with", worst, worst["difference"] < 0),
            ("most is gained with", best, best["difference"] > 0),
        )
        if there
    ] or ["nothing changes the accuracy"]
    settled = [row["words"] for row in others if row["adjusted_p"] < SIGNIFICANCE]
    chance = (
        f"beyond chance (Holm-adjusted p below {SIGNIFICANCE:g}): {listed_in_short(settled, MOST_NAMED)}"
        if settled
        else "no change is beyond chance (smallest Holm-adjusted p "
        f"{probability(min(row['adjusted_p'] for row in others))})"
    )
    return f"{'; '.join(said)}; with {counted(others[0]['objects'], 'object')} {chance}."


def curve_figures(studies: str | Path | None, needed: str | Path | None) -> list[Row]:
    """Read the curves over touches, the paper's pipeline first; empty where nothing was measured."""
    points_of = read_figures(studies, "curves")
    if not points_of or needed is None or not Path(needed).is_file():
        return []
    points_by_cell = _by_cell(points_of)
    return [
        curves(*key, rows, points_by_cell.get(key, []))
        for key, rows in _by_cell(read_table(TOUCHES_NEEDED, needed).to_pylist()).items()
    ]


def curves(pipeline: str, classifier: str, needed: Sequence[Row], points_of: list[Row]) -> Row:
    """Give ``rows`` of `tables.TOUCHES_NEEDED` with ``adjusted_p`` over the strategies, the largest area first.

    ``by_touches`` has a row for each number of touches, with the ``points`` of all strategies by name.
    """
    compared = [row for row in needed if row["p_value"] is not None]
    adjusted = holm([row["p_value"] for row in compared])
    found = {row["strategy"]: value for row, value in zip(compared, adjusted, strict=True)}
    rows = [{**row, "adjusted_p": found.get(row["strategy"])} for row in needed]
    rows.sort(key=lambda row: -row["area"])
    by_touches: dict[int, dict[str, Row]] = {}
    for row in points_of:
        by_touches.setdefault(row["place"] + 1, {})[row["strategy"]] = row
    return {
        "pipeline": pipeline,
        "classifier": classifier,
        "rows": rows,
        "points": points_of,
        "strategies": sorted((row["strategy"] for row in rows), key=strategy_place),
        "by_touches": [{"touches": one, "points": by_touches[one]} for one in sorted(by_touches)],
        "verdict": verdict(rows) if rows else "",
    }


def touches_needed(row: Row) -> Markup:
    """Write how many touches a strategy needs, with those that its intervals leave open."""
    most = row["most_touches"]
    found = Markup("{}").format(f"never up to {most}" if row["touches"] is None else row["touches"])
    if row["touches_low"] is None:
        return found
    high = f"more than {most}" if row["touches_high"] is None else row["touches_high"]
    return found + Markup('<span class="interval">{} to {}</span>').format(row["touches_low"], high)


def verdict(ranked: Sequence[Row]) -> str:
    """Say of rows of `curves` whether attention has the largest area, and what is beyond chance."""
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
        f"beyond chance is the difference to {listed(settled)} (Holm-adjusted p below {SIGNIFICANCE:g})"
        if settled
        else f"no difference is beyond chance (smallest Holm-adjusted p {least})"
    )
    return (
        f"{first}: {wins}. Percentage points by which {strategy_name(REFERENCE)} are ahead of others: "
        f"{gaps}; with {counted(others[0]['objects'], 'object')} {chance}."
    )
