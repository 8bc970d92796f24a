"""Arrange the measured accuracies of study `first_touch`: one row per object and cell."""

from __future__ import annotations

from collections.abc import Mapping

import pyarrow as pa

from visuohaptic.base.draw_names import draw_of
from visuohaptic.base.errors import ReportError
from visuohaptic.studies.figures import Cell, CellKey, read_cells
from visuohaptic.studies.keeping import write_measured
from visuohaptic.studies.study import StepInputs


def make_first_touch(step: StepInputs) -> None:
    """Write the accuracy of each object, condition, pipeline and strategy of the study's blocks as Parquet."""
    cells = read_cells(step.inputs["blocks"])
    write_measured(arrange(cells), step.run.meshes.set, step.outputs[0])


def arrange(cells: Mapping[CellKey, Cell]) -> pa.Table:
    """Return one row per object and cell, with the words of the condition's name as columns.

    Columns ``draw`` and ``places`` are the draws of the turns and of the random places. Raises `ReportError` if a
    condition failed.
    """
    rows = []
    for (condition, pipeline, drawn, _), cell in cells.items():
        if cell.error:
            raise ReportError(f"Condition {condition} could not be measured: {cell.error}")
        looking, turns, draw, known, touches = condition.split()
        strategy, places = draw_of(drawn)
        named = {
            "looking": looking, "turns": turns, "draw": int(draw), "known": known, "touches": int(touches),
            "pipeline": pipeline, "strategy": strategy, "places": places,
        }  # fmt: skip
        objects = zip(cell.objects, cell.accuracy.tolist(), cell.weights.tolist(), strict=True)
        rows += [
            {**named, "object": "/".join(key), "accuracy": accuracy, "weight": weight}
            for key, accuracy, weight in objects
        ]
    return pa.Table.from_pylist(rows)
