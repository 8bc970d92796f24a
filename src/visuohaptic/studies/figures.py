"""Each condition's accuracy with its interval, and what it gains or loses; the same for all studies."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray

from visuohaptic.base.atomic_files import atomic_write_text
from visuohaptic.evaluation.by_object import average_by_object
from visuohaptic.evaluation.intervals import (
    Interval,
    PairedComparison,
    compare_paired,
    holm,
    object_interval,
    plain_interval,
)
from visuohaptic.evaluation.metrics import round_numbers
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.tables.schema import build_rows, read_table, write_table
from visuohaptic.tables.studies import STUDY, STUDY_FIGURES

Row = dict[str, Any]
CellKey = tuple[str, str, str, str]
"""Condition, pipeline, strategy and classifier."""

PredictionKey = tuple[str, str, str]
"""Pipeline, strategy and classifier."""

_OMITTED = ("study", "title", "condition", "pipeline", "strategy", "classifier", "place", "seconds")
CELL = ("condition", "pipeline", "strategy", "classifier")
LEADER = "fixation"
"""The strategy whose lead over each other one is given."""


@dataclass(frozen=True)
class Cell:
    """One condition, pipeline, strategy and classifier: o objects, pairs of class and name, sorted.

    There is none where it could not be run, for the reason in `error`. The mean of `accuracy` (o,) by
    `weights` (o,) is the mean over splits. `seconds` are those of training and testing.
    """

    objects: tuple[tuple[str, str], ...]
    accuracy: NDArray[np.float64]
    weights: NDArray[np.float64]
    seconds: float | None = None
    error: str | None = None


def read_cells(parts: Iterable[str | Path]) -> dict[CellKey, Cell]:
    """Read cells from files of `tables.STUDY`; each file holds all rows of its conditions."""
    tables = (read_table(STUDY, part) for part in parts)
    return {key: cell for table in tables for key, cell in cells_of(table).items()}


def cells_of(rows: pa.Table) -> dict[CellKey, Cell]:
    """Average each object's accuracy over the splits that tested it: rows of `tables.STUDY`."""
    return {key: _cell(part) for key, part in rows_by(rows, CELL).items()}


def predicted_cells(predictions: pa.Table) -> dict[PredictionKey, Cell]:
    """Average each object's accuracy over the splits that tested it: rows of `tables.PREDICTIONS`.

    Each viewpoint is one recognition of the object, as in rows of `tables.STUDY` with one vote.
    """
    is_right = pc.equal(predictions.column("predicted"), predictions.column("class"))
    rows = predictions.append_column("right", pc.cast(is_right, pa.float64()))
    tested = (*CELL[1:], "class", "object", "split", "seed")
    means = rows.group_by(list(tested), use_threads=False).aggregate([("right", "mean")])
    means = means.rename_columns({"seed": "repeat", "right_mean": "accuracy"})
    means = means.append_column("sequences", pa.array(np.ones(means.num_rows)))
    return {
        key: average_objects(part, "sequences")[0] for key, part in rows_by(means, CELL[1:]).items()
    }


def rows_by(rows: pa.Table, names: Sequence[str]) -> dict[tuple[Any, ...], pa.Table]:
    """Return the rows of each combination of values of some columns."""
    columns = [rows.column(name).to_pylist() for name in names]
    places: dict[tuple[Any, ...], list[int]] = {}
    for place, key in enumerate(zip(*columns, strict=True)):
        places.setdefault(key, []).append(place)
    return {key: rows.take(chosen) for key, chosen in places.items()}


def condition_interval(cell: Cell, intervals: IntervalParameters) -> Interval:
    """Compute a cell's mean accuracy and its interval over objects."""
    return object_interval(cell.accuracy, cell.weights, intervals)


