"""Compare the results of two runs, to the last bit: `python tests/golden/compare_runs.py OLD NEW`.

OLD and NEW are folders in which the workflow has run. Of each table all parts count as one, sorted by all columns, so
that it does not matter how the work was divided; columns that hold seconds, or follow from
them, are left out. Meshes are compared by object
and `reports/metrics.json` by bytes. Prints what differs, and ends with 1 if anything does.
"""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

PHASES = ("meshes", "views", "fixations", "touches", "features", "effects", "stability")
"""Tables whose parts lie below folders of blocks; of the others each file is a table."""

FROM_SECONDS = ("as_quick", "step", "group", "on_front", "dominated")
"""Columns of the tables of cost that follow from measured seconds."""


def read_tables(run: Path) -> dict[str, pa.Table]:
    """Read every table of a run, the parts of one joined."""
    parts: dict[str, list[pa.Table]] = {}
    for file in sorted((run / "results").rglob("[!.]*.parquet")):
        place = file.relative_to(run / "results").with_suffix("").parts
        depth = 2 if place[0] == "effects" else 1
        name = place[:depth] if place[0] in PHASES and len(place) > 1 else place
        parts.setdefault("/".join(name), []).append(pq.ParquetFile(file).read())
    return {name: _sorted(pa.concat_tables(tables)) for name, tables in parts.items()}


def _sorted(table: pa.Table) -> pa.Table:
    """Leave out seconds, and sort the rows by the text of all that can be sorted."""
    kept = [
        name for name in table.column_names if "seconds" not in name and name not in FROM_SECONDS
    ]
    plain = [name for name in kept if not pa.types.is_nested(table.field(name).type)]
    order = [(name, "ascending") for name in plain if table.field(name).type != pa.binary()]
    return table.select(kept).sort_by(order).combine_chunks().replace_schema_metadata(None)


def read_files(run: Path) -> dict[str, str]:
    """Give the SHA-256 of each object's mesh, and of the metrics."""
    files = {
        f"mesh {file.relative_to(run / 'results/meshes').parts[0]}/{file.stem}": file
        for file in (run / "results/meshes").rglob("*.ply")
    }
    metrics = run / "reports/metrics.json"
    files |= {"reports/metrics.json": metrics} if metrics.is_file() else {}
    return {name: hashlib.sha256(file.read_bytes()).hexdigest() for name, file in files.items()}


def differences(old: Mapping[str, Any], new: Mapping[str, Any]) -> list[str]:
    """Say of each name that is not the same in both how it differs."""
    found = [f"only in the old run: {name}" for name in sorted(old.keys() - new.keys())]
    found += [f"only in the new run: {name}" for name in sorted(new.keys() - old.keys())]
    shared = sorted(old.keys() & new.keys())
    return found + [f"not equal: {name}" for name in shared if old[name] != new[name]]


def main(old: str, new: str) -> int:
    """Print what differs, and give the exit status."""
    before, after = ({**read_tables(run), **read_files(run)} for run in (Path(old), Path(new)))
    found = differences(before, after)
    sys.stdout.write("\n".join(found) or f"equal: {len(before)} tables, meshes and metrics")
    sys.stdout.write("\n")
    return 1 if found or not before else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
