"""Schemas of tables (columns with types, units and ranges), and reading and writing of tables that follow a schema.

A table is one Parquet file, or a folder of Parquet files that each hold some of its rows. A table is checked before it
is written, and is written whole or not at all.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from meshreaders.base.regular_files import check_regular
from visuohaptic.base.arrays import masked_fault
from visuohaptic.base.atomic_files import atomic_file
from visuohaptic.base.errors import TableError

MOST_VALUES = 100_000_000
"""Largest number of values in one Parquet file, elements of lists included; a table of 64-bit numbers takes 1.8 GB.

The limit protects the memory: a compressed file of a few bytes may unpack to any number of values.
"""

MOST_TEXT_BYTES = 500 * 10**6
"""Largest size of all texts and images in one Parquet file, each counted as often as rows have it.

A file stores a repeated text once, so a file of 10 kB may have texts of any size.
"""

_SEQUENCES = (np.ndarray, list, tuple, pa.ChunkedArray)


@dataclass(frozen=True)
class Column:
    """A column: its name, type, meaning, and allowed values.

    Attributes
    ----------
    name : str
        Name, unique in the table.
    dtype : pyarrow.DataType
        Type of the values.
    description : str
        Meaning of the values.
    unit : str
        Unit or frame of reference; "1" for shares, empty for plain counts and names.
    minimum, maximum : float, optional
        Closed range of the values, or of the elements of lists; None for no limit.
    nullable : bool
        Whether values may be missing (null). NaN and infinity are never allowed.
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
    """The name and the columns of a table.

    Attributes
    ----------
    name : str
        Name of the table, for errors.
    key_columns : tuple of Column
        Columns that identify a row: no two rows have the same values in all of these.
    other_columns : tuple of Column
        Columns that follow the key columns, in order.
    """

    name: str
    key_columns: tuple[Column, ...]
    other_columns: tuple[Column, ...]

    @cached_property
    def columns(self) -> tuple[Column, ...]:
        """All columns in order, key columns first."""
        return (*self.key_columns, *self.other_columns)

    @property
    def keys(self) -> tuple[str, ...]:
        """Names of the key columns."""
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
    """Return a column of float64 numbers from 0 to 1, with the unit "1"."""
    return Column(name, REAL, description, "1", 0, 1, nullable)


def count(name: str, description: str, minimum: int = 0, *, nullable: bool = False) -> Column:
    """Return a column of whole numbers (int32) of at least `minimum`, without a unit."""
    return Column(name, COUNT, description, "", minimum, None, nullable)


def difference(name: str, description: str) -> tuple[Column, ...]:
    """Return three columns for the difference of two shares and its interval: `name`, ``name_low`` and ``name_high``.

    Values are float64 numbers from -1 to 1, and may be missing. `description` is that of the first column.
    """
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
    """Return the names of columns, in order."""
    return tuple(column.name for column in columns)


