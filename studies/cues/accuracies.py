"""Arrange the measured accuracies of study `cues`: one row per object and cell."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pyarrow as pa

from cues.tables import ACCURACIES
from visuohaptic.base.errors import ReportError
from visuohaptic.studies.figures import Cell, CellKey, read_cells
from visuohaptic.studies.keeping import write_measured
from visuohaptic.studies.study import StepInputs
from visuohaptic.tables.schema import build_rows


def make_cues(step: StepInputs) -> None:
    """Write the accuracy per object of the study's blocks."""
    table = accuracies_of(read_cells(step.inputs["blocks"]))
    write_measured(table, step.run.meshes.set, step.outputs[0])


def accuracies_of(cells: Mapping[CellKey, Cell]) -> pa.Table:
    """Arrange the cells of study `cues` as `ACCURACIES`. Raises `ReportError` if a condition failed."""
    rows: list[dict[str, Any]] = []
    for (condition, pipeline, strategy, classifier), cell in cells.items():
        if cell.error:
            raise ReportError(f"Accuracies by cue could not be measured, {condition}: {cell.error}")
        tested, turns, frame, cues, touches = condition.split()
        named = (tested, turns, frame, int(touches), cues, pipeline, strategy, classifier)
        numbers = zip(cell.objects, cell.accuracy.tolist(), cell.weights.tolist(), strict=True)
        for owner, accuracy, weight in numbers:
            keys = dict(zip(ACCURACIES.keys, (*named, *owner), strict=True))
            rows.append({**keys, "accuracy": accuracy, "weight": weight})
    return build_rows(ACCURACIES, rows)
