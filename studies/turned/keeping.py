"""Accuracies per object of turned objects, which the library keeps: ``src/visuohaptic/report/turned.json``.

`python -m turned.keeping SET` puts the accuracies of ``reports/turned.json``, which study `turned` writes, into the
package.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import classifier_settings
import visuohaptic.report
from visuohaptic.base.atomic_files import atomic_write_text
from visuohaptic.base.errors import ReportError
from visuohaptic.report.estimates import read_json
from visuohaptic.report.provenance import find_commit
from visuohaptic.report.turned import KEPT, TurnedCell, TurnedSet, read_turned
from visuohaptic.studies.figures import Cell, CellKey, read_cells, write_json
from visuohaptic.studies.study import StepInputs

MEASURED = Path("reports/turned.json")
NAMES = ("turns", "known", "touches", "pipeline", "strategy", "classifier")
"""Columns that name a kept cell."""
CHOSEN = Path(classifier_settings.__file__).with_name("chosen.json")
"""Holds the half of the objects on which descriptors and settings were chosen."""
PLACE = Path(visuohaptic.report.__file__).with_name(KEPT)


def make_turned(step: StepInputs) -> None:
    """Write the mean accuracy per object over the draws of the turns as JSON."""
    cells = read_cells(step.inputs["blocks"])
    write_json({"set": step.run.meshes.set, **means_over_draws(cells)}, step.outputs[0])


def means_over_draws(cells: Mapping[CellKey, Cell]) -> dict[str, Any]:
    """Arrange the cells of study `turned` as `TurnedSet` has them, and name the conditions that `failed`, with the reason.

    An object's accuracy is the mean over the draws that tested the object.
    """
    failed = [f"{condition}: {one.error}" for (condition, *_), one in cells.items() if one.error]
    objects = sorted({key for cell in cells.values() for key in cell.objects})
    drawn: dict[tuple[object, ...], list[dict[Any, tuple[float, float]]]] = {}
    for (condition, pipeline, strategy, classifier), cell in cells.items():
        if cell.error:
            continue
        values = zip(cell.accuracy.tolist(), cell.weights.tolist(), strict=True)
        turns, _, known, touches = condition.split()
        key = (turns, known, int(touches), pipeline, strategy, classifier)
        drawn.setdefault(key, []).append(dict(zip(cell.objects, values, strict=True)))
    found = []
    for names, draws in drawn.items():
        accuracy, weights = zip(*(_mean(draws, one) for one in objects), strict=True)
        named = dict(zip(NAMES, names, strict=True))
        found.append({**named, "draws": len(draws), "accuracy": accuracy, "weights": weights})
    return {"failed": failed, "objects": ["/".join(key) for key in objects], "cells": found}


def _mean(
    draws: list[dict[Any, tuple[float, float]]], key: tuple[str, str]
) -> tuple[float | None, float | None]:
    found = [draw[key] for draw in draws if key in draw]
    if not found:
        return None, None
    accuracy, weights = (sum(values) / len(found) for values in zip(*found, strict=True))
    return accuracy, weights


def keep(name: str, measured: Path = MEASURED, place: Path = PLACE) -> None:
    """Put the measured accuracies of a set of objects into the kept file, in the place of earlier ones."""
    found = read_json(measured, dict, "holds no turned objects", "run `make turned` again")
    if found["set"] != name:
        raise ReportError(f"{measured} has set {found['set']}; set {name} is needed.")
    if found["failed"]:
        raise ReportError(f"Turned objects could not be measured, {found['failed'][0]}")
    chosen = read_json(CHOSEN, dict, "holds no objects that chose", "restore the file")["half"]
    kept = read_turned(place) if place.exists() else {}
    kept[name] = TurnedSet(
        commit=find_commit(),
        date=datetime.now(UTC).strftime("%Y-%m-%d"),
        objects=found["objects"],
        choosing=tuple(sorted(set(chosen).intersection(found["objects"]))),
        cells=tuple(TurnedCell.model_validate(one) for one in found["cells"]),
    )
    sets = ",\n".join(f'"{one}": {kept[one].model_dump_json()}' for one in sorted(kept))
    atomic_write_text(place, f"{{\n{sets}\n}}\n")


if __name__ == "__main__":
    keep(sys.argv[1])
