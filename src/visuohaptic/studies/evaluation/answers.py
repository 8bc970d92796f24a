"""Shares of answers that are right, that are covered by their prediction set, and that say `unknown`."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.evaluation.intervals import object_interval, plain_interval
from visuohaptic.evaluation.summary import select
from visuohaptic.studies.figures import rows_by

if TYPE_CHECKING:
    from visuohaptic.recognition.parameters import IntervalParameters

VIEWS = (1, 4, 16)
"""Numbers of views from which objects are classified, as far as they have them."""


def sum_up_answers(
    table: pa.Table, coverage: float, intervals: IntervalParameters
) -> Iterator[tuple[dict[str, Any], pa.Table]]:
    """Return per strategy and number of views: shares with intervals over objects, the sets' mean size, and the rows.

    Any table will do that says of each answer whether the object's class is `known`, and whether the
    answer is `correct`, `covered` and `unknown`. What there are no objects for is left out.
    """
    for strategy in table.column("strategy").unique().to_pylist():
        for views in table.column("views").unique().to_pylist():
            rows = select(table, strategy=strategy, views=views)
            known = select(rows, known=True)
            figures: dict[str, Any] = {"strategy": strategy, "views": views, "stated": coverage}
            for name, of, column in (
                ("accuracy", known, "correct"),
                ("coverage", known, "covered"),
                ("false_unknown", known, "unknown"),
                ("found_unknown", select(rows, known=False), "unknown"),
            ):
                if len(of):
                    means, counts = _by_object(of, column)
                    interval = object_interval(means, counts, intervals)
                    figures[name] = list(plain_interval(interval).values())
            figures["set_size"] = float(np.mean(known["candidates"].to_numpy()))
            yield figures, rows


def _by_object(rows: pa.Table, column: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return each object's mean of a column, and how often the object was tested."""
    parts = rows_by(rows, ("class", "object")).values()
    means = np.array([np.mean(part[column].to_numpy()) for part in parts])
    return means, np.array([len(part) for part in parts], dtype=np.float64)
