"""Arrange the measured accuracies of study `turned`: one row per object and cell, means over draws of the turns."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pyarrow as pa

from classifier_settings.half import choosing_objects
from turned.study import LITERAL
from turned.tables import TURNED
from visuohaptic.studies.figures import Cell, CellKey, read_cells
from visuohaptic.studies.keeping import write_measured
from visuohaptic.studies.study import StepInputs
from visuohaptic.tables.schema import build_rows

_CELL = ("turns", "known", "touches", "pipeline", "strategy", "classifier")
_Draw = Mapping[tuple[str, str], tuple[float, float]]
"""Accuracy and weight by object."""


def make_turned(step: StepInputs) -> None:
    """Write `TURNED` from the study's blocks, without the conditions that could not be measured."""
    cells = read_cells(step.inputs["blocks"])
    failed = [f"{key.condition}: {cell.error}" for key, cell in cells.items() if cell.error]
    table = means_over_draws(cells, choosing_objects())
    write_measured(table, step.run.meshes.set, step.outputs[0], next(iter(failed), ""))


def means_over_draws(cells: Mapping[CellKey, Cell], choosing: frozenset[str]) -> pa.Table:
    """Arrange the cells of study `turned` as `TURNED`.

    An object's accuracy is the mean over the draws that tested the object. The objects in `choosing`, ``class/name``,
    are not held out. Conditions that could not be measured are left out.
    """
    drawn: dict[tuple[object, ...], list[_Draw]] = {}
    for (condition, pipeline, strategy, classifier), cell in cells.items():
        if cell.error:
            continue
        values = zip(cell.accuracy.tolist(), cell.weights.tolist(), strict=True)
        turns, _, known, touches = condition.split()
        variant = (LITERAL, "full") if known == LITERAL else (pipeline, known)
        key = (turns, variant[1], int(touches), variant[0], strategy, classifier)
        drawn.setdefault(key, []).append(dict(zip(cell.objects, values, strict=True)))
    return build_rows(
        TURNED,
        [
            dict(zip(_CELL, key, strict=True)) | {"draws": len(draws)} | row
            for key, draws in drawn.items()
            for row in _rows(draws, choosing)
        ],
    )


def _rows(draws: list[_Draw], choosing: frozenset[str]) -> list[dict[str, Any]]:
    """Return the means of each object over the draws that tested it."""
    rows = []
    for category, name in dict.fromkeys(owner for draw in draws for owner in draw):
        tested = [draw[category, name] for draw in draws if (category, name) in draw]
        accuracy, weight = (sum(values) / len(tested) for values in zip(*tested, strict=True))
        is_held_out = f"{category}/{name}" not in choosing
        rows.append(
            {
                "class": category,
                "object": name,
                "accuracy": accuracy,
                "weight": weight,
                "held_out": is_held_out,
            }
        )
    return rows
