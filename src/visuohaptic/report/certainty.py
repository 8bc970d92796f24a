"""How sure answers are: prediction sets against their stated coverage, and objects of no known class."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa

from visuohaptic.errors import ReportError
from visuohaptic.recognition.certainty import least_objects
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.recognition.summary import select
from visuohaptic.report.comparison import Figure
from visuohaptic.report.wording import counted, percent, strategy_name, titled
from visuohaptic.studies.evaluation.models import MeasuredEvaluation, summarise_evaluation
from visuohaptic.studies.stored import Source
from visuohaptic.tables.schema import read_table
from visuohaptic.tables.studies import CERTAINTY

Row = Mapping[str, Any]


@dataclass(frozen=True)
class CertaintyFigures:
    """What the section shows.

    Attributes
    ----------
    sentences : tuple of str
        The answer.
    stated : float
        Stated coverage.
    least : int
        Training objects that this coverage needs before it leaves anything out.
    enough : bool
        Whether there were so many: else the chart would show nothing but that.
    rows : tuple of mapping
        By strategy and views: ``strategy``, ``views``, ``set_size``, ``area``, and as `Figure`
        ``accuracy``, ``coverage``, ``false_unknown``, ``found_unknown``.
    classes, views : int
        Classes, each left out once; largest number of views, which the chart shows.
    table : pyarrow.Table
        Rows of `tables.CERTAINTY`.
    """

    sentences: tuple[str, ...]
    stated: float
    least: int
    enough: bool
    rows: tuple[Row, ...]
    classes: int
    views: int
    table: pa.Table


def certainty_figures(
    table: str | Path | None, figures: str | Path | None
) -> CertaintyFigures | None:
    """Read `tables.CERTAINTY` and the figures beside it; None where they were not measured.

    Raises `ReportError` if the figures can't be read.
    """
    if table is None or figures is None or not (Path(table).is_file() and Path(figures).is_file()):
        return None
    measured = read_table(CERTAINTY, table)
    rows = _read_figures(Path(figures))
    views = max(row["views"] for row in rows)
    stated = rows[0]["stated"]
    classes = len(measured.column("left_out").unique())
    return CertaintyFigures(
        tuple(_sentence(row) for row in rows if row["views"] == views),
        stated,
        least_objects(stated),
        any(row["set_size"] < classes - 1 for row in rows),
        rows,
        classes,
        views,
        measured,
    )


@dataclass(frozen=True)
class EvaluationFigures:
    """What the section shows of objects that a model has not learnt.

    Attributes
    ----------
    sentence : str
        The answer.
    rows : tuple of mapping
        By strategy and views, as in `CertaintyFigures`, without ``area``.
    objects, learnt : int
        Objects that were named, of known classes; that the model learnt.
    classes : str
        Their classes, each with its number of objects.
    source : Source or None
        Where they come from, if not from this run's objects.
    """

    sentence: str
    rows: tuple[Row, ...]
    objects: int
    learnt: int
    classes: str
    source: Source | None


def evaluation_figures(
    measured: MeasuredEvaluation, intervals: IntervalParameters, seed: int
) -> EvaluationFigures:
    """Sum up a model's answers for objects that it has not learnt."""
    rows = tuple(map(_with_intervals, summarise_evaluation(measured.table, intervals, seed)))
    known = select(measured.table, known=True)
    named = {(row["class"], row["object"]) for row in known.select(["class", "object"]).to_pylist()}
    counts = Counter(category for category, _ in sorted(named))
    views = max(row["views"] for row in rows)
    return EvaluationFigures(
        _evaluation_answer([row for row in rows if row["views"] == views], len(named)),
        rows,
        len(named),
        known["learnt"][0].as_py(),
        ", ".join(f"{category} ({count})" for category, count in counts.items()),
        measured.source,
    )


def _sentence(row: Row) -> str:
    return (
        f"{titled(strategy_name(row['strategy']))}, {counted(row['views'], 'view')}: the prediction set "
        f"holds the true class of {percent(row['coverage'].mean)} of the objects of known classes "
        f"({percent(row['stated'], 0)} stated); {percent(row['found_unknown'].mean)} of the objects of "
        f"unknown classes are called unknown, and {percent(row['false_unknown'].mean)} of the known ones."
    )


def _evaluation_answer(rows: Sequence[Row], objects: int) -> str:
    """Say how a model does on objects that it has not learnt; the rows are of one number of views."""
    told = [
        f"{percent(row['accuracy'].mean)} are correctly classified by {strategy_name(row['strategy'])} of "
        f"{counted(row['views'], 'view')}, and the prediction set holds the class of "
        f"{percent(row['coverage'].mean)} ({percent(row['stated'], 0)} stated)"
        for row in rows
    ]
    return f"Of {counted(objects, 'object')} that the model has not learnt, {'; '.join(told)}."


def _read_figures(path: Path) -> tuple[Row, ...]:
    try:
        return tuple(_with_intervals(row) for row in json.loads(path.read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError, AttributeError) as error:
        raise ReportError(
            f"{path} holds no figures of certainty ({error}); run `snakemake -j2 certainty_all` again."
        ) from error


def _with_intervals(row: Row) -> Row:
    return {
        name: Figure(*value) if isinstance(value, list) else value for name, value in row.items()
    }
