"""Keep the tables of a run, and report how another run differs from it, value by value.

    PYTHONPATH=tests python -m golden.golden_tables NEW OLD    # two runs, by their folders

At a difference the report names the column, the first rows that differ with their keys, both values, and the largest
difference.
"""

from __future__ import annotations

import csv
import json
import math
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
from golden.run_tables import DIGEST, SHOWN_ONLY, digest_of, read_run

TOLERANCES = {
    "features": 1e-12,
    "probability": 1e-11,
    "answers": 1e-7,
    "pressed": 1e-12,
    "file_frame": 1e-12,
    "model mean": 1e-3,
    "model deviation": 1e-3,
}
"""Largest differences between processors (docs/stability.md), by schema or column.

All other columns are equal bit for bit.
"""

ROWS_SHOWN = 3
COLUMNS_SHOWN = 4
"""Rows per column, and columns per table, that a report shows. Other columns are named."""

SINGLE = float(np.finfo(np.float32).eps)

_FLOW = (
    "meshes", "views", "fixations", "policy_fixations", "touches", "effects", "features", "scores", "predictions",
    "stability", "pictures", "study_features", "study_blocks", "studies", "frontier", "effect_influence",
)  # fmt: skip


@dataclass(frozen=True)
class ColumnFigures:
    """What the text file holds of a column: rows, digest, and mean and standard deviation of numbers."""

    rows: int
    digest: str
    mean: float | None
    deviation: float | None


@dataclass(frozen=True)
class Kept:
    """A run: figures of all columns, and the values of those tables whose values are kept.

    With `single`, values of `tables` are rounded to single precision.
    """

    columns: Mapping[str, Mapping[str, ColumnFigures]]
    tables: Mapping[str, pa.Table]
    single: bool = False


def kept_of(tables: Mapping[str, pa.Table]) -> Kept:
    """Return a run whose values are all at hand."""
    return Kept({name: column_figures(table) for name, table in tables.items()}, tables)


def column_figures(table: pa.Table) -> dict[str, ColumnFigures]:
    """Return rows, digest, mean and standard deviation of each column."""
    return {name: _figures(table.column(name)) for name in table.column_names}


def write_kept(
    tables: Mapping[str, pa.Table], folder: Path, values_of: Iterable[str], *, single: bool
) -> None:
    """Write a run: ``columns.csv``, and the values of the tables `values_of`, with floats in single precision or double.

    Figures of JSON files are written as CSV, so that a diff of text shows what moved.
    """
    folder.mkdir(parents=True, exist_ok=True)
    rows: list[Sequence[object]] = [("table", "column", "rows", "mean", "deviation", "digest")]
    for name in in_flow(tables):
        for column, found in column_figures(tables[name]).items():
            digits = 15 if _tolerance(tables[name], column) else 6
            numbers = [_written(value, digits) for value in (found.mean, found.deviation)]
            rows.append((name, column, found.rows, *numbers, found.digest))
    write_csv(folder / "columns.csv", rows)
    for name in in_flow(set(values_of) & set(tables)):
        path = folder / f"{name.replace('/', '-')}"
        if name.startswith("reports/"):
            lines = tables[name].to_pydict()
            write_csv(path.with_suffix(".csv"), [tuple(lines), *zip(*lines.values(), strict=True)])
        else:
            _write_values(tables[name], path.with_suffix(".parquet"), single=single)


def read_kept(folder: Path, *, single: bool) -> Kept:
    """Read what `write_kept` wrote."""
    columns: dict[str, dict[str, ColumnFigures]] = {}
    with (folder / "columns.csv").open(newline="", encoding="utf-8") as stream:
        for row in csv.DictReader(stream):
            mean, deviation = (
                float(row[key]) if row[key] else None for key in ("mean", "deviation")
            )
            figures = ColumnFigures(int(row["rows"]), row["digest"], mean, deviation)
            columns.setdefault(row["table"], {})[row["column"]] = figures
    tables = {}
    for name in columns:
        path = folder / name.replace("/", "-")
        if path.with_suffix(".parquet").exists():
            tables[name] = pq.read_table(path.with_suffix(".parquet"))
        elif path.with_suffix(".csv").exists():
            with path.with_suffix(".csv").open(newline="", encoding="utf-8") as stream:
                rows = list(csv.DictReader(stream))
            tables[name] = pa.table(
                {
                    "figure": [row["figure"] for row in rows],
                    "number": [float(row["number"]) if row["number"] else None for row in rows],
                    "text": [row["text"] or None for row in rows],
                }
            ).replace_schema_metadata({"schema": "figures", "keys": '["figure"]'})
    return Kept(columns, tables, single)


