"""Tables of a binary PLY file."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray
from plyfile import PlyElement, PlyListProperty, PlyProperty

from visuohaptic.base.arrays import IntArray
from visuohaptic.meshes.ply_columns import GrowingTable, Lists, Table, is_read
from visuohaptic.meshes.polygons import index_runs

_BLOCK_BYTES = 1 << 14  # whose pointers fit the cache of a processor

_Kinds: TypeAlias = tuple[np.dtype[Any] | None, np.dtype[Any]]
"""Type of a list's length, None of a property that is no list, and type of its numbers."""


def read_binary_tables(
    data: bytes,
    start: int,
    elements: Iterable[tuple[PlyElement, int]],
    order: str,
    columns: Mapping[str, Collection[str]],
) -> dict[str, Table] | None:
    """Read binary tables.

    Parameters
    ----------
    data : bytes
        The file.
    start : int
        Where the first row begins.
    elements : iterable
        Each element, with its number of rows, in the file's order.
    order : str
        Byte order of numbers: ``<`` or ``>``.
    columns : mapping
        The properties to be read per element; all lists are read.

    Returns
    -------
    dict or None
        A table per key of `columns`; None where rows are missing or a list's length is no whole number.
    """
    tables = {}
    for element, count in elements:
        wanted = columns.get(element.name, ())
        found = _read_even(data, start, element, count, order, wanted)
        if found is None:
            found = _read_uneven(data, start, element, count, order, wanted)
        if found is None:
            return None
        table, start = found
        if element.name in columns:
            tables[element.name] = table
    return tables


def _read_even(
    data: bytes, start: int, element: PlyElement, count: int, order: str, wanted: Collection[str]
) -> tuple[Table, int] | None:
    """Read rows of one length, and return where they end; None where rows differ or are missing."""
    dtype = _type_of_first_row(data, start, element, count, order)
    if dtype is None or start + count * dtype.itemsize > len(data):
        return None
    rows = np.frombuffer(data, dtype, count, start) if count else np.empty(0, dtype)
    if not _have_one_length(rows, element):
        return None
    return _table_of_rows(rows, element, wanted), start + rows.nbytes


def _type_of_first_row(
    data: bytes, start: int, element: PlyElement, count: int, order: str
) -> np.dtype[Any] | None:
    """Return a structured type of rows as long as the first one; None where a length is impossible."""
    dtype = np.dtype([])
    for one in element.properties:
        of_length, kind = _kinds(one, order)
        fields: list[Any] = [(one.name, kind)]
        if of_length is not None:
            if of_length.kind == "f":
                return None
            length = _number_at(data, start + dtype.itemsize, of_length) if count else 0
            if length is None or not 0 <= length * kind.itemsize <= len(data):
                return None
            fields = [(_name_of_length(one), of_length), (one.name, kind, (length,))]
        before = [(name, dtype[name]) for name in dtype.names or ()]
        dtype = np.dtype([*before, *fields])
    return dtype


def _number_at(data: bytes, place: int, kind: np.dtype[Any]) -> int | None:
    """Return the integer at a byte of `data`; None behind its end."""
    if place + kind.itemsize > len(data):
        return None
    return int(np.frombuffer(data, kind, 1, place)[0])


def _have_one_length(rows: NDArray[Any], element: PlyElement) -> bool:
    return all(
        bool((rows[_name_of_length(one)] == rows[one.name].shape[1]).all())
        for one in element.properties
        if isinstance(one, PlyListProperty)
    )


def _name_of_length(one: PlyListProperty) -> str:
    # No name of a property has a line feed.
    return f"{one.name}\nlength"


def _table_of_rows(rows: NDArray[Any], element: PlyElement, wanted: Collection[str]) -> Table:
    columns, lists = {}, {}
    for one in element.properties:
        if not is_read(one, wanted):
            continue
        values = rows[one.name]
        # Copies: a view would keep the whole file in memory.
        copied = values.astype(values.dtype.newbyteorder("="), order="C")
        if isinstance(one, PlyListProperty):
            counts = np.broadcast_to(np.int32(values.shape[1]), len(rows))
            lists[one.name] = Lists(copied.reshape(-1), counts)
        else:
            columns[one.name] = copied
    return Table(len(rows), columns, lists)


def _read_uneven(
    data: bytes, start: int, element: PlyElement, count: int, order: str, wanted: Collection[str]
) -> tuple[Table, int] | None:
    """Read rows whose lists have any length, and return where they end; None where rows are missing."""
    kinds = [_kinds(one, order) for one in element.properties]
    if any(length is not None and length.kind == "f" for length, _ in kinds):
        return None
    table, left = GrowingTable(element, wanted), count
    while left:
        if start >= len(data):
            return None
        starts = _row_starts(data, start, kinds, left)
        places, lengths, ends = _claimed(data, starts, kinds)
        if ends[-1] > len(data) or any((one < 0).any() for one in lengths):
            return None
        for number, one in enumerate(element.properties):
            if is_read(one, wanted):
                kind = kinds[number][1]
                index = index_runs(places[number], lengths[number], kind.itemsize)
                table.add_values(one, _at_each_byte(data, kind)[index], lengths[number])
        table.add_rows(len(starts))
        left -= len(starts)
        start = int(ends[-1])
    return table.finished(), start


def _row_starts(data: bytes, start: int, kinds: Sequence[_Kinds], most: int) -> IntArray:
    """Return where the rows in a block begin, at least one and `most` at most."""
    # A row's length is known only from its beginning. So each byte of the block points to where a row that began
    # there would end. Following the pointers over one row, then over two rows, four rows and so on finds all
    # beginnings without a loop over rows.
    block = np.arange(start, min(start + _BLOCK_BYTES, len(data)))
    _, _, ends = _claimed(data, block, kinds)
    # The last pointer stands for all bytes behind the block.
    jump = np.append(np.minimum(ends - start, len(block)), len(block))
    starts = np.zeros(1, dtype=np.int64)
    while len(starts) < most and starts[-1] < len(block):
        starts = np.concatenate([starts, jump[starts]])
        jump = jump[jump]
    return start + starts[starts < len(block)][:most]


def _claimed(
    data: bytes, starts: IntArray, kinds: Sequence[_Kinds]
) -> tuple[list[IntArray], list[IntArray], IntArray]:
    """Return per property where its numbers would begin (r,) and how many (r,), and where the rows would end (r,)."""
    # A length that lies behind the end of the data puts the end of its row there, too.
    places, lengths, place = [], [], starts
    for of_length, kind in kinds:
        count = np.ones(len(starts), dtype=np.int64)
        if of_length is not None:
            numbers = _at_each_byte(data, of_length)
            count = numbers[np.minimum(place, len(numbers) - 1)].astype(np.int64)
            place = place + of_length.itemsize
        places.append(place)
        lengths.append(count)
        place = place + kind.itemsize * np.maximum(count, 0)
    return places, lengths, place


def _at_each_byte(data: bytes, kind: np.dtype[Any]) -> NDArray[Any]:
    """Return a view of the numbers that begin at each byte; they overlap."""
    return np.ndarray((len(data) - kind.itemsize + 1,), kind, data, 0, (1,))


def _kinds(one: PlyProperty, order: str) -> _Kinds:
    if isinstance(one, PlyListProperty):
        of_length, of_values = map(np.dtype, one.list_dtype(order))
        return of_length, of_values
    return None, np.dtype(one.dtype(order))
