"""The tables, meshes and metrics of a run as tables of comparable columns.

Rows are sorted by their keys. Seconds, and columns that follow from seconds, are left out. Arrays and pictures are
described by digest, mean and standard deviation.
"""

from __future__ import annotations

import gzip
import hashlib
import io
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from PIL import Image

from visuohaptic.geometry.surface import read_surface
from visuohaptic.pictures.models import COORDINATE_STEPS
from visuohaptic.tables.schemas import SCHEMAS

METRICS = ("metrics", "headline", "studies/ablations", "studies/claims", "studies/touch_curves")
"""JSON files below reports/; the files of studies exist only where the study was run."""

OF_SECONDS = {
    "cost": {"as_quick", "on_front", "dominated", "step", "quicker"},
    "cost_seconds": {"object", "turn"},
    "figures": {"robot_s", "cpu_s"},
}
"""Columns, and figures of JSON files, that follow from run times, by schema."""

DIGEST = " digest"
SHOWN_ONLY = (" mean", " deviation")
"""Endings of columns that describe arrays and pictures. The column that ends in `DIGEST` decides."""


def read_run(folder: Path) -> dict[str, pa.Table]:
    """Read the tables, meshes and metrics of a run as tables of comparable columns, by name."""
    parts: dict[str, list[pa.Table]] = {}
    schemas: dict[str, str] = {}
    for path in sorted((folder / "results").rglob("*.parquet")):
        part = pq.read_table(path, partitioning=None)
        inside = path.relative_to(folder / "results").with_suffix("").parts
        name = "/".join(inside[:2]) if inside[0].startswith("study") else inside[0]
        schemas[name] = (part.schema.metadata or {}).get(b"table", b"").decode()
        parts.setdefault(name, []).append(part.replace_schema_metadata())
    tables = {
        name: comparable(pa.concat_tables(found), schemas[name]) for name, found in parts.items()
    }
    meshes = sorted((folder / "results" / "meshes").rglob("*.ply"))
    if meshes:
        tables["meshes"] = _in_order(_mesh_table(meshes), ["object"])
    for name in METRICS:
        path = folder / "reports" / f"{name}.json"
        if path.is_file():
            tables[f"reports/{name}"] = figures_table(json.loads(path.read_bytes()))
    return tables


def comparable(table: pa.Table, schema: str) -> pa.Table:
    """Leave out seconds, describe arrays and pictures by digest, mean and standard deviation, and sort by the keys."""
    columns: dict[str, Any] = {}
    for field in table.schema:
        if field.name in OF_SECONDS.get(schema, ()) or field.name.startswith("seconds"):
            continue
        if field.name == "model" and schema == "pictures":
            # Open3D chooses the edges that it removes.
            packed = zip(
                table.column("model").to_pylist(), table.column("vertices").to_pylist(), strict=True
            )
            columns |= dict(_described("model", [_model_vertices(*one) for one in packed]))
            continue
        columns |= dict(_scalars(field, table.column(field.name)))
    keys = [name for name in _keys_of(schema) if name in columns]
    metadata = {"schema": schema, "keys": json.dumps(keys)}
    return _in_order(pa.table(columns), keys).replace_schema_metadata(metadata)


def figures_table(held: Mapping[str, Any]) -> pa.Table:
    """Return the figures of a JSON file as rows of a dotted path, a number and a text, without parameters and method."""
    leaves = [
        (path, value)
        for path, value in _leaves(held, "")
        if path.partition(".")[0] not in {"parameters", "method", *OF_SECONDS["figures"]}
    ]
    is_number = [
        isinstance(value, int | float) and not isinstance(value, bool) for _, value in leaves
    ]
    columns = {
        "figure": pa.array([path for path, _ in leaves], pa.string()),
        "number": pa.array(
            [
                value if number else None
                for (_, value), number in zip(leaves, is_number, strict=True)
            ],
            pa.float64(),
        ),
        "text": pa.array(
            [
                None if number else json.dumps(value)
                for (_, value), number in zip(leaves, is_number, strict=True)
            ],
            pa.string(),
        ),
    }
    metadata = {"schema": "figures", "keys": json.dumps(["figure"])}
    return _in_order(pa.table(columns), ["figure"]).replace_schema_metadata(metadata)