def differences(kept: Kept, found: Mapping[str, pa.Table]) -> dict[str, list[str]]:
    """Return the lines of the report by table that differs, in the order of the flow; nothing if the runs are equal."""
    lines: dict[str, list[str]] = {}
    for name in in_flow({*kept.columns, *found}):
        if name not in found:
            lines[name] = [f"{name}: is kept and not in this run"]
        elif name not in kept.columns:
            lines[name] = [f"{name}: is in this run and not kept"]
        elif said := _table_differences(name, kept, found[name]):
            lines[name] = said
    return lines


def in_flow(names: Iterable[str]) -> list[str]:
    """Sort tables in the order in which a run makes them, so that the first difference is the nearest to its cause."""
    order = {name: index for index, name in enumerate(_FLOW)}
    return sorted(names, key=lambda name: (order.get(name.partition("/")[0], len(_FLOW)), name))


def report(lines: Mapping[str, Sequence[str]], compared: int) -> str:
    """Return the report as text."""
    said = [line for of_table in lines.values() for line in of_table]
    return "\n".join([*said, f"{compared} tables compared, {len(lines)} differ"])


def write_csv(path: Path, rows: Iterable[Sequence[object]]) -> None:
    """Write rows as CSV with the line ends of text files."""
    with path.open("w", newline="", encoding="utf-8") as stream:
        csv.writer(stream, lineterminator="\n").writerows(rows)


def _table_differences(name: str, kept: Kept, found: pa.Table) -> list[str]:
    old, new = kept.columns[name], column_figures(found)
    lines = [
        f"{name}.{column}: is {'kept and not in this run' if column in old else 'in this run and not kept'}"
        for column in sorted(set(old) ^ set(new))
    ]
    differing = [
        column
        for column in new
        if column in old
        and not column.endswith(SHOWN_ONLY)
        and new[column].digest != old[column].digest
    ]
    differing += [
        column
        for column in new
        if column in old and column.endswith(SHOWN_ONLY) and column in TOLERANCES
    ]
    values = kept.tables.get(name)
    if values is None:
        said = [_figures_differ(name, each, old[each], new[each], found) for each in differing]
        return lines + _shortened(name, differing, [[line] if line else [] for line in said])
    pairs, only_kept, only_found = _aligned(values, found)
    for word, table, rows in (("kept", values, only_kept), ("found", found, only_found)):
        if rows:
            lines.append(f"{name}: {len(rows)} rows are only {word}")
            lines += [f"    {_row_name(table, row)}" for row in rows[:ROWS_SHOWN]]
    said_of_rows = [_values_differ(name, each, kept, found, pairs) for each in differing]
    return lines + _shortened(name, differing, said_of_rows)


def _shortened(name: str, columns: Sequence[str], said: Sequence[Sequence[str]]) -> list[str]:
    """Return what is said of the first columns that differ, and the names of all others."""
    differing = [(column, lines) for column, lines in zip(columns, said, strict=True) if lines]
    lines = [line for _, of_column in differing[:COLUMNS_SHOWN] for line in of_column]
    others = [column for column, _ in differing[COLUMNS_SHOWN:]]
    return lines + (
        [f"{name}: {len(others)} more columns differ: {', '.join(others)}"] if others else []
    )


