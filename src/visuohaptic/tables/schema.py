"""Schemas of tables (columns with types, units and ranges), and reading and writing of tables that follow a schema.

A table is one Parquet file, or a folder of Parquet files. A table is checked before it is written, and is written
whole or not at all.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from visuohaptic.base.atomic_files import atomic_file
from visuohaptic.base.errors import TableError

MOST_VALUES = 200_000_000
"""Largest number of values in one Parquet file, lists included; a short file may claim any number."""

_SEQUENCES = (np.ndarray, list, tuple, pa.ChunkedArray)


@dataclass(frozen=True)
class Column:
    """A column: its name, type, meaning, and allowed values.

    `unit` is a unit or a frame of reference, empty for plain counts and names. `minimum` and `maximum` are the
    closed range of the values, or of the elements of lists.
    """

    name: str
    dtype: pa.DataType
    description: str
    unit: str = ""
    minimum: float | None = None
    maximum: float | None = None
    nullable: bool = False


@dataclass(frozen=True)
class Schema:
    """The name of a table, the columns that identify a row, and the other columns, in order."""

    name: str
    key_columns: tuple[Column, ...]
    other_columns: tuple[Column, ...]

    @cached_property
    def columns(self) -> tuple[Column, ...]:
        """All columns; the columns that identify a row come first."""
        return (*self.key_columns, *self.other_columns)

    @property
    def keys(self) -> tuple[str, ...]:
        """Names of the columns that identify a row."""
        return names_of(self.key_columns)

    @cached_property
    def arrow(self) -> pa.Schema:
        """The schema for pyarrow; metadata of a field has its description and unit."""
        return pa.schema(
            [
                pa.field(
                    column.name,
                    column.dtype,
                    column.nullable,
                    {"description": column.description, "unit": column.unit},
                )
                for column in self.columns
            ],
            {"table": self.name},
        )


TEXT = pa.string()
COUNT = pa.int32()
REAL = pa.float64()


def share(name: str, description: str, *, nullable: bool = False) -> Column:
    """Return a column of numbers from 0 to 1."""
    return Column(name, REAL, description, "1", 0, 1, nullable)


def count(name: str, description: str, minimum: int = 0, *, nullable: bool = False) -> Column:
    """Return a column of whole numbers."""
    return Column(name, COUNT, description, "", minimum, None, nullable)


def difference(name: str, description: str) -> tuple[Column, ...]:
    """Return the columns of a difference of two shares and of the ends of its interval; values may be missing."""
    descriptions = {
        name: description,
        f"{name}_low": "lower end of its interval",
        f"{name}_high": "upper end of its interval",
    }
    return tuple(
        Column(column, REAL, text, "1", -1, 1, nullable=True)
        for column, text in descriptions.items()
    )


def names_of(columns: Iterable[Column]) -> tuple[str, ...]:
    """Return the names of columns."""
    return tuple(column.name for column in columns)


def build_table(schema: Schema, columns: Mapping[str, object]) -> pa.Table:
    """Return a checked table of a schema from one array per column; a single string or number is repeated.

    Arrays of two or more dimensions become one list per row. Raises `TableError` if the columns break the schema.
    """
    expected = {column.name for column in schema.columns}
    if expected != set(columns):
        missing, extra = sorted(expected - set(columns)), sorted(set(columns) - expected)
        raise TableError(
            f"table {schema.name}: columns missing {missing}, not in the schema {extra}."
        )
    lengths = {len(value) for value in columns.values() if isinstance(value, _SEQUENCES)}
    if len(lengths) > 1:
        raise TableError(
            f"table {schema.name}: columns have lengths {sorted(lengths)}; equal lengths are needed."
        )
    length = lengths.pop() if lengths else 1
    arrays = [
        _arrow_array(schema, column, columns[column.name], length) for column in schema.columns
    ]
    table = pa.Table.from_arrays(arrays, schema=schema.arrow)
    check_table(schema, table)
    return table


def build_rows(schema: Schema, rows: Sequence[Mapping[str, object]]) -> pa.Table:
    """Return a checked table of a schema from rows that have all its columns; other names are ignored."""
    names = names_of(schema.columns)
    return build_table(schema, {name: [row[name] for row in rows] for name in names})


def check_table(schema: Schema, table: pa.Table) -> None:
    """Raise `TableError` if columns, types, missing values, ranges or keys break the schema, or a number is not finite."""
    if not table.schema.equals(schema.arrow):
        raise TableError(
            f"table {schema.name}: columns are {_signature(table.schema)}; "
            f"the schema needs {_signature(schema.arrow)}."
        )
    for column in schema.columns:
        _check_column(schema, column, table.column(column.name))
    unique = table.select(list(schema.keys)).group_by(list(schema.keys)).aggregate([])
    if unique.num_rows != table.num_rows:
        repeated = table.num_rows - unique.num_rows
        raise TableError(
            f"table {schema.name}: {repeated} rows repeat the key ({', '.join(schema.keys)})."
        )


def write_table(schema: Schema, table: pa.Table, path: str | Path) -> None:
    """Check a table and write it as Parquet, whole or not at all; a missing folder is created.

    Raises `TableError` if the table breaks its schema.
    """
    check_table(schema, table)
    with atomic_file(path) as unfinished:
        pq.write_table(table, unfinished, compression="zstd")


def read_table(schema: Schema, paths: str | Path | Sequence[str | Path]) -> pa.Table:
    """Read a table from one file, a folder, or several files in any order, sorted by its keys.

    Raises `TableError` if there is no such file, or the table breaks its schema.
    """
    files = _parquet_files([paths] if isinstance(paths, str | Path) else paths)
    if not files:
        raise TableError(
            f"table {schema.name}: no Parquet file at {paths}; run the workflow first."
        )
    table = join_parts(schema, [_read_part(schema, file) for file in files])
    check_table(schema, table)
    return table


def known_columns(schema: Schema, given: object) -> pa.Table:
    """Return the columns of a schema that a table has, in the schema's order and types.

    Parameters
    ----------
    schema : Schema
        The schema.
    given : pyarrow.Table, data frame or mapping of arrays
        Any table that Arrow can convert. Text may have any of Arrow's text types or be categorical; numbers may
        have any width. Columns that the schema does not name are dropped.

    Raises
    ------
    TableError
        If `given` is no table, has a column twice, or a column does not fit its type.
    """
    table = _arrow_table(schema, given)
    twice = [name for name in names_of(schema.columns) if table.column_names.count(name) > 1]
    if twice:
        raise TableError(
            f"table {schema.name}: column {twice[0]} is there twice; one column of each name is allowed."
        )
    present = [column for column in schema.columns if column.name in table.column_names]
    arrays = [_as_type(schema, column, table.column(column.name)) for column in present]
    fields = [schema.arrow.field(column.name) for column in present]
    return pa.Table.from_arrays(arrays, schema=pa.schema(fields, schema.arrow.metadata))


def take_table(schema: Schema, given: object) -> pa.Table:
    """Return a checked table of a schema from any table that `known_columns` accepts.

    Raises `TableError` if a column is missing, or the table breaks the schema.
    """
    table = known_columns(schema, given)
    missing = [name for name in names_of(schema.columns) if name not in table.column_names]
    if missing:
        raise TableError(
            f"table {schema.name}: there is no column {missing[0]}; {len(schema.columns)} columns are needed "
            f"and {len(missing)} are missing."
        )
    check_table(schema, table)
    return table


def join_parts(schema: Schema, parts: Iterable[pa.Table]) -> pa.Table:
    """Return the rows of tables of a schema, at least one table, sorted by the keys."""
    table = pa.concat_tables(parts).sort_by([(key, "ascending") for key in schema.keys])
    return table.combine_chunks()


def matrix(table: pa.Table, names: Sequence[str]) -> np.ndarray:
    """Return k numeric columns of n rows side by side: shape (n, k), float64."""
    return np.column_stack([table.column(name).to_numpy().astype(np.float64) for name in names])


def images(table: pa.Table, name: str = "image") -> np.ndarray:
    """Return a column of m square images, lists of n² numbers, as (m, n, n) in the type of the column; n is 0 if m is 0."""
    column = table.column(name).combine_chunks()
    lengths = np.unique(pc.list_value_length(column).to_numpy(zero_copy_only=False))
    if not len(lengths):
        return np.zeros((0, 0, 0), column.type.value_type.to_pandas_dtype())
    side = round(float(lengths[0]) ** 0.5)
    if len(lengths) != 1 or side * side != lengths[0]:
        raise TableError(
            f"column {name}: images have {lengths.tolist()} points; the same square number in all rows is needed."
        )
    return np.asarray(column.flatten()).reshape(-1, side, side)


def _arrow_table(schema: Schema, given: object) -> pa.Table:
    if isinstance(given, pa.Table):
        return given
    if not isinstance(given, Mapping) and not hasattr(given, "__arrow_c_stream__"):
        raise TableError(
            f"table {schema.name} is given as {type(given).__name__}; a pyarrow.Table, a data frame or a "
            "mapping of arrays is needed."
        )
    try:
        return pa.table(dict(given) if isinstance(given, Mapping) else given)
    except (pa.ArrowException, TypeError, ValueError) as error:
        raise TableError(
            f"table {schema.name}: Arrow can't convert the given table: {_one_line(error)}."
        ) from error


def _as_type(schema: Schema, column: Column, values: pa.ChunkedArray) -> pa.ChunkedArray:
    """Cast a column to its type; raise `TableError` if text would become a number, or a number text."""
    if values.type == column.dtype:
        return values
    if pa.types.is_dictionary(values.type):
        values = pc.cast(values, values.type.value_type)
    is_alike = _kind(values.type) == _kind(column.dtype) or pa.types.is_null(values.type)
    try:
        if is_alike:
            return pc.cast(values, column.dtype)
        reason = f"values of kind {_kind(column.dtype)} are needed"
    except pa.ArrowException as error:
        reason = _one_line(error)
    raise TableError(
        f"table {schema.name}: column {column.name} is {values.type} and does not fit {column.dtype}: {reason}."
    )


def _kind(dtype: pa.DataType) -> str:
    if (
        pa.types.is_string(dtype)
        or pa.types.is_large_string(dtype)
        or pa.types.is_string_view(dtype)
    ):
        return "text"
    if pa.types.is_integer(dtype) or pa.types.is_floating(dtype) or pa.types.is_decimal(dtype):
        return "number"
    if (
        pa.types.is_list(dtype)
        or pa.types.is_large_list(dtype)
        or pa.types.is_fixed_size_list(dtype)
    ):
        return f"list of {_kind(dtype.value_type)}"
    return str(dtype)


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split()).rstrip(".")


def _arrow_array(schema: Schema, column: Column, value: object, length: int) -> pa.Array:
    if not isinstance(value, _SEQUENCES):
        value = [value] * length
    if isinstance(value, np.ndarray) and value.ndim > 1:
        value = list(value.reshape(len(value), -1))
    try:
        return pa.array(value, type=column.dtype)
    except (pa.ArrowInvalid, pa.ArrowTypeError, pa.ArrowNotImplementedError) as error:
        raise TableError(
            f"table {schema.name}: column {column.name} does not fit {column.dtype}: {error}."
        ) from error


def _check_column(schema: Schema, column: Column, values: pa.ChunkedArray) -> None:
    if values.null_count and not column.nullable:
        raise TableError(
            f"table {schema.name}: column {column.name} has {values.null_count} missing values; none is allowed."
        )
    if pa.types.is_list(column.dtype):
        values = pc.list_flatten(values)
    if not pa.types.is_floating(values.type) and not pa.types.is_integer(values.type):
        return
    if pa.types.is_floating(values.type) and pc.any(pc.invert(pc.is_finite(values))).as_py():
        raise TableError(f"table {schema.name}: column {column.name} has NaN or infinite values.")
    extremes = pc.min_max(values).as_py()
    if extremes["min"] is None:
        return
    below = column.minimum is not None and extremes["min"] < column.minimum
    above = column.maximum is not None and extremes["max"] > column.maximum
    if below or above:
        raise TableError(
            f"table {schema.name}: column {column.name} spans {extremes['min']} to {extremes['max']}; "
            f"{_bound(column.minimum)} to {_bound(column.maximum)} is allowed."
        )


def _bound(value: float | None) -> str:
    return "any number" if value is None else f"{value:g}"


def _signature(schema: pa.Schema) -> str:
    return ", ".join(f"{field.name} {field.type}" for field in schema)


def _parquet_files(paths: Sequence[str | Path]) -> list[Path]:
    files: list[Path] = []
    for path in map(Path, paths):
        files.extend(sorted(path.rglob("[!._]*.parquet")) if path.is_dir() else [path])
    return files


def open_parquet(file: str | Path) -> pq.ParquetFile:
    """Open a Parquet file and read only its metadata.

    Raises `TableError` if the file is missing, is no Parquet, or has more than `MOST_VALUES` values.
    """
    try:
        opened = pq.ParquetFile(file)
    except FileNotFoundError as error:
        raise TableError(f"there is no file {file}.") from error
    except (OSError, pa.ArrowException) as error:
        raise TableError(f"{file} can't be read as Parquet: {_one_line(error)}.") from error
    groups = [opened.metadata.row_group(group) for group in range(opened.num_row_groups)]
    values = sum(
        group.column(column).num_values for group in groups for column in range(group.num_columns)
    )
    if values > MOST_VALUES:
        raise TableError(
            f"{file} has {opened.metadata.num_rows} rows with {values} values; {MOST_VALUES} values "
            "are allowed."
        )
    return opened


def _read_part(schema: Schema, file: Path) -> pa.Table:
    opened = open_parquet(file)
    # Columns that the table does not have must not take memory.
    if opened.schema_arrow.names != schema.arrow.names:
        raise TableError(
            f"{file} has the columns {_signature(opened.schema_arrow)}; table {schema.name} has {_signature(schema.arrow)}."
        )
    try:
        part = opened.read()
    except (OSError, pa.ArrowException) as error:
        raise TableError(f"{file} can't be read as Parquet: {_one_line(error)}.") from error
    return known_columns(schema, part)
