"""Compute each condition's accuracy, its interval, and its difference to another condition, for all studies."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from visuohaptic.base.atomic_files import atomic_write_text
from visuohaptic.evaluation.by_object import ObjectAccuracies, average_by_object
from visuohaptic.evaluation.intervals import (
    Interval,
    PairedComparison,
    compare_paired,
    holm,
    object_interval,
    plain_interval,
)
from visuohaptic.evaluation.means_over_draws import PredictionKey
from visuohaptic.evaluation.metrics import round_numbers
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.tables.schema import build_rows, read_table, write_table
from visuohaptic.tables.studies import STUDY, STUDY_FIGURES

Row = dict[str, Any]


class CellKey(NamedTuple):
    """The accuracies of a classifier in one condition of a study."""

    condition: str
    pipeline: str
    strategy: str
    classifier: str


_OMITTED = ("study", "title", "condition", "pipeline", "strategy", "classifier", "place", "seconds")
CELL = CellKey._fields
LEADER = "fixation"
"""The strategy whose lead over each other strategy is computed."""


@dataclass(frozen=True)
class Cell(ObjectAccuracies):
    """Accuracies of objects for one condition, pipeline, strategy and classifier; without objects if the condition failed.

    Attributes
    ----------
    seconds : float or None
        Processor seconds of training and testing.
    error : str or None
        Reason why the condition failed.
    """

    seconds: float | None = None
    error: str | None = None


def read_cells(parts: Iterable[str | Path]) -> dict[CellKey, Cell]:
    """Read cells from files of `tables.STUDY`. All rows of a condition must be in the same file."""
    tables = (read_table(STUDY, part) for part in parts)
    return {key: cell for table in tables for key, cell in cells_of(table).items()}


def cells_of(rows: pa.Table) -> dict[CellKey, Cell]:
    """Average each object's accuracy over splits, from rows of `tables.STUDY`."""
    return {CellKey(*key): _cell(part) for key, part in rows_by(rows, CELL).items()}


def predicted_cells(predictions: pa.Table) -> dict[PredictionKey, Cell]:
    """Average each object's accuracy over splits, from rows of `tables.PREDICTIONS`.

    Each viewpoint counts as one recognition, as in rows of `tables.STUDY` with one vote.
    """
    is_right = pc.equal(predictions.column("predicted"), predictions.column("class"))
    rows = predictions.append_column("right", pc.cast(is_right, pa.float64()))
    tested = (*PredictionKey._fields, "class", "object", "split", "seed")
    means = rows.group_by(list(tested), use_threads=False).aggregate([("right", "mean")])
    means = means.rename_columns({"seed": "repeat", "right_mean": "accuracy"})
    means = means.append_column("sequences", pa.array(np.ones(means.num_rows)))
    return {
        PredictionKey(*key): _averaged(part)
        for key, part in rows_by(means, PredictionKey._fields).items()
    }


def rows_by(rows: pa.Table, names: Sequence[str]) -> dict[tuple[Any, ...], pa.Table]:
    """Group rows by the values of the named columns, in the order of the first row of each group."""
    columns = [rows.column(name).to_pylist() for name in names]
    indices: dict[tuple[Any, ...], list[int]] = {}
    for index, key in enumerate(zip(*columns, strict=True)):
        indices.setdefault(key, []).append(index)
    return {key: rows.take(chosen) for key, chosen in indices.items()}


def condition_interval(cell: Cell, intervals: IntervalParameters) -> Interval:
    """Compute a cell's mean accuracy and its interval over objects."""
    return object_interval(cell.accuracy, cell.weights, intervals)


def study_figures(
    study: Mapping[str, Any],
    cells: Mapping[CellKey, Cell],
    intervals: IntervalParameters,
) -> pa.Table:
    """Summarise a study.

    Parameters
    ----------
    study : mapping
        The study as `conditions.describe_study` returns it.
    cells : mapping of CellKey to Cell
        The measured accuracies.
    intervals : IntervalParameters
        Confidence and number of permutations.

    Returns
    -------
    pyarrow.Table
        `tables.STUDY_FIGURES`. Cells with different objects are not compared. Column ``lead`` is the accuracy of
        `LEADER` minus the accuracy of the row's strategy in the same condition.
    """
    conditions = study["conditions"]
    order = {condition["name"]: place for place, condition in enumerate(conditions)}
    rows: list[Row] = []
    for key in sorted(cells, key=lambda key: (key[1:], order[key.condition])):
        condition = conditions[order[key.condition]]
        other = condition["compared_with"] or conditions[0]["name"]
        leader = cells.get(key._replace(strategy=LEADER))
        rows.append(
            {
                "study": study["name"],
                "title": study["title"],
                **dict(zip(CELL, key, strict=True)),
                "place": order[key.condition],
                "recomputed": condition["recomputed"],
                "compared_with": None if other == key.condition else other,
                **_figures(cells[key], cells.get(key._replace(condition=other)), intervals),
                **paired_with_classes("lead", "lead_p", compare(leader, cells[key], intervals)),
            }
        )
    _adjust(rows)
    return build_rows(STUDY_FIGURES, rows)