def digest_of(parts: Iterable[bytes]) -> str:
    found = hashlib.sha256()
    for part in parts:
        found.update(part)
    return found.hexdigest()[:12]


def _keys_of(schema: str) -> tuple[str, ...]:
    # Variants put their name in front of a table's keys, and have tables of their own.
    return ("variant", *(SCHEMAS[schema].keys if schema in SCHEMAS else ("object", "touch")))


def _in_order(table: pa.Table, keys: Sequence[str]) -> pa.Table:
    """Sort rows by the keys, then by all other columns, which decides where keys repeat."""
    names = [*keys, *(name for name in table.column_names if name not in keys)]
    metadata = table.schema.metadata
    ordered = table.sort_by([(name, "ascending") for name in names]) if names else table
    return ordered.combine_chunks().replace_schema_metadata(metadata)


def _scalars(field: pa.Field, column: pa.ChunkedArray) -> Iterator[tuple[str, Any]]:
    """Yield a column as columns of scalars: arrays, pictures and maps by digest, mean and standard deviation."""
    kind = field.type
    if pa.types.is_map(kind) and pa.types.is_string(kind.key_type):
        entries = [dict(row or ()) for row in column.to_pylist()]
        for key in sorted({key for row in entries for key in row}):
            part = pa.chunked_array([pa.array([row.get(key) for row in entries], kind.item_type)])
            yield from _scalars(pa.field(f"{field.name}_{key}", kind.item_type), part)
    elif pa.types.is_nested(kind) or pa.types.is_binary(kind):
        described = [_numbers(value) for value in column.to_pylist()]
        yield (
            f"{field.name}{DIGEST}",
            pa.array([None if one is None else digest_of([one.tobytes()]) for one in described]),
        )
        yield from _described(field.name, described)
    else:
        yield field.name, column


def _described(name: str, arrays: Sequence[np.ndarray | None]) -> Iterator[tuple[str, Any]]:
    for ending, work in zip(SHOWN_ONLY, (np.mean, np.std), strict=True):
        values = [
            None if one is None or not one.size else round(float(work(one.astype(np.float64))), 9)
            for one in arrays
        ]
        yield f"{name}{ending}", pa.array(values, pa.float64())


def _numbers(value: object) -> np.ndarray | None:
    """Return the numbers of an array, the pixels of a picture, or those of all entries of a map."""
    if value is None:
        return None
    if isinstance(value, bytes):
        try:
            with Image.open(io.BytesIO(value)) as picture:
                return np.asarray(picture).reshape(-1)
        except OSError:
            return np.frombuffer(value, np.uint8)
    assert isinstance(value, list)
    if value and isinstance(value[0], tuple):
        parts = [_numbers(item) for _, item in value]
        return np.concatenate([part for part in parts if part is not None] or [np.zeros(0)])
    return np.array(value, dtype=np.float64)


def _model_vertices(packed: bytes | None, vertices: int | None) -> np.ndarray | None:
    """Return the coordinates of a packed 3D model, in object radii."""
    if packed is None:
        return None
    return np.frombuffer(gzip.decompress(packed), "<i2", 3 * vertices) / COORDINATE_STEPS


def _mesh_table(paths: Sequence[Path]) -> pa.Table:
    rows: dict[str, list[Any]] = {"object": []}
    for path in paths:
        rows["object"].append(f"{path.parent.name}/{path.stem}")
        surface = read_surface(path)
        for name in ("vertices", "faces", "face_colours"):
            values = np.asarray(getattr(surface, name))
            rows.setdefault(f"{name}{DIGEST}", []).append(digest_of([values.tobytes()]))
            for ending, value in zip(SHOWN_ONLY, (values.mean(), values.std()), strict=True):
                rows.setdefault(f"{name}{ending}", []).append(round(float(value), 9))
    metadata = {"schema": "meshes", "keys": '["object"]'}
    return pa.table(rows).replace_schema_metadata(metadata)


def _leaves(value: Any, path: str) -> Iterator[tuple[str, Any]]:
    """Yield the leaves of a JSON value with their dotted paths."""
    if isinstance(value, Mapping) or (isinstance(value, list) and value):
        items = value.items() if isinstance(value, Mapping) else enumerate(value)
        for key, item in items:
            yield from _leaves(item, f"{path}.{key}" if path else str(key))
    else:
        yield path, value