def build_table(schema: Schema, columns: Mapping[str, object]) -> pa.Table:
    """Return a checked table of a schema from its columns.

    Parameters
    ----------
    schema : Schema
    columns : mapping
        Values of every column of the schema, by name: a NumPy array, list, tuple or pyarrow.ChunkedArray of n
        values. Any other value, such as a string or number, is repeated n times; n is 1 if all values are such.
        A NumPy array of shape (n, ...) becomes one flat list per row.

    Raises
    ------
    TableError
        If a column is missing or not in the schema, lengths differ, or `check_table` fails.
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
    """Return a checked table of a schema from rows (column name to value); names outside the schema are ignored.

    Raises `KeyError` if a row lacks a column, and `TableError` if the values break the schema.
    """
    names = names_of(schema.columns)
    return build_table(schema, {name: [row[name] for row in rows] for name in names})


def check_table(schema: Schema, table: pa.Table) -> None:
    """Raise `TableError` if a table breaks its schema.

    Names, order, types and nullability of columns must be those of the schema. Values must be finite, in the range of
    their column, and only missing where the column is nullable. No two rows may have the same key.
    """
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
    """Check a table and write it as one Parquet file, whole or not at all; missing folders are created.

    Raises `TableError` if the table breaks its schema.
    """
    check_table(schema, table)
    with atomic_file(path) as unfinished:
        pq.write_table(table, unfinished, compression="zstd")


def read_table(
    schema: Schema,
    paths: str | Path | Sequence[str | Path],
    columns: Sequence[str] | None = None,
) -> pa.Table:
    """Read and check a table, and return it sorted by its keys.

    Parameters
    ----------
    schema : Schema
        The schema. Each file must have the columns of the schema in its order; types are cast as in `known_columns`.
    paths : path or sequence of paths
        Files and folders, in any order. Of a folder, each ``*.parquet`` file is read, at any depth; files with names
        that begin with ``.`` or ``_`` are skipped.
    columns : sequence of str, optional
        Names of the columns to read beside the key columns; all by default. Other columns take no memory.

    Raises
    ------
    TableError
        If no file is found, a file is missing or can't be read, or the table breaks its schema.
    """
    files = _parquet_files([paths] if isinstance(paths, str | Path) else paths)
    if not files:
        raise TableError(
            f"table {schema.name}: no Parquet file at {paths}; run the workflow first."
        )
    chosen = schema
    if columns is not None:
        others = tuple(column for column in schema.other_columns if column.name in columns)
        chosen = replace(schema, other_columns=others)
    table = join_parts(chosen, [_read_part(schema, file, chosen) for file in files])
    check_table(chosen, table)
    return table


def known_columns(schema: Schema, given: object) -> pa.Table:
    """Return the columns of a schema that a table has, in the schema's order and types.

    Columns of the schema may be missing. Missing values, ranges and keys are not checked.

    Parameters
    ----------
    schema : Schema
    given : pyarrow.Table, data frame or mapping of arrays
        Any table that Arrow can convert. Text may have any of Arrow's text types or be categorical; numbers may
        have any width, but must fit the schema's type without loss. Columns outside the schema are dropped.

    Raises
    ------
    TableError
        If `given` is no table, has a column of the schema twice, or a column does not fit its type.
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
    """Return a checked table of a schema from any table that `known_columns` accepts; rows keep their order.

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
    """Return the rows of one or more tables of a schema as one table, sorted by the keys; nothing is checked."""
    table = pa.concat_tables(parts).sort_by([(key, "ascending") for key in schema.keys])
    return table.combine_chunks()


def matrix(table: pa.Table, names: Sequence[str]) -> np.ndarray:
    """Return k named columns of numbers as an array of shape (n, k), float64; missing values are NaN."""
    return np.column_stack([table.column(name).to_numpy().astype(np.float64) for name in names])


def images(table: pa.Table, name: str = "image") -> np.ndarray:
    """Return a column of m square images as an array of shape (m, n, n), in the type of the column's elements.

    Each row is a list of n² numbers, row by row. Without rows, the shape is (0, 0, 0). Raises `TableError` if the
    lists differ in length, or their length is no square number.
    """
    rows = readings(table, name)
    side = round(float(rows.shape[1]) ** 0.5)
    if side * side != rows.shape[1]:
        raise TableError(
            f"column {name}: images have {[rows.shape[1]]} points; the same square number in all rows is needed."
        )
    return rows.reshape(len(rows), side, side)


def images_or_readings(table: pa.Table, name: str = "image") -> np.ndarray:
    """Return `images` of lists with a square number of elements, (m, n, n), and `readings` of other lists, (m, t).

    A table does not say the layout of its taxels, so a pad of 144 taxels has images of 12 x 12 here.
    """
    rows = readings(table, name)
    is_square = round(float(rows.shape[1]) ** 0.5) ** 2 == rows.shape[1]
    return images(table, name) if is_square else rows


def readings(table: pa.Table, name: str = "image") -> np.ndarray:
    """Return a column of m lists of t numbers as an array of shape (m, t), in the type of the column's elements.

    Without rows, the shape is (0, 0). Raises `TableError` if the lists differ in length.
    """
    column = table.column(name).combine_chunks()
    lengths = np.unique(pc.list_value_length(column).to_numpy(zero_copy_only=False))
    if not len(lengths):
        return np.zeros((0, 0), column.type.value_type.to_pandas_dtype())
    if len(lengths) != 1:
        raise TableError(
            f"column {name}: images have {lengths.tolist()} points; the same square number in all rows is needed."
        )
    return np.asarray(column.flatten()).reshape(-1, lengths[0])


def _arrow_table(schema: Schema, given: object) -> pa.Table:
    """Convert a data frame or mapping to a table; raise `TableError` if Arrow can't."""
    if isinstance(given, pa.Table):
        return given
    if not isinstance(given, Mapping) and not hasattr(given, "__arrow_c_stream__"):
        raise TableError(
            f"table {schema.name} is given as {type(given).__name__}; a pyarrow.Table, a data frame or a "
            "mapping of arrays is needed."
        )
    for name, values in given.items() if isinstance(given, Mapping) else ():
        if fault := masked_fault(values):
            raise TableError(f"table {schema.name}: column {name} has {fault}.")
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
    """Return text, number, or list of either, for types that may be cast to each other; the type's name for others."""
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
    """Return the whole message of an error on one line, without its last point."""
    return " ".join(str(error).split()).rstrip(".")


