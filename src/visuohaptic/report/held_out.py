"""A model's predictions for held-out objects: objects that it was not trained on."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import pyarrow as pa

from visuohaptic.evaluation.held_out import summarise_evaluation
from visuohaptic.evaluation.summary import select
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.estimates import Estimate, Row
from visuohaptic.report.wording import counted, percent, strategy_name
from visuohaptic.tables.phases import owners_of


def held_out_figures(table: pa.Table, intervals: IntervalParameters) -> Row:
    """Return the figures of rows of `tables.EVALUATION`.

    ``sentence`` describes the predictions from the largest number of views. ``rows`` has one row per strategy and
    number of views. ``objects`` and ``learnt`` are the numbers of test and training objects, and ``classes`` the number
    per class as text.
    """
    rows = rows_of(summarise_evaluation(table, intervals))
    # Only objects of classes that the model knows can be classified correctly.
    of_known_classes = select(table, known=True)
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
    }


def _in_words(row: Row) -> str:
    return (
        f"{percent(row['accuracy'].mean)} are correctly classified by {strategy_name(row['strategy'])} of "
        f"{counted(row['views'], 'view')}, and the prediction set holds the class of "
        f"{percent(row['coverage'].mean)} ({percent(row['stated'], 0)} stated)"
    )


def rows_of(summary: Sequence[Row]) -> list[Row]:
    """Return rows with each list of mean, low and high as an `Estimate`; other values are unchanged."""
    return [
        {
            name: Estimate(*value) if isinstance(value, list) else value
            for name, value in row.items()
        }
        for row in summary
    ]
