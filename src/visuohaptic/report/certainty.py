"""How sure answers are: prediction sets against their stated coverage, and objects of no known class."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from visuohaptic.recognition.certainty import least_objects
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.recognition.summary import select
from visuohaptic.report.estimates import Figure, Row, read_json
from visuohaptic.report.wording import counted, percent, strategy_name
from visuohaptic.studies.evaluation.models import MeasuredEvaluation, summarise_evaluation
from visuohaptic.tables.phases import owners_of
from visuohaptic.tables.schema import read_table
from visuohaptic.tables.studies import CERTAINTY


def certainty_figures(table: Path, figures: Path) -> Row:
    """Read `tables.CERTAINTY`, and the figures beside it as ``rows`` by strategy and number of views.

    Below ``least`` training objects the ``stated`` coverage leaves nothing out; ``enough`` says whether it did.
    """
    way_out = "run `snakemake -j2 certainty_all` again"
    rows = read_json(figures, _rows, "holds no figures of certainty", way_out)
    measured = read_table(CERTAINTY, table)
    classes = len(measured.column("left_out").unique())
    return {
        "table": measured,
        "rows": rows,
        "views": max(row["views"] for row in rows),
        "stated": rows[0]["stated"],
        "least": least_objects(rows[0]["stated"]),
        "classes": classes,
        "enough": any(row["set_size"] < classes - 1 for row in rows),
    }


def evaluation_figures(
    measured: MeasuredEvaluation, intervals: IntervalParameters, seed: int
) -> Row:
    """Sum up a model's answers for objects that it has not learnt, with ``rows`` as in `certainty_figures`."""
    rows = _rows(summarise_evaluation(measured.table, intervals, seed))
    known = select(measured.table, known=True)
    named = sorted(set(owners_of(known)))
    counts = Counter(category for category, _ in named)
    views = max(row["views"] for row in rows)
    found = "; ".join(_in_words(row) for row in rows if row["views"] == views)
    return {
        "sentence": f"Of {counted(len(named), 'object')} that the model has not learnt, {found}.",
        "rows": rows,
        "objects": len(named),
        "learnt": known["learnt"][0].as_py(),
        "classes": ", ".join(f"{category} ({count})" for category, count in counts.items()),
        "source": measured.source,
    }


def _in_words(row: Row) -> str:
    return (
        f"{percent(row['accuracy'].mean)} are correctly classified by {strategy_name(row['strategy'])} of "
        f"{counted(row['views'], 'view')}, and the prediction set holds the class of "
        f"{percent(row['coverage'].mean)} ({percent(row['stated'], 0)} stated)"
    )


def _rows(found: Sequence[Row]) -> list[Row]:
    return [
        {name: Figure(*value) if isinstance(value, list) else value for name, value in row.items()}
        for row in found
    ]
