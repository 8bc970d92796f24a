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
from visuohaptic.io.checkout import find_commit
from visuohaptic.report.cues import KEPT, SCHEMA
from visuohaptic.studies.figures import Cell, CellKey, read_cells
from visuohaptic.studies.study import StepInputs
from visuohaptic.tables.schema import build_rows, read_table, write_table

MEASURED = Path("results/cues.parquet")
KEPT_FOLDER = Path(visuohaptic.report.__file__).parent


def make_cues(step: StepInputs) -> None:
    """Write the accuracy per object of the study's blocks."""
    write_table(SCHEMA, accuracies_of(read_cells(step.inputs["blocks"])), step.outputs[0])


def accuracies_of(cells: Mapping[CellKey, Cell]) -> pa.Table:
    """Arrange the cells of study `cues` as `SCHEMA`. Raises `ReportError` if a condition failed."""
    rows: list[dict[str, Any]] = []
    for (condition, pipeline, strategy, classifier), cell in cells.items():
        if cell.error:
            raise ReportError(f"Accuracies by cue could not be measured, {condition}: {cell.error}")
        tested, turns, frame, cues, touches = condition.split()
        named = (tested, turns, frame, int(touches), cues, pipeline, strategy, classifier)
        numbers = zip(cell.objects, cell.accuracy.tolist(), cell.weights.tolist(), strict=True)
        for owner, accuracy, weight in numbers:
            keys = dict(zip(SCHEMA.keys, (*named, *owner), strict=True))
            rows.append({**keys, "accuracy": accuracy, "weight": weight})
    return build_rows(SCHEMA, rows)


def keep(name: str, measured: Path = MEASURED, folder: Path = KEPT_FOLDER) -> None:
    """Copy measured accuracies to the kept file of a set of objects, with commit and date (UTC)."""
    table = read_table(SCHEMA, measured)
    source = {"commit": find_commit(), "date": datetime.now(UTC).strftime("%Y-%m-%d")}
    kept = table.replace_schema_metadata({**(table.schema.metadata or {}), **source})
    pq.write_table(kept, folder / KEPT.format(name), compression="zstd")


if __name__ == "__main__":
    keep(sys.argv[1])
