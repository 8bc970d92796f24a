"""Keep the accuracies per object of study `first_touch` in this folder: ``kept_<set>.parquet``.

`python -m first_touch.keeping SET` copies ``results/first_touch.parquet``, which the study writes.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from visuohaptic.base.draws import draw_of
from visuohaptic.base.errors import ReportError
from visuohaptic.report.provenance import find_commit
from visuohaptic.studies.figures import Cell, CellKey, read_cells
from visuohaptic.studies.study import StepInputs

MEASURED = Path("results/first_touch.parquet")
KEPT = "kept_{}.parquet"


def make_first_touch(step: StepInputs) -> None:
    """Write the accuracy of each object, condition, pipeline and strategy of the study's blocks as Parquet."""
    cells = read_cells(step.inputs["blocks"])
    table = arrange(cells).replace_schema_metadata({"set": step.run.meshes.set})
    pq.write_table(table, step.outputs[0], compression="zstd")


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


def keep(name: str, measured: Path = MEASURED, folder: Path = Path(__file__).parent) -> None:
    """Copy a measured table into a folder, with the commit that measured it; raise `ReportError` for another set."""
    table = pq.read_table(measured)
    found = (table.schema.metadata or {}).get(b"set", b"").decode()
    if found != name:
        raise ReportError(f"{measured} has set {found}; set {name} is needed.")
    kept = table.replace_schema_metadata(
        {"set": name, "commit": find_commit(), "date": datetime.now(UTC).strftime("%Y-%m-%d")}
    )
    pq.write_table(kept, folder / KEPT.format(name), compression="zstd")


if __name__ == "__main__":
    keep(sys.argv[1])
