"""Studies: changes of accuracy by condition, as rows and as sentences."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from visuohaptic.evaluation.intervals import SIGNIFICANCE
from visuohaptic.evaluation.published import PAPER_PIPELINE
from visuohaptic.report.estimates import Row, estimate_of
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
"""Conditions that a sentence names; further conditions are counted."""


def read_figures(folder: str | Path | None, study: str) -> list[dict[str, Any]]:
    """Read the rows of `tables.STUDY_FIGURES` of a study, in the order of column ``place``.

    The file is ``<study>.parquet`` in `folder`. Without a folder or file the result is empty.
    """
    path = None if folder is None else Path(folder) / f"{study}.parquet"
    if path is None or not path.is_file():
        return []
    rows: list[dict[str, Any]] = read_table(STUDY_FIGURES, path).to_pylist()
    return sorted(rows, key=lambda row: int(row["place"]))


def read_study(
    folder: str | Path | None, study: str, words: Callable[[str], str] = str
) -> Row | None:
    """Read the figures of a study for the page; return None if the study was not measured.

    `folder` and `study` are as in `read_figures`. `words` returns the name of a condition in words. The result has the
    ``title`` of the study, and ``tables``, one per pipeline and classifier, the paper's pipeline first.
    """
    rows = read_figures(folder, study)
    if not rows:
        return None
    cells = [{**row, "words": words(row["condition"])} for row in rows]
    tables = [_study_table(*key, group) for key, group in by_cell(cells).items()]
    return {"title": rows[0]["title"], "tables": tables}


def by_cell(rows: Sequence[Row]) -> dict[tuple[str, str], list[Row]]:
    """Group rows by pipeline and classifier, the paper's pipeline first."""
    keys = {(row["pipeline"], row["classifier"]) for row in rows}
    return {
        key: [row for row in rows if (row["pipeline"], row["classifier"]) == key]
        for key in sorted(keys, key=lambda key: (key[0] != PAPER_PIPELINE, key))
    }


def _study_table(pipeline: str, classifier: str, cells: list[Row]) -> Row:
    """Return ``rows`` per condition, ``sentences`` per strategy, and ``opponents``, which are compared with fixation."""
    rows: dict[str, dict[str, Any]] = {}
    for cell in cells:
        row = rows.setdefault(cell["condition"], {**cell, "seconds": 0.0, "by_strategy": {}})
        changes = {name: estimate_of(cell, name) for name in ("difference", "lead")}
        row["by_strategy"][cell["strategy"]] = {**cell, **changes}
        row["seconds"] += cell["seconds"] or 0.0
    strategies = sorted({cell["strategy"] for cell in cells})
    sentences = {
        strategy: _sentence([cell for cell in cells if cell["strategy"] == strategy])
        for strategy in strategies
    }
    return {
        "pipeline": pipeline,
        "classifier": classifier,
        "cells": cells,
        "rows": list(rows.values()),
        "strategies": strategies,
        "opponents": sorted({cell["strategy"] for cell in cells if cell["lead"] is not None}),
        "sentences": [
            titled(sentence if len(sentences) == 1 else f"{strategy_name(strategy)}: {sentence}")
            for strategy, sentence in sentences.items()
            if sentence
        ],
    }


def names_of_own_studies(run: Run) -> list[str]:
    """Return the measured studies that are neither part of the package nor bring a section of their own."""
    shown = {*PACKAGED, *section_files(run.files.study_folders)}
    return [file.stem for file in run.parts("studies") if file.stem not in shown]


def _sentence(cells: Sequence[Row]) -> str:
    """Return a sentence on the largest loss and gain of accuracy, and on significant changes."""
    others = [row for row in cells if row["adjusted_p"] is not None]
    if not others:
        return ""
    worst, best = (pick(others, key=lambda row: row["difference"]) for pick in (min, max))
    changes = [
        f"{words} “{row['words']}” ({points(row['difference'])} percentage points)"
        for words, row, applies in (
            ("the largest loss is with", worst, worst["difference"] < 0),
            ("the largest gain is with", best, best["difference"] > 0),
        )
        if applies
    ] or ["no condition changes the accuracy"]
    significant = [row["words"] for row in others if row["adjusted_p"] < SIGNIFICANCE]
    verdict = (
        f"these changes are significant (p after Holm's correction below {SIGNIFICANCE:g}): "
        f"{listed_in_short(significant, MOST_NAMED)}"
        if significant
        else "no change is significant (the smallest p after Holm's correction is "
        f"{probability(min(row['adjusted_p'] for row in others))})"
    )
    return f"{'; '.join(changes)}; with {counted(others[0]['objects'], 'object')} {verdict}."
