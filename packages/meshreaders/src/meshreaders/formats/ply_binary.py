"""Read the tables of a binary PLY file."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray
from plyfile import PlyElement, PlyListProperty, PlyProperty

from meshreaders.base.arrays import IntArray
from meshreaders.formats.ply_columns import GrowingTable, Lists, Table, is_read
from meshreaders.polygons import index_runs

_BLOCK_BYTES = 1 << 14  # pointers of a block fit into the processor's cache

_Kinds: TypeAlias = tuple[np.dtype[Any] | None, np.dtype[Any]]
"""Type of the length of a list (None for a property that is no list), and type of the numbers."""


def read_binary_tables(
    data: bytes,
    start: int,
    elements: Iterable[tuple[PlyElement, int]],
    order: str,
    columns: Mapping[str, Collection[str]],
) -> dict[str, Table] | None:
    """Read the tables of the elements of a binary PLY file.

    Parameters
    ----------
    data : bytes
        Content of the file.
    start : int
        Index of the byte at which the first row begins.
    elements : iterable
        Elements and their numbers of rows, in the order of the file.
    order : str
        Byte order of numbers: ``<`` or ``>``.
    columns : mapping
        Properties to read per element; lists are always read.

    Returns
    -------
    dict or None
        A table per key of `columns`; None if rows are missing, or lengths of lists have a floating-point type.
    """
    tables = {}
    for element, count in elements:
        column_names = columns.get(element.name, ())
        table_and_end = _read_even(data, start, element, count, order, column_names)
        if table_and_end is None:
            table_and_end = _read_uneven(data, start, element, count, order, column_names)
        if table_and_end is None:
            return None
        table, start = table_and_end
        if element.name in columns:
            tables[element.name] = table
    return tables


def _read_even(
    data: bytes,
    start: int,
    element: PlyElement,
    count: int,
    order: str,
    column_names: Collection[str],
) -> tuple[Table, int] | None:
    """Return the table of rows of equal length, and the end of the rows; None if lengths differ or rows are missing."""
    dtype = _type_of_first_row(data, start, element, count, order)
    if dtype is None or start + count * dtype.itemsize > len(data):
        return None
    rows = np.frombuffer(data, dtype, count, start) if count else np.empty(0, dtype)
    if not _have_one_length(rows, element):
        return None
    return _table_of_rows(rows, element, column_names), start + rows.nbytes


def _type_of_first_row(
    data: bytes, start: int, element: PlyElement, count: int, order: str
) -> np.dtype[Any] | None:
    """Return the structured type of rows that are as long as the first row; None if a length is impossible."""
    dtype = np.dtype([])
    for prop in element.properties:
        of_length, kind = _kinds(prop, order)
        fields: list[Any] = [(prop.name, kind)]
        if of_length is not None:
            if of_length.kind == "f":
                return None
            length = _number_at(data, start + dtype.itemsize, of_length) if count else 0
            if length is None or not 0 <= length * kind.itemsize <= len(data):
                return None
            fields = [(_name_of_length(prop), of_length), (prop.name, kind, (length,))]
        before = [(name, dtype[name]) for name in dtype.names or ()]
        dtype = np.dtype([*before, *fields])
    return dtype


def _number_at(data: bytes, position: int, kind: np.dtype[Any]) -> int | None:
    """Return the integer at a byte of `data`; None after the end."""
    if position + kind.itemsize > len(data):
        return None
    return int(np.frombuffer(data, kind, 1, position)[0])


def _have_one_length(rows: NDArray[Any], element: PlyElement) -> bool:
    return all(
        bool((rows[_name_of_length(prop)] == rows[prop.name].shape[1]).all())
        for prop in element.properties
        if isinstance(prop, PlyListProperty)
    )


def _name_of_length(prop: PlyListProperty) -> str:
    # Names of properties have no line feed, so the name is free.
    return f"{prop.name}\nlength"


def _table_of_rows(rows: NDArray[Any], element: PlyElement, column_names: Collection[str]) -> Table:
    columns, lists = {}, {}
    for prop in element.properties:
        if not is_read(prop, column_names):
            continue
        values = rows[prop.name]
        # Copy: a view would keep the whole file in memory.
        copied = values.astype(values.dtype.newbyteorder("="), order="C")
        if isinstance(prop, PlyListProperty):
            counts = np.broadcast_to(np.int32(values.shape[1]), len(rows))
            lists[prop.name] = Lists(copied.reshape(-1), counts)
        else:
            columns[prop.name] = copied
    return Table(len(rows), columns, lists)


def _read_uneven(
    data: bytes,
    start: int,
    element: PlyElement,
    count: int,
    order: str,
    column_names: Collection[str],
) -> tuple[Table, int] | None:
    """Return the table of rows with lists of any length, and the end of the rows; None if rows are missing."""
    kinds = [_kinds(prop, order) for prop in element.properties]
    if any(length is not None and length.kind == "f" for length, _ in kinds):
        return None
    table, rows_left = GrowingTable(element, column_names), count
    while rows_left:  # each turn reads a row at least
        if start >= len(data):
            return None
        starts = _row_starts(data, start, kinds, rows_left)
        value_starts, lengths, ends = _claimed(data, starts, kinds)
        if ends[-1] > len(data) or any((counts < 0).any() for counts in lengths):
            return None
        for column, prop in enumerate(element.properties):
            if is_read(prop, column_names):
                kind = kinds[column][1]
                index = index_runs(value_starts[column], lengths[column], kind.itemsize)
                table.add_values(prop, _at_each_byte(data, kind)[index], lengths[column])
        table.add_rows(len(starts))
        rows_left -= len(starts)
        start = int(ends[-1])
    return table.finished(), start


def _row_starts(data: bytes, start: int, kinds: Sequence[_Kinds], most: int) -> IntArray:
    """Return the starts of the rows in a block, from one row up to `most` rows."""
    # A row's length is known only from its beginning. So each byte of the block points to where a row that began
    # there would end. Following the pointers over one row, then over two rows, four rows and so on finds all
    # beginnings without a loop over rows.
    block = np.arange(start, min(start + _BLOCK_BYTES, len(data)))
    _, _, ends = _claimed(data, block, kinds)
    # The last pointer is for all bytes after the block.
    jump = np.append(np.minimum(ends - start, len(block)), len(block))
    starts = np.zeros(1, dtype=np.int64)
    for _ in range(most.bit_length()):
        if len(starts) >= most or starts[-1] >= len(block):
            break
        starts = np.concatenate([starts, jump[starts]])
        jump = jump[jump]
    return start + starts[starts < len(block)][:most]


def _claimed(
    data: bytes, starts: IntArray, kinds: Sequence[_Kinds]
) -> tuple[list[IntArray], list[IntArray], IntArray]:
    """Return, for rows at `starts`, per property the start (r,) and number (r,) of its numbers, and the ends (r,) of the rows."""
    # If a length is after the end of the data, the end of its row is there, too.
    value_starts, lengths, position = [], [], starts
    for of_length, kind in kinds:
        count = np.ones(len(starts), dtype=np.int64)
        if of_length is not None:
            numbers = _at_each_byte(data, of_length)
            count = numbers[np.minimum(position, len(numbers) - 1)].astype(np.int64)
            position = position + of_length.itemsize
        value_starts.append(position)
        lengths.append(count)
        position = position + kind.itemsize * np.maximum(count, 0)
    return value_starts, lengths, position


def _at_each_byte(data: bytes, kind: np.dtype[Any]) -> NDArray[Any]:
    """Return a view of the overlapping numbers that begin at each byte."""
    return np.ndarray((len(data) - kind.itemsize + 1,), kind, data, 0, (1,))


def _kinds(prop: PlyProperty, order: str) -> _Kinds:
    if isinstance(prop, PlyListProperty):
        of_length, of_values = map(np.dtype, prop.list_dtype(order))
        return of_length, of_values
    return None, np.dtype(prop.dtype(order))
