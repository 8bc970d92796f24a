"""What a model answers for objects that it has not learnt."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from visuohaptic.evaluation.summary import select
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.estimates import Figure, Row
from visuohaptic.report.wording import counted, percent, strategy_name
from visuohaptic.studies.evaluation.models import MeasuredEvaluation, summarise_evaluation
from visuohaptic.tables.phases import owners_of


def evaluation_figures(measured: MeasuredEvaluation, intervals: IntervalParameters) -> Row:
    """Sum up a model's answers for objects that it has not learnt: a ``sentence``, and ``rows`` by strategy and number of views."""
    rows = rows_of(summarise_evaluation(measured.table, intervals))
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


def odd_sentence(figures: Row) -> str:
    """Say what the kept model answers for the odd objects; empty where this run measured other objects."""
    source = figures["source"]
    if source is None:
        return ""
    row = max(
        (row for row in figures["rows"] if row["strategy"] == "fixation"),
        key=lambda one: int(one["views"]),
    )
    return (
        f"Measured on {source.date}: of {figures['objects']} untypical objects of the same classes (set odd) pipeline "
        f"order_free classifies {percent(row['accuracy'].mean, 0)} correctly from {counted(row['views'], 'view')}. Its "
        f"prediction sets are made to contain the true class of {percent(row['stated'], 0)} of objects, and contain the "
        f"true class of {percent(row['coverage'].mean, 0)}."
    )


def _in_words(row: Row) -> str:
    return (
        f"{percent(row['accuracy'].mean)} are correctly classified by {strategy_name(row['strategy'])} of "
        f"{counted(row['views'], 'view')}, and the prediction set holds the class of "
        f"{percent(row['coverage'].mean)} ({percent(row['stated'], 0)} stated)"
    )


def rows_of(found: Sequence[Row]) -> list[Row]:
    """Make figures of the lists of mean, low and high that `sum_up_answers` gives."""
    return [
        {name: Figure(*value) if isinstance(value, list) else value for name, value in row.items()}
        for row in found
    ]
