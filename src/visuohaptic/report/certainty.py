"""How sure answers are: prediction sets against their stated coverage, and objects of no known class."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import pyarrow as pa

from visuohaptic.errors import ReportError
from visuohaptic.recognition.certainty import least_objects
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.recognition.summary import select
from visuohaptic.report.estimates import Figure, Row
from visuohaptic.report.wording import counted, percent, strategy_name
from visuohaptic.studies.evaluation.models import MeasuredEvaluation, summarise_evaluation
from visuohaptic.studies.stored import Source
from visuohaptic.tables.schema import read_table
from visuohaptic.tables.studies import CERTAINTY


@dataclass(frozen=True)
class CertaintyFigures:
    """Answers for objects of known and of unknown classes, rows of `tables.CERTAINTY`.

    `rows` are by strategy and views: ``strategy``, ``views``, ``set_size``, ``area``, ``stated``, and as
    `Figure` ``accuracy``, ``coverage``, ``false_unknown``, ``found_unknown``.
    """

    table: pa.Table
    rows: tuple[Row, ...]

    @property
    def views(self) -> int:
        """Largest number of views, which the chart shows."""
        return max(row["views"] for row in self.rows)

    @property
    def stated(self) -> float:
        """Stated coverage."""
        return float(self.rows[0]["stated"])

    @property
    def least(self) -> int:
        """Training objects that this coverage needs before it leaves anything out."""
        return least_objects(self.stated)

    @property
    def classes(self) -> int:
        """Classes, each left out once."""
        return len(self.table.column("left_out").unique())

    @property
    def enough(self) -> bool:
        """Whether there were so many objects: else the chart would show nothing but that."""
        return any(row["set_size"] < self.classes - 1 for row in self.rows)


@dataclass(frozen=True)
class EvaluationFigures:
    """A model on objects that it has not learnt.

    `rows` are as in `CertaintyFigures`, without ``area``; `source` says where they come from, if not
    from this run's objects; `classes` names each class with its number of objects.
    """

    sentence: str
    rows: tuple[Row, ...]
    objects: int
    learnt: int
    classes: str
    source: Source | None


def certainty_figures(
    table: str | Path | None, figures: str | Path | None
) -> CertaintyFigures | None:
    """Read `tables.CERTAINTY` and the figures beside it; None where they were not measured.

    Raises `ReportError` if the figures can't be read.
    """
    if table is None or figures is None or not (Path(table).is_file() and Path(figures).is_file()):
        return None
    try:
        rows = json.loads(Path(figures).read_text(encoding="utf-8"))
        return CertaintyFigures(read_table(CERTAINTY, table), tuple(map(_with_intervals, rows)))
    except (OSError, ValueError, TypeError, AttributeError) as error:
        raise ReportError(
            f"{figures} holds no figures of certainty ({error}); run `snakemake -j2 certainty_all` again."
        ) from error


def evaluation_figures(
    measured: MeasuredEvaluation, intervals: IntervalParameters, seed: int
) -> EvaluationFigures:
    """Sum up a model's answers for objects that it has not learnt."""
    rows = tuple(map(_with_intervals, summarise_evaluation(measured.table, intervals, seed)))
    known = select(measured.table, known=True)
    named = {(row["class"], row["object"]) for row in known.select(["class", "object"]).to_pylist()}
    counts = Counter(category for category, _ in sorted(named))
    views = max(row["views"] for row in rows)
    found = "; ".join(_in_words(row) for row in rows if row["views"] == views)
    return EvaluationFigures(
        f"Of {counted(len(named), 'object')} that the model has not learnt, {found}.",
        rows,
        len(named),
        known["learnt"][0].as_py(),
        ", ".join(f"{category} ({count})" for category, count in counts.items()),
        measured.source,
    )


def _in_words(row: Row) -> str:
    return (
        f"{percent(row['accuracy'].mean)} are correctly classified by {strategy_name(row['strategy'])} of "
        f"{counted(row['views'], 'view')}, and the prediction set holds the class of "
        f"{percent(row['coverage'].mean)} ({percent(row['stated'], 0)} stated)"
    )


def _with_intervals(row: Row) -> Row:
    return {
        name: Figure(*value) if isinstance(value, list) else value for name, value in row.items()
    }
