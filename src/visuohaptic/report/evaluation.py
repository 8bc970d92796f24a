"""A model's predictions for objects that it was not trained on."""

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
    """Return the figures of a model's predictions for objects that it was not trained on.

    ``sentence`` describes the predictions from the largest number of views. ``rows`` has one row per strategy and
    number of views. ``objects`` and ``learnt`` are the numbers of test and training objects, and ``classes`` the number
    per class as text. ``source`` is the source of kept predictions.
    """
    rows = rows_of(summarise_evaluation(measured.table, intervals))
    # Only objects of classes that the model knows can be classified correctly.
    of_known_classes = select(measured.table, known=True)
    objects = sorted(set(owners_of(of_known_classes)))
    counts = Counter(category for category, _ in objects)
    views = max(row["views"] for row in rows)
    shares = "; ".join(_in_words(row) for row in rows if row["views"] == views)
    return {
        "sentence": f"Of {counted(len(objects), 'object')} that the model has not learnt, {shares}.",
        "rows": rows,
        "objects": len(objects),
        "learnt": of_known_classes["learnt"][0].as_py(),
        "classes": ", ".join(f"{category} ({count})" for category, count in counts.items()),
        "source": measured.source,
    }


def odd_sentence(figures: Row) -> str:
    """Return the sentence on the kept model's answers for set odd; empty if this run measured its own objects."""
    source = figures["source"]
    if source is None:
        return ""
    row = max(
        (row for row in figures["rows"] if row["strategy"] == "fixation"),
        key=lambda row: int(row["views"]),
    )
    return (
        f"Pipeline order_free classifies {percent(row['accuracy'].mean, 0)} of {figures['objects']} untypical objects of "
        f"set odd correctly from {counted(row['views'], 'view')} (measured on {source.date}). Its prediction "
        f"sets should contain the true class of {percent(row['stated'], 0)} of objects. Of these objects the sets "
        f"contain the class of {percent(row['coverage'].mean, 0)}."
    )


def _in_words(row: Row) -> str:
    return (
        f"{percent(row['accuracy'].mean)} are correctly classified by {strategy_name(row['strategy'])} of "
        f"{counted(row['views'], 'view')}, and the prediction set holds the class of "
        f"{percent(row['coverage'].mean)} ({percent(row['stated'], 0)} stated)"
    )


def rows_of(summary: Sequence[Row]) -> list[Row]:
    """Return rows with each list of mean, low and high as a `Figure`; other values are unchanged."""
    return [
        {name: Figure(*value) if isinstance(value, list) else value for name, value in row.items()}
        for row in summary
    ]
