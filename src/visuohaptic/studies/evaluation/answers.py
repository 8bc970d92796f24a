"""Compute the shares of correct predictions, of covered classes, and of answers `unknown`."""

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
"""Numbers of views from which an object is classified. An object with fewer views uses all of its views."""


def sum_up_answers(
    table: pa.Table, coverage: float, intervals: IntervalParameters
) -> Iterator[tuple[dict[str, Any], pa.Table]]:
    """Summarise predictions per strategy and number of views.

    Parameters
    ----------
    table : pyarrow.Table
        One row per prediction, with columns ``strategy``, ``views``, ``class``, ``object``, ``candidates``, and the
        booleans ``known``, ``correct``, ``covered`` and ``unknown``.
    coverage : float
        The stated coverage of the prediction sets.
    intervals : IntervalParameters
        The confidence of the intervals over objects.

    Yields
    ------
    figures : dict
        Each share as mean, low and high, and ``set_size``, the mean size of the prediction sets. Shares without
        objects are left out.
    rows : pyarrow.Table
        The rows of the strategy and number of views.
    """
    for strategy in table.column("strategy").unique().to_pylist():
        for views in table.column("views").unique().to_pylist():
            rows = select(table, strategy=strategy, views=views)
            known = select(rows, known=True)
            figures: dict[str, Any] = {"strategy": strategy, "views": views, "stated": coverage}
            for name, counted, column in (
                ("accuracy", known, "correct"),
                ("coverage", known, "covered"),
                ("false_unknown", known, "unknown"),
                ("found_unknown", select(rows, known=False), "unknown"),
            ):
                if len(counted):
                    means, counts = _by_object(counted, column)
                    interval = object_interval(means, counts, intervals)
                    figures[name] = list(plain_interval(interval).values())
            figures["set_size"] = float(np.mean(known["candidates"].to_numpy()))
            yield figures, rows


def _by_object(rows: pa.Table, column: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return each object's mean of a column, and its number of rows."""
    parts = rows_by(rows, ("class", "object")).values()
    means = np.array([np.mean(part[column].to_numpy()) for part in parts])
    return means, np.array([len(part) for part in parts], dtype=np.float64)