def make_study_figures(
    study: Mapping[str, Any],
    parts: Sequence[str | Path],
    output: str | Path,
    metrics: str | Path,
    intervals: IntervalParameters,
) -> None:
    """Write `tables.STUDY_FIGURES` of a study, and the same numbers without seconds as JSON."""
    table = study_figures(study, read_cells(parts), intervals)
    write_table(STUDY_FIGURES, table, output)
    write_json(
        nested(table.to_pylist(), ("pipeline", "strategy", "classifier", "condition")), metrics
    )


def nested(rows: Sequence[Row], keys: Sequence[str]) -> dict[str, Any]:
    """Nest rows by the values of `keys`, without the identifying columns and seconds."""
    figures: Row = {}
    for row in rows:
        inner = figures
        for key in keys:
            inner = inner.setdefault(row[key], {})
        inner |= {name: value for name, value in row.items() if name not in _OMITTED}
    return figures


def write_json(figures: object, path: str | Path) -> None:
    """Write rounded figures as JSON; equal tables give equal bytes."""
    text = json.dumps(round_numbers(figures), indent=2, ensure_ascii=False) + "\n"
    atomic_write_text(path, text)


def _cell(rows: pa.Table) -> Cell:
    error = rows.column("error")[0].as_py()
    if error is not None:
        return Cell((), np.empty(0), np.empty(0), None, error)
    return replace(_averaged(rows), seconds=rows.column("seconds")[0].as_py())


def _averaged(rows: pa.Table) -> Cell:
    found, _ = average_by_object(rows)
    return Cell(found.objects, found.accuracy, found.weights)


def _figures(cell: Cell, other: Cell | None, intervals: IntervalParameters) -> Row:
    row: Row = {"seconds": cell.seconds, "error": cell.error, "objects": len(cell.objects) or None}
    row |= dict.fromkeys(("accuracy", "low", "high", "adjusted_p"))
    if cell.error is None:
        row |= ends("accuracy", "", condition_interval(cell, intervals))
    return row | paired_with_classes("difference", "p_value", compare(cell, other, intervals))


def paired_with_classes(name: str, p_value: str, comparison: PairedComparison | None) -> Row:
    """Return the columns of `paired`, and those of its interval and p value of new classes."""
    wide = comparison.difference_new_classes if comparison else None
    low, high = list(ends(name, "", wide).values())[1:]
    columns = {f"{name}_new_classes_low": low, f"{name}_new_classes_high": high}
    chance = None
    if comparison and not math.isnan(comparison.p_value_new_classes):
        chance = comparison.p_value_new_classes
    return paired(name, p_value, comparison) | columns | {f"{p_value}_new_classes": chance}


def paired(name: str, p_value: str, comparison: PairedComparison | None) -> Row:
    """Return the columns of a paired difference and its p value; without a comparison all are None."""
    if comparison is None:
        return {**ends(name, f"{name}_", None), p_value: None}
    return {**ends(name, f"{name}_", comparison.difference), p_value: comparison.p_value}


def compare(
    cell: Cell | None,
    other: Cell | None,
    intervals: IntervalParameters,
) -> PairedComparison | None:
    """Compare two cells, paired over objects. Returns None for a missing cell, equal cells, or other objects."""
    if cell is None or other is None or other is cell:
        return None
    if not cell.objects or other.objects != cell.objects:
        return None
    classes = [category for category, _ in cell.objects]
    return compare_paired(cell.accuracy, other.accuracy, other.weights, intervals, classes)


def ends(name: str, prefix: str, interval: Interval | None) -> Row:
    """Return columns: the mean as `name`, the ends as `prefix` + low and high; missing values and NaN become None."""
    values = plain_interval(interval).values() if interval else (None, None, None)
    return dict(zip((name, f"{prefix}low", f"{prefix}high"), values, strict=True))


def _adjust(rows: Sequence[Row]) -> None:
    """Set Holm's ``adjusted_p`` per pipeline, strategy and classifier, which are contiguous rows."""
    for _, of_cell in groupby(rows, key=itemgetter(*CELL[1:])):
        compared = [row for row in of_cell if row["p_value"] is not None]
        for row, value in zip(compared, holm([row["p_value"] for row in compared]), strict=True):
            row["adjusted_p"] = value
