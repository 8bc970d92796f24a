"""Write the accuracies per object that study `first_touch` measured."""

from __future__ import annotations

from typing import Any

from visuohaptic.studies.figures import Cell, CellKey, read_cells, write_json
from visuohaptic.studies.study import StepInputs

NAMES = ("looking", "turns", "draw", "known", "touches")
"""Words of a condition's name."""


def make_first_touch(step: StepInputs) -> None:
    """Write the accuracy per object of each condition, pipeline and strategy as JSON."""
    cells = read_cells(step.inputs["blocks"])
    write_json({"set": step.run.meshes.set, **arrange(cells)}, step.outputs[0])


def arrange(cells: dict[CellKey, Cell]) -> dict[str, Any]:
    """Return objects, failed conditions, and one row per cell; an object's value is None if it was not tested."""
    objects = sorted({key for cell in cells.values() for key in cell.objects})
    rows, failed = [], []
    for (condition, pipeline, strategy, classifier), cell in cells.items():
        if cell.error:
            failed.append(f"{condition}: {cell.error}")
            continue
        accuracy, weights = (
            dict(zip(cell.objects, values.tolist(), strict=True))
            for values in (cell.accuracy, cell.weights)
        )
        rows.append(
            {
                **dict(zip(NAMES, condition.split(), strict=True)),
                "pipeline": pipeline,
                "strategy": strategy,
                "classifier": classifier,
                "accuracy": [accuracy.get(key) for key in objects],
                "weights": [weights.get(key) for key in objects],
            }
        )
    return {"objects": ["/".join(key) for key in objects], "failed": failed, "cells": rows}
