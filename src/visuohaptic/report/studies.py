"""Studies: how accuracy changes with what each condition changes, in rows and in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from visuohaptic.report.comparison import PAPER_PIPELINE, SIGNIFICANCE
from visuohaptic.report.wording import counted, listed, percent, points, probability, spaced
from visuohaptic.studies.ablations import OTHER_DESCRIPTORS
from visuohaptic.studies.declared import PACKAGED
from visuohaptic.tables.schema import read_table
from visuohaptic.tables.studies import STUDY_FIGURES

Row = Mapping[str, Any]

MOST_NAMED = 5
"""Conditions that a sentence names; more are counted."""

NO_LOSS = "Nothing makes it worse"

NAMES = {
    "whole_method": "whole method",
    "without_bags": "no classifier of bags",
    "turned_upright": "each object turned about the vertical",
    "turned_any_way": "each object's poses turned in any way",
    "azimuth_free": "no azimuth in the descriptors",
    "azimuth_free_turned_upright": "no azimuth, objects turned about the vertical",
    "contourlet_only": "contourlet bands as the only descriptor of the imprint",
    **{entry.name: f"{entry.label} instead" for entry in OTHER_DESCRIPTORS},
    "cutaneous_only": "cutaneous cues only",
    "kinesthetic_only": "kinesthetic cues only",
    "fixed_sensor_size": "sensor of fixed size",
    "without_map": "no self-organising map",
}
REMADE = {
    "recognition": "nothing but the recognition",
    "features": "descriptors",
    "touches": "touches",
    "views": "views, fixations and touches",
}


@dataclass(frozen=True)
class StudyTable:
    """One pipeline and classifier of a study.

    Attributes
    ----------
    pipeline, classifier : str
        Of what.
    strategies : tuple of str
        In the order of their columns.
    opponents : tuple of str
        Of them, those that fixation is compared with.
    sentences : tuple of str
        What the figures say, one a strategy.
    rows : sequence of mapping
        A condition each: its ``words``, what is ``remade``, ``seconds`` of all strategies, and
        ``cells``: rows of `tables.STUDY_FIGURES` by strategy.
    """

    pipeline: str
    classifier: str
    strategies: tuple[str, ...]
    opponents: tuple[str, ...]
    sentences: tuple[str, ...]
    rows: Sequence[Row]

    @property
    def cells(self) -> list[Row]:
        """All rows of `tables.STUDY_FIGURES`, each with the ``words`` of its condition."""
        return [cell for row in self.rows for cell in row["cells"].values()]


@dataclass(frozen=True)
class StudyFigures:
    """A study's name, its title and its tables, the paper's pipeline first."""

    name: str
    title: str
    tables: tuple[StudyTable, ...]


def read_figures(folder: str | Path | None, study: str) -> list[dict[str, Any]]:
    """Read `tables.STUDY_FIGURES` of a study from a folder; empty where it was not measured."""
    path = None if folder is None else Path(folder) / f"{study}.parquet"
    if path is None or not path.is_file():
        return []
    rows: list[dict[str, Any]] = read_table(STUDY_FIGURES, path).to_pylist()
    return sorted(rows, key=lambda row: int(row["place"]))


def read_study(folder: str | Path | None, study: str) -> StudyFigures | None:
    """Read a study's `tables.STUDY_FIGURES` for the page; None where it was not measured."""
    rows = read_figures(folder, study)
    if not rows:
        return None
    keys = sorted({(row["pipeline"], row["classifier"]) for row in rows})
    keys.sort(key=lambda key: key[0] != PAPER_PIPELINE)
    for row in rows:
        row["words"] = (
            row["condition"] if study not in PACKAGED else condition_name(row["condition"])
        )
    tables = tuple(
        _table([row for row in rows if (row["pipeline"], row["classifier"]) == key]) for key in keys
    )
    return StudyFigures(study, rows[0]["title"], tables)


def read_own_studies(folder: str | Path | None) -> list[StudyFigures]:
    """Read all studies that don't come with the package, by name."""
    if folder is None:
        return []
    names = sorted(path.stem for path in Path(folder).glob("*.parquet"))
    found = [read_study(folder, name) for name in names if name not in PACKAGED]
    return [study for study in found if study is not None]


def condition_name(name: str) -> str:
    """Give the name of a packaged study's condition in words."""
    if name in NAMES:
        return NAMES[name]
    channel = name.removeprefix("without_")
    return f"channel {spaced(channel)} left out" if channel != name else spaced(name)


def remade_name(name: str) -> str:
    """Say what a condition made again."""
    return REMADE[name]


def _table(rows: Sequence[Row]) -> StudyTable:
    strategies = tuple(dict.fromkeys(sorted(row["strategy"] for row in rows)))
    conditions: dict[str, dict[str, Any]] = {}
    for row in rows:
        about = {**row, "seconds": 0.0, "cells": {}}
        condition = conditions.setdefault(row["condition"], about)
        condition["cells"][row["strategy"]] = row
        condition["seconds"] += row["seconds"] or 0.0
    sentences = (
        _sentence([row for row in rows if row["strategy"] == strategy]) for strategy in strategies
    )
    return StudyTable(
        rows[0]["pipeline"],
        rows[0]["classifier"],
        strategies,
        tuple(name for name in strategies if _has_lead(rows, name)),
        tuple(sentences),
        list(conditions.values()),
    )


def _has_lead(rows: Sequence[Row], strategy: str) -> bool:
    return any(row["strategy"] == strategy and row["lead"] is not None for row in rows)


def _sentence(rows: Sequence[Row]) -> str:
    whole = rows[0]
    others = [row for row in rows if row["adjusted_p"] is not None]
    if not others or whole["accuracy"] is None:
        return ""
    one_reference = {row["compared_with"] for row in others} == {whole["condition"]}
    text = (
        f"With {whole['words']}, {percent(whole['accuracy'])} are correctly classified. "
        if one_reference
        else ""
    )
    worst, best = (pick(others, key=lambda row: row["difference"]) for pick in (min, max))
    text += f"The largest loss is {_change(worst)}" if worst["difference"] < 0 else NO_LOSS
    text += f"; the largest gain is {_change(best)}" if best["difference"] > 0 else ""
    settled = [row for row in others if row["adjusted_p"] < SIGNIFICANCE]
    objects = counted(others[0]["objects"], "object")
    if not settled:
        least = probability(min(row["adjusted_p"] for row in others))
        return (
            f"{text}. With {objects} no change is beyond chance (smallest Holm-adjusted p {least})."
        )
    names = [row["words"] for row in settled[:MOST_NAMED]]
    if len(settled) > MOST_NAMED:
        names.append(counted(len(settled) - MOST_NAMED, "other"))
    return (
        f"{text}. Beyond chance with {objects} (Holm-adjusted p below {SIGNIFICANCE:g}): "
        f"{listed(names)}."
    )


def _change(row: Row) -> str:
    return f"that of {row['words']}, {points(row['difference'])} percentage points"