def study_figures(
    study: Mapping[str, Any],
    cells: Mapping[CellKey, Cell],
    intervals: IntervalParameters,
) -> pa.Table:
    """Sum up a study, as `conditions.describe_study` gives it: `tables.STUDY_FIGURES`.

    What was tested on other objects is not compared. A row of another strategy than `LEADER` says how
    far that one is ahead in the same condition.
    """
    conditions = study["conditions"]
    order = {condition["name"]: place for place, condition in enumerate(conditions)}
    rows: list[Row] = []
    for key in sorted(cells, key=lambda key: (key[1:], order[key[0]])):
        condition = conditions[order[key[0]]]
        other = condition["compared_with"] or conditions[0]["name"]
        leader = cells.get((key[0], key[1], LEADER, key[3]))
        rows.append(
            {
                "study": study["name"],
                "title": study["title"],
                **dict(zip(CELL, key, strict=True)),
                "place": order[key[0]],
                "recomputed": condition["recomputed"],
                "compared_with": None if other == key[0] else other,
                **_figures(cells[key], cells.get((other, *key[1:])), intervals),
                **paired("lead", "lead_p", compare(leader, cells[key], intervals)),
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
    """Nest rows by some of their columns; what identifies a row and seconds are left out."""
    figures: Row = {}
    for row in rows:
        inner = figures
        for key in keys:
            inner = inner.setdefault(row[key], {})
        inner |= {name: value for name, value in row.items() if name not in _OMITTED}
    return figures


def write_json(figures: object, path: str | Path) -> None:
    """Write figures, rounded, so that the same tables give the same bytes."""
    text = json.dumps(round_numbers(figures), indent=2, ensure_ascii=False) + "\n"
    atomic_write_text(path, text)


def _cell(rows: pa.Table) -> Cell:
    error = rows.column("error")[0].as_py()
    if error is not None:
        return Cell((), np.empty(0), np.empty(0), None, error)
    cell, _ = average_objects(rows, "sequences")
    return replace(cell, seconds=rows.column("seconds")[0].as_py())


def average_objects(rows: pa.Table, counted: str) -> tuple[Cell, NDArray[np.float64]]:
    """Average each object's `accuracy` over the splits and repeats that tested it; also each row's share of its split."""
    found = average_by_object(rows, counted)
    return Cell(found.objects, found.accuracy, found.weights), found.share


def _figures(cell: Cell, other: Cell | None, intervals: IntervalParameters) -> Row:
    row: Row = {"seconds": cell.seconds, "error": cell.error, "objects": len(cell.objects) or None}
    row |= dict.fromkeys(("accuracy", "low", "high", "adjusted_p"))
    if cell.error is None:
        row |= ends("accuracy", "", condition_interval(cell, intervals))
    return row | paired("difference", "p_value", compare(cell, other, intervals))


def paired(name: str, p_value: str, found: PairedComparison | None) -> Row:
    """Return a difference in pairs and its p value as columns; None where cells can't be compared."""
    difference, value = (found.difference, found.p_value) if found else (None, None)
    return {**ends(name, f"{name}_", difference), p_value: value}


def compare(
    cell: Cell | None,
    other: Cell | None,
    intervals: IntervalParameters,
) -> PairedComparison | None:
    """Compare two cells in pairs; None where one is missing, they are the same, or of other objects."""
    if cell is None or other is None or other is cell:
        return None
    if not cell.objects or other.objects != cell.objects:
        return None
    return compare_paired(cell.accuracy, other.accuracy, other.weights, intervals)


def ends(name: str, prefix: str, interval: Interval | None) -> Row:
    """Return an interval's mean under a name, and its ends under a prefix; NaN and missing ends are None."""
    values = plain_interval(interval).values() if interval else (None, None, None)
    return dict(zip((name, f"{prefix}low", f"{prefix}high"), values, strict=True))


def _adjust(rows: Sequence[Row]) -> None:
    """Adjust p values for their number, in each pipeline, strategy and classifier, in which rows are neighbours."""
    for _, of_cell in groupby(rows, key=itemgetter(*CELL[1:])):
        compared = [row for row in of_cell if row["p_value"] is not None]
        for row, value in zip(compared, holm([row["p_value"] for row in compared]), strict=True):
            row["adjusted_p"] = value