def _figures_differ(
    name: str, column: str, old: ColumnFigures, new: ColumnFigures, found: pa.Table
) -> str:
    """Say how mean and deviation of a column differ whose values are not kept; "" if within the tolerance."""
    tolerance = _tolerance(found, column)
    known = None not in {old.mean, new.mean, old.deviation, new.deviation}
    if tolerance and known and old.rows == new.rows:
        moved = max(abs(old.mean - new.mean), abs(old.deviation - new.deviation))  # type: ignore[operator]
        if moved <= tolerance:
            return ""
    said = f"{name}.{column}: {old.rows} rows, now {new.rows}"
    if known:
        said += f"; mean {old.mean:.9g}, now {new.mean:.9g}; deviation {old.deviation:.9g}, now {new.deviation:.9g}"
    return f"{said}; digest {old.digest}, now {new.digest}"


def _values_differ(
    name: str, column: str, kept: Kept, found: pa.Table, pairs: Sequence[tuple[int, int]]
) -> list[str]:
    """Say which rows differ in a column, at most `ROWS_SHOWN`, and by how much; nothing if within the tolerance."""
    rows = np.array(pairs, dtype=np.int64).reshape(-1, 2)
    old = kept.tables[name].column(column).take(rows[:, 0])
    new = found.column(column).take(rows[:, 1])
    tolerance = _tolerance(found, column)
    if pa.types.is_floating(new.type):
        first, second = (_floats(values) for values in (old, new))
        bound = np.full(len(first), tolerance)
        if kept.single:
            bound += SINGLE * np.maximum(np.abs(first), np.finfo(np.float32).tiny)
        moved = np.abs(first - second)
        differs = (np.isnan(first) != np.isnan(second)) | (moved > bound)
        largest = f", by at most {np.nanmax(moved[differs], initial=0.0):.6g}"
    else:
        differs = np.array(
            [one != other for one, other in zip(old.to_pylist(), new.to_pylist(), strict=True)],
            dtype=bool,
        )
        largest = _largest(column, kept.tables[name], found, rows[differs])
    where = np.flatnonzero(differs)
    if not len(where):
        same_rows = len(rows) == found.num_rows == kept.tables[name].num_rows
        figures = kept.columns[name][column], _figures(found.column(column))
        if tolerance and not kept.single and same_rows:
            return []
        said = _figures_differ(name, column, *figures, found)
        return [f"{said}; no row differs in the digits that are kept"] if said and same_rows else []
    lines = [f"{name}.{column}: {len(where)} of {len(rows)} rows differ{largest}"]
    digits = 8 if kept.single else None
    for row in where[:ROWS_SHOWN].tolist():
        said = _described_differences(column, kept.tables[name], found, rows[row])
        if not said:
            one, other = (_shown(values[row].as_py(), digits) for values in (old, new))
            said = f"kept {one}, found {other}"
        lines.append(f"    {_row_name(found, int(rows[row, 1]))}: {said}")
    return lines


def _largest(column: str, old: pa.Table, new: pa.Table, rows: np.ndarray) -> str:
    """Say the largest difference of the means of arrays or pictures whose digests differ."""
    mean = column.removesuffix(DIGEST) + SHOWN_ONLY[0]
    if not column.endswith(DIGEST) or mean not in new.column_names or not len(rows):
        return ""
    first = _floats(old.column(mean).take(rows[:, 0]))
    second = _floats(new.column(mean).take(rows[:, 1]))
    return f", their means by at most {np.nanmax(np.abs(first - second), initial=0.0):.6g}"


def _described_differences(column: str, old: pa.Table, new: pa.Table, row: np.ndarray) -> str:
    """Say how mean and deviation of an array or picture differ; "" if they do not, or for other columns."""
    if not column.endswith(DIGEST):
        return ""
    said = []
    for ending in SHOWN_ONLY:
        name = f"{column.removesuffix(DIGEST)}{ending}"
        if name in old.column_names and name in new.column_names:
            one, other = (
                _shown(table.column(name)[int(index)].as_py(), 6)
                for table, index in zip((old, new), row, strict=True)
            )
            said += [f"{ending.strip()} {one}, found {other}"] if one != other else []
    return f"kept {'; '.join(said)}" if said else ""


