"""Keep accuracies per turned object in the library: ``src/visuohaptic/report/turned.json``.

`python -m turned.keeping SET` copies the accuracies of ``reports/turned.json``, which study `turned` writes.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import classifier_settings
import visuohaptic.report
from turned.study import LITERAL
from visuohaptic.base.atomic_files import atomic_write_text
from visuohaptic.base.errors import ReportError
from visuohaptic.io.checkout import find_commit
from visuohaptic.report.estimates import read_json
from visuohaptic.report.turned import KEPT, TurnedCell, TurnedSet, read_turned
from visuohaptic.studies.figures import Cell, CellKey, read_cells, write_json
from visuohaptic.studies.study import StepInputs

MEASURED = Path("reports/turned.json")
NAMES = ("turns", "known", "touches", "pipeline", "strategy", "classifier")
"""Columns that name a kept cell."""
CHOSEN = Path(classifier_settings.__file__).with_name("chosen.json")
"""The file with the objects on which descriptors and settings were chosen."""
KEPT_FILE = Path(visuohaptic.report.__file__).with_name(KEPT)


def make_turned(step: StepInputs) -> None:
    """Write the mean accuracy per object over the draws of the turns as JSON."""
    cells = read_cells(step.inputs["blocks"])
    write_json({"set": step.run.meshes.set, **means_over_draws(cells)}, step.outputs[0])


def means_over_draws(cells: Mapping[CellKey, Cell]) -> dict[str, Any]:
    """Arrange the cells of study `turned` as fields of `TurnedSet`.

    An object's accuracy is the mean over the draws that tested the object. ``failed`` lists failed conditions with
    their errors.
    """
    failed = [f"{key[0]}: {cell.error}" for key, cell in cells.items() if cell.error]
    objects = sorted({key for cell in cells.values() for key in cell.objects})
    drawn: dict[tuple[object, ...], list[dict[Any, tuple[float, float]]]] = {}
    for (condition, pipeline, strategy, classifier), cell in cells.items():
        if cell.error:
            continue
        values = zip(cell.accuracy.tolist(), cell.weights.tolist(), strict=True)
        turns, _, known, touches = condition.split()
        variant = (LITERAL, "full") if known == LITERAL else (pipeline, known)
        key = (turns, variant[1], int(touches), variant[0], strategy, classifier)
        drawn.setdefault(key, []).append(dict(zip(cell.objects, values, strict=True)))
    kept = []
    for names, draws in drawn.items():
        accuracy, weights = zip(*(_mean(draws, key) for key in objects), strict=True)
        named = dict(zip(NAMES, names, strict=True))
        kept.append({**named, "draws": len(draws), "accuracy": accuracy, "weights": weights})
    return {"failed": failed, "objects": ["/".join(key) for key in objects], "cells": kept}


def _mean(
    draws: list[dict[Any, tuple[float, float]]], key: tuple[str, str]
) -> tuple[float | None, float | None]:
    tested = [draw[key] for draw in draws if key in draw]
    if not tested:
        return None, None
    accuracy, weights = (sum(values) / len(tested) for values in zip(*tested, strict=True))
    return accuracy, weights


def keep(name: str, measured: Path = MEASURED, kept_file: Path = KEPT_FILE) -> None:
    """Replace the accuracies of a set of objects in the kept file by measured accuracies."""
    turned = read_json(measured, dict, "holds no turned objects", "run `make turned` again")
    if turned["set"] != name:
        raise ReportError(f"{measured} has set {turned['set']}; set {name} is needed.")
    if turned["failed"]:
        raise ReportError(f"Turned objects could not be measured, {turned['failed'][0]}")
    chosen = read_json(CHOSEN, dict, "holds no objects that chose", "restore the file")["half"]
    kept = read_turned(kept_file) if kept_file.exists() else {}
    kept[name] = TurnedSet(
        commit=find_commit(),
        date=datetime.now(UTC).strftime("%Y-%m-%d"),
        objects=turned["objects"],
        choosing=tuple(sorted(set(chosen).intersection(turned["objects"]))),
        cells=tuple(TurnedCell.model_validate(cell) for cell in turned["cells"]),
    )
    sets = ",\n".join(f'"{key}": {kept[key].model_dump_json()}' for key in sorted(kept))
    atomic_write_text(kept_file, f"{{\n{sets}\n}}\n")


if __name__ == "__main__":
    keep(sys.argv[1])
