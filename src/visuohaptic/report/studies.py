"""Studies: how accuracy changes with what each condition changes, or with touches, in rows and in words."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from visuohaptic.evaluation.published import PAPER_PIPELINE
from visuohaptic.report.comparison import SIGNIFICANCE
from visuohaptic.report.estimates import Row, figure_of, share_above_interval
from visuohaptic.report.run import Run
from visuohaptic.report.wording import (
    counted,
    listed_in_short,
    points,
    probability,
    strategy_name,
    titled,
)
from visuohaptic.studies.registry import PACKAGED, section_files
from visuohaptic.tables.schema import read_table
from visuohaptic.tables.studies import STUDY_FIGURES

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
    tables = [_study_table(*key, own) for key, own in by_cell(cells).items()]
    return {"title": rows[0]["title"], "tables": tables}


def by_cell(rows: Sequence[Row]) -> dict[tuple[str, str], list[Row]]:
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
        f"beyond chance (p after Holm's correction below {SIGNIFICANCE:g}): {listed_in_short(settled, MOST_NAMED)}"
        if settled
        else "no change is beyond chance (the least p after Holm's correction is "
        f"{probability(min(row['adjusted_p'] for row in others))})"
    )
    return f"{'; '.join(said)}; with {counted(others[0]['objects'], 'object')} {chance}."