def _aligned(old: pa.Table, new: pa.Table) -> tuple[list[tuple[int, int]], list[int], list[int]]:
    """Pair rows with equal keys; return pairs of row indices, rows only in `old`, and rows only in `new`."""
    first, second = _numbered(old), _numbered(new)
    pairs = [(row, second[key]) for key, row in first.items() if key in second]
    return (
        pairs,
        [row for key, row in first.items() if key not in second],
        [row for key, row in second.items() if key not in first],
    )


def _numbered(table: pa.Table) -> dict[tuple[object, ...], int]:
    """Return the row of each key; a repeated key counts its repeats."""
    keys = json.loads(table.schema.metadata[b"keys"])
    rows: dict[tuple[object, ...], int] = {}
    repeats: dict[tuple[object, ...], int] = {}
    columns = [table.column(key).to_pylist() for key in keys]
    for row, key in enumerate(zip(*columns, strict=True) if keys else [()] * table.num_rows):
        repeats[key] = repeats.get(key, -1) + 1
        rows[*key, repeats[key]] = row
    return rows


def _row_name(table: pa.Table, row: int) -> str:
    keys = json.loads(table.schema.metadata[b"keys"])
    return ", ".join(f"{key} {table.column(key)[row].as_py()}" for key in keys) or f"row {row}"


def _shown(value: object, digits: int | None) -> str:
    return f"{value:.{digits}g}" if digits and isinstance(value, float) else repr(value)


def _floats(values: pa.ChunkedArray) -> np.ndarray:
    return values.cast(pa.float64()).to_numpy().astype(np.float64)


def _tolerance(table: pa.Table, column: str) -> float:
    """Return the documented difference between processors of a column; 0 for most."""
    schema = (table.schema.metadata or {}).get(b"schema", b"").decode()
    if not pa.types.is_floating(table.schema.field(column).type):
        return 0.0
    return TOLERANCES.get(column, TOLERANCES.get(schema, 0.0))


def _figures(column: pa.ChunkedArray) -> ColumnFigures:
    kind = column.type
    digest = digest_of([str(kind).encode(), *_flat(column)])
    if not (pa.types.is_floating(kind) or pa.types.is_integer(kind)):
        return ColumnFigures(len(column), digest, None, None)
    values = _floats(column)
    values = values[np.isfinite(values)]
    if not len(values):
        return ColumnFigures(len(column), digest, None, None)
    # `fsum` rounds once, so that the processor's order of sums does not count.
    mean = math.fsum(values) / len(values)
    deviation = math.sqrt(math.fsum((values - mean) ** 2) / len(values))
    return ColumnFigures(len(column), digest, mean, deviation)


def _flat(column: pa.ChunkedArray) -> Iterator[bytes]:
    values = column.combine_chunks() if isinstance(column, pa.ChunkedArray) else column
    yield pc.is_null(values).to_numpy(zero_copy_only=False).tobytes()
    if pa.types.is_primitive(values.type):
        filled = values.fill_null(pa.scalar(0).cast(values.type))
        yield filled.to_numpy(zero_copy_only=False).tobytes()
    else:
        yield repr(values.to_pylist()).encode()


def _written(value: float | None, digits: int) -> str:
    return "" if value is None else f"{value:.{digits}g}"


def _write_values(table: pa.Table, path: Path, *, single: bool) -> None:
    floats = [field.name for field in table.schema if pa.types.is_floating(field.type)]
    if single:
        for name in floats:
            index = table.column_names.index(name)
            table = table.set_column(index, name, table.column(name).cast(pa.float32(), safe=False))
    # Bytes of one significance lie together, which is a third smaller.
    pq.write_table(
        table, path, compression="zstd", compression_level=19, write_statistics=False,
        use_dictionary=[name for name in table.column_names if name not in floats],
        column_encoding=dict.fromkeys(floats, "BYTE_STREAM_SPLIT"),
    )  # fmt: skip


def main(new: str, old: str) -> int:
    """Print what differs between two runs, and return the exit status: 1 if anything does."""
    found, kept = read_run(Path(new)), kept_of(read_run(Path(old)))
    lines = differences(kept, found)
    print(report(lines, len(set(found) & set(kept.columns))))
    return int(bool(lines) or not found)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