def _arrow_array(schema: Schema, column: Column, value: object, length: int) -> pa.Array:
    """Convert the values of a column; a single value is repeated `length` times."""
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
    """Return names and types of columns, for errors."""
    return ", ".join(f"{field.name} {field.type}" for field in schema)


def _parquet_files(paths: Sequence[str | Path]) -> list[Path]:
    """Return the given files, and the Parquet files of the given folders, at any depth."""
    files: list[Path] = []
    for path in map(Path, paths):
        files.extend(sorted(path.rglob("[!._]*.parquet")) if path.is_dir() else [path])
    return files


def open_parquet(file: str | Path) -> pq.ParquetFile:
    """Open a Parquet file and read only its metadata; `read` of the result reads its rows.

    Raises `TableError` if the file is missing, is no Parquet file, or has more than `MOST_VALUES` values.
    """
    try:
        check_regular(file)
    except FileNotFoundError as error:
        raise TableError(f"there is no file {file}.") from error
    except OSError as error:
        raise TableError(f"{file} can't be read: {error.strerror}.") from error
    try:
        opened = pq.ParquetFile(file)
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


def _read_part(schema: Schema, file: Path, chosen: Schema) -> pa.Table:
    """Read the columns of `chosen` from one file of a table, with the types of the schema."""
    opened = open_parquet(file)
    # Columns that the table does not have must not take memory.
    if opened.schema_arrow.names != schema.arrow.names:
        raise TableError(
            f"{file} has the columns {_signature(opened.schema_arrow)}; table {schema.name} has {_signature(schema.arrow)}."
        )
    texts = [field.name for field in opened.schema_arrow if _is_text(field.type)]
    try:
        # Repeated texts stay single in memory until their size is known.
        parquet = pq.ParquetFile(file, metadata=opened.metadata, read_dictionary=texts)
        part = parquet.read(columns=list(names_of(chosen.columns)))
    except (OSError, pa.ArrowException) as error:
        raise TableError(f"{file} can't be read as Parquet: {_one_line(error)}.") from error
    size = sum(map(_text_bytes, part.columns))
    if size > MOST_TEXT_BYTES:
        raise TableError(
            f"{file} has texts of {size / 1e6:.0f} MB; {MOST_TEXT_BYTES / 1e6:.0f} MB are allowed."
        )
    return known_columns(chosen, part)


def _is_text(dtype: pa.DataType) -> bool:
    return pa.types.is_string(dtype) or pa.types.is_binary(dtype)


def _text_bytes(column: pa.ChunkedArray) -> int:
    """Return the size of the texts of a dictionary-encoded column, in bytes; 0 for another column."""
    if not pa.types.is_dictionary(column.type) or not _is_text(column.type.value_type):
        return 0
    lengths = (
        pc.sum(pc.cast(pc.binary_length(chunk.dictionary), pa.int64()).take(chunk.indices)).as_py()
        for chunk in column.chunks
    )
    return sum(length or 0 for length in lengths)
