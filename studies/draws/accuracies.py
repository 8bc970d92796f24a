"""Arrange the measured accuracies of study `draws`: one row per object and draw."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pyarrow as pa

from draws.tables import DRAWS
from visuohaptic.base.draw_names import draw_of
from visuohaptic.base.errors import ReportError
from visuohaptic.studies.figures import Cell, CellKey, read_cells
from visuohaptic.studies.keeping import write_measured
from visuohaptic.studies.study import StepInputs
from visuohaptic.tables.schema import build_rows


def make_draws(step: StepInputs) -> None:
    """Write `DRAWS` from the study's blocks."""
    write_measured(arrange(read_cells(step.inputs["blocks"])), step.run.meshes.set, step.outputs[0])


def arrange(cells: Mapping[CellKey, Cell]) -> pa.Table:
    """Arrange the cells of study `draws` as `DRAWS`.

    An object has the same weight in all draws: that by fixation. Objects that fixation did not test are left out.
    Raises `ReportError` if a condition failed.
    """
    rows: list[dict[str, Any]] = []
    weights: dict[str, dict[tuple[str, str], float]] = {}
    for (condition, pipeline, strategy, _), cell in cells.items():
        if cell.error:
            raise ReportError(f"Draws could not be measured, {strategy}: {cell.error}")
        if strategy == "fixation":
            of_objects = dict(zip(cell.objects, cell.weights.tolist(), strict=True))
            weights[_pipeline(condition, pipeline)] = of_objects
    for (condition, pipeline, drawn, classifier), cell in cells.items():
        strategy, draw = draw_of(drawn)
        name = _pipeline(condition, pipeline)
        cell_keys = {
            "pipeline": name, "strategy": strategy, "classifier": classifier, "draw": draw,
        }  # fmt: skip
        for owner, accuracy in zip(cell.objects, cell.accuracy.tolist(), strict=True):
            if owner in weights.get(name, {}):
                keys = cell_keys | dict(zip(("class", "object"), owner, strict=True))
                rows.append({**keys, "accuracy": accuracy, "weight": weights[name][owner]})
    return build_rows(DRAWS, rows)


def _pipeline(condition: str, pipeline: str) -> str:
    """Return the pipeline, or ``literal`` in a condition of the most literal variant of the paper."""
    return "literal" if condition.startswith("literal") else pipeline
