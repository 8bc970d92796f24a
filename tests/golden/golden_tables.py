"""What the tables of a run hold, and whether another run holds the same.

    python tests/golden/golden_tables.py compare    # the run in results/ and reports/ with the kept one
    python tests/golden/golden_tables.py keep       # keep this one, after a change that moves figures
    python tests/golden/golden_tables.py compare NEW OLD    # two runs, by their folders

Of every table, rows are sorted by their keys and each column has a digest, so a comparison names the
columns that differ. Seconds, and what follows from them, differ from run to run and are left out. Column
`probability` of the predictions depends on the processor in its last digits (docs/stability.md).
"""

from __future__ import annotations

import hashlib
import json
import sys
from collections.abc import Iterator
from pathlib import Path

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

KEPT = Path(__file__).with_name("paper_set.json")
METRICS = (
    "metrics.json",
    "studies/ablations.json",
    "studies/claims.json",
    "studies/touch_curves.json",
)
"""Under reports/; those of studies where they were made."""

OF_SECONDS = {
    "cost": {"as_quick", "on_front", "dominated", "step", "quicker"},
    "cost_seconds": {"object", "turn"},
}
"""Columns that follow from run times, by table."""

Digests = dict[str, dict[str, str]]


def digest_run(folder: Path) -> Digests:
    """Give the digest of every column of every table of a run, and of its metrics."""
    found: Digests = {}
    for name, table in sorted(read_tables(folder / "results").items()):
        timed = OF_SECONDS.get(name.rpartition(" ")[2], set())
        kept = [
            column
            for column in table.column_names
            if column not in timed and not column.startswith("seconds")
        ]
        found[name] = {"rows": str(table.num_rows)}
        found[name] |= {column: digest(table.column(column)) for column in kept}
    for path in sorted((folder / "results" / "meshes").rglob("*.ply")):
        name = f"{path.parent.name}/{path.stem}"
        found[f"mesh {name}"] = {"bytes": hashlib.sha256(path.read_bytes()).hexdigest()}
    for name in METRICS:
        path = folder / "reports" / name
        if path.is_file():
            found[f"reports/{name}"] = {"bytes": hashlib.sha256(_figures(path)).hexdigest()}
    return found


def _figures(path: Path) -> bytes:
    """Read a file of figures without its parameters and its words on the method: the same figures may have others."""
    held = json.loads(path.read_bytes())
    held.pop("method", None)
    if held.pop("parameters", None) is None:
        return path.read_bytes()
    return (json.dumps(held, indent=2, sort_keys=True) + "\n").encode()


def read_tables(results: Path) -> dict[str, pa.Table]:
    """Read the tables of a folder by their place and name, rows in an order of their own."""
    parts: dict[str, list[pa.Table]] = {}
    for path in sorted(results.rglob("*.parquet")):
        part = pq.read_table(path, partitioning=None)
        inside = path.relative_to(results).parts
        # What a study's conditions share goes by keys that are no part of the result.
        place = "/".join(inside[:2]) if inside[0].startswith("study") else inside[0]
        schema = (part.schema.metadata or {}).get(b"table", b"?").decode()
        parts.setdefault(f"{place} {schema}", []).append(part.replace_schema_metadata())
    return {name: in_order(pa.concat_tables(found)) for name, found in parts.items()}


def in_order(table: pa.Table) -> pa.Table:
    """Sort rows by all columns that hold text or whole numbers: among them are the keys."""
    names = [
        field.name
        for field in table.schema
        if pa.types.is_string(field.type) or pa.types.is_integer(field.type)
    ]
    return table.sort_by([(name, "ascending") for name in names]) if names else table


def digest(column: pa.ChunkedArray) -> str:
    """Give the digest of a column's values, missing ones and lists included."""
    found = hashlib.sha256(str(column.type).encode())
    for part in _flat(column.combine_chunks()):
        found.update(part)
    return found.hexdigest()[:16]


def _flat(values: pa.Array) -> Iterator[bytes]:
    kind = values.type
    yield pc.is_null(values).to_numpy(zero_copy_only=False).tobytes()
    if pa.types.is_list(kind) or pa.types.is_fixed_size_list(kind):
        yield pc.list_value_length(values).fill_null(0).to_numpy(zero_copy_only=False).tobytes()
        yield from _flat(pc.list_flatten(values))
    elif pa.types.is_primitive(kind):
        yield values.fill_null(pa.scalar(0).cast(kind)).to_numpy(zero_copy_only=False).tobytes()
    else:
        yield repr(values.to_pylist()).encode()


def differences(kept: Digests, found: Digests) -> list[str]:
    """Say which tables of both differ, and in what."""
    return [
        f"{name}: {', '.join(columns)}"
        for name in sorted(set(kept) & set(found))
        for columns in [
            sorted(
                column
                for column in {*kept[name], *found[name]}
                if kept[name].get(column) != found[name].get(column)
            )
        ]
        if columns
    ]


def compare(kept: Digests, found: Digests) -> int:
    """Print what differs, and give the exit status: 1 if anything does."""
    differing = differences(kept, found)
    print(*differing, sep="\n", end="\n" if differing else "")
    print(f"{len(set(kept) & set(found))} tables compared, {len(differing)} differ")
    if missing := sorted(set(kept) - set(found)):
        print(f"not in this run: {', '.join(missing)}")
    return int(bool(differing) or not found)


def main(command: str, *folders: str) -> int:
    """Keep a run's digests, or compare it with those kept or with another run's."""
    found = digest_run(Path(*folders[:1] or "."))
    if command == "keep":
        KEPT.write_text(json.dumps(found, indent=1, sort_keys=True) + "\n", encoding="utf-8")
        print(f"{len(found)} tables kept in {KEPT}")
        return 0
    if len(folders) > 1:
        return compare(digest_run(Path(folders[1])), found)
    return compare(json.loads(KEPT.read_text(encoding="utf-8")), found)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
