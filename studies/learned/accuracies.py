"""Arrange the measured accuracies of study `learned`: one row per object and cell."""

from __future__ import annotations

from collections.abc import Mapping

import pyarrow as pa

from visuohaptic.base.errors import ReportError
from visuohaptic.studies.figures import Cell, CellKey, read_cells
from visuohaptic.studies.keeping import write_measured
from visuohaptic.studies.study import StepInputs


def make_learned(step: StepInputs) -> None:
    """Write the accuracy of each object, condition, pipeline and strategy of the study's blocks as Parquet."""
    table = arrange(read_cells(step.inputs["blocks"]))
    write_measured(table, step.run.meshes.set, step.outputs[0])


def arrange(cells: Mapping[CellKey, Cell]) -> pa.Table:
    """Return one row per object and cell, with turns, frame, touches and views. Raises `ReportError` if a condition failed."""
    rows = []
    for (condition, pipeline, strategy, _), cell in cells.items():
        if cell.error:
            raise ReportError(f"Condition {condition} could not be measured: {cell.error}")
        turns, frame, touches, views = condition.split()
        named = {
            "turns": turns,
            "frame": frame,
            "touches": int(touches),
            "views": int(views),
            "pipeline": pipeline,
            "strategy": strategy,
        }
        objects = zip(cell.objects, cell.accuracy.tolist(), cell.weights.tolist(), strict=True)
        rows += [
            {**named, "object": "/".join(key), "accuracy": accuracy, "weight": weight}
            for key, accuracy, weight in objects
        ]
    return pa.Table.from_pylist(rows)
