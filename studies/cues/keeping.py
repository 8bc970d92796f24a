"""Keep accuracies by cue in the library: ``src/visuohaptic/report/cues_SET.parquet``.

`python -m cues.keeping SET` copies ``results/cues.parquet``, which study `cues` writes.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

import visuohaptic.report
from visuohaptic.base.errors import ReportError
from visuohaptic.report.cues import KEPT, SCHEMA
from visuohaptic.report.provenance import find_commit
from visuohaptic.studies.figures import Cell, CellKey, read_cells
from visuohaptic.studies.study import StepInputs
from visuohaptic.tables.schema import build_rows, read_table, write_table

MEASURED = Path("results/cues.parquet")
KEPT_FOLDER = Path(visuohaptic.report.__file__).parent


def make_cues(step: StepInputs) -> None:
    """Write the accuracy per object, a mean over the draws of the turns."""
    write_table(SCHEMA, means_over_draws(read_cells(step.inputs["blocks"])), step.outputs[0])


def means_over_draws(cells: Mapping[CellKey, Cell]) -> pa.Table:
    """Arrange the cells of study `cues` as `SCHEMA`; an object's mean is over the draws that tested the object.

    Raises `ReportError` if a condition failed.
    """
    failed = [f"{key[0]}: {cell.error}" for key, cell in cells.items() if cell.error]
    if failed:
        raise ReportError(f"Accuracies by cue could not be measured, {failed[0]}")
    drawn: dict[tuple[object, ...], list[tuple[float, float]]] = {}
    for (condition, pipeline, strategy, classifier), cell in cells.items():
        tested, turns, _, frame, cues, touches = condition.split()
        for owner, *numbers in zip(
            cell.objects, cell.accuracy.tolist(), cell.weights.tolist(), strict=True
        ):
            key = (tested, turns, frame, int(touches), cues, pipeline, strategy, classifier, *owner)
            drawn.setdefault(key, []).append((numbers[0], numbers[1]))
    rows: list[dict[str, Any]] = []
    for key, values in drawn.items():
        accuracy, weight = (sum(each) / len(values) for each in zip(*values, strict=True))
        figures = {"draws": len(values), "accuracy": accuracy, "weight": weight}
        rows.append({**dict(zip(SCHEMA.keys, key, strict=True)), **figures})
    return build_rows(SCHEMA, rows)


def keep(name: str, measured: Path = MEASURED, folder: Path = KEPT_FOLDER) -> None:
    """Copy measured accuracies to the kept file of a set of objects, with commit and date (UTC)."""
    table = read_table(SCHEMA, measured)
    source = {"commit": find_commit(), "date": datetime.now(UTC).strftime("%Y-%m-%d")}
    kept = table.replace_schema_metadata({**(table.schema.metadata or {}), **source})
    pq.write_table(kept, folder / KEPT.format(name), compression="zstd")


if __name__ == "__main__":
    keep(sys.argv[1])
