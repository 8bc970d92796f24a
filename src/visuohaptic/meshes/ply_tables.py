"""The rows of a PLY file, as arrays: a column per number and the numbers of each list in one array."""

from __future__ import annotations

import io
import re
import tempfile
import warnings
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray
from plyfile import PlyData, PlyElement, PlyElementParseError, PlyListProperty, PlyProperty

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import MeshError
from visuohaptic.geometry.ply_header import PlyHeader
from visuohaptic.meshes.polygons import index_runs
from visuohaptic.meshes.text_numbers import blocks_of_lines

_MEANT = re.compile(r"\s*(?:ply|format|element|property)\b")
_COUNT = re.compile(rb"^(element \S+) (\d+)$", re.MULTILINE)
_LONGEST_ROW = 1 << 16  # numbers
_BLOCK_BYTES = 1 << 14  # whose places fit the cache of a processor

_Kinds: TypeAlias = tuple[np.dtype[Any] | None, np.dtype[Any]]  # of a list's length, and of numbers


@dataclass(frozen=True)
class Lists:
    """Lists of one property.

    Attributes
    ----------
    values : numpy.ndarray
        Shape (n,): the numbers of all lists, row after row.
    counts : numpy.ndarray
        Shape (r,), int32: how many numbers each row has.
    """

    values: NDArray[Any]
    counts: NDArray[np.int32]


@dataclass(frozen=True)
class Table:
    """Rows of one element.

    Attributes
    ----------
    rows : int
        Number of rows.
    columns : dict
        Numbers (r,) per property that is no list, in the file's type.
    lists : dict
        `Lists` per property that is a list.
    """

    rows: int
    columns: dict[str, NDArray[Any]]
    lists: dict[str, Lists]


def read_tables(
    data: bytes, header: PlyHeader, columns: Mapping[str, Collection[str]]
) -> dict[str, Table]:
    """Read tables of the elements that are keys of `columns`; no array is a view of `data`.

    Each table has all lists of its element and, of the other properties, those that `columns` names.

    Raises `MeshError`, with the reason only, if rows are missing, and ``plyfile.PlyParseError`` if a table
    can't be read.
    """
    plain = plain_header(data[: header.length])
    # plyfile would copy the rows; of a header that promises none it reads the properties.
    described = PlyData.read(io.BytesIO(_COUNT.sub(rb"\1 0", plain)))
    counts = [int(count) for _, count in _COUNT.findall(plain)]
    tables = (
        _text_tables(data, header, described, counts, columns)
        if header.ascii
        else _binary_tables(data, header.length, described, counts, columns)
    )
    return _tables_by_plyfile(data, plain, header, columns) if tables is None else tables


def plain_header(header: bytes) -> bytes:
    """Return the header without comments, which may be in any encoding, its words parted by one blank."""
    lines = [" ".join(line.split()) for line in decoded(header).splitlines() if _MEANT.match(line)]
    return "\n".join([*lines, "end_header\n"]).encode("ascii", "replace")


def decoded(header: bytes) -> str:
    """Return a header as text, UTF-8 or else Latin-1."""
    try:
        return header.decode("utf-8")
    except UnicodeDecodeError:
        return header.decode("latin-1")


def _text_tables(
    data: bytes,
    header: PlyHeader,
    described: PlyData,
    counts: list[int],
    columns: Mapping[str, Collection[str]],
) -> dict[str, Table] | None:
    """Read tables of a line per row, whose rows have one length per element; None where one has others."""
    if data.count(b"\n", header.length) + (not data.endswith(b"\n")) != header.rows:
        return None
    text, tables = _Text(data, header.length), {}
    for element, count in zip(described.elements, counts, strict=True):
        rows = _text_rows(text, element, count)
        if rows is None:
            return None
        if element.name in columns:
            tables[element.name] = _table_of_even(rows, element, columns[element.name])
    return tables


def _binary_tables(
    data: bytes,
    start: int,
    described: PlyData,
    counts: list[int],
    columns: Mapping[str, Collection[str]],
) -> dict[str, Table] | None:
    """Read binary tables; None where rows are missing or a list's length is no whole number."""
    tables = {}
    for element, count in zip(described.elements, counts, strict=True):
        rows = _binary_rows(data, start, element, count, described.byte_order)
        wanted = columns.get(element.name, ())
        if rows is not None:
            start += rows.nbytes
            if element.name in columns:
                tables[element.name] = _table_of_even(rows, element, wanted)
            continue
        found = _uneven_table(data, start, element, count, described.byte_order, wanted)
        if found is None:
            return None
        table, start = found
        if element.name in columns:
            tables[element.name] = table
    return tables


def _table_of_even(rows: NDArray[Any], element: PlyElement, wanted: Collection[str]) -> Table:
    columns, lists = {}, {}
    for one in element.properties:
        if one.name not in wanted and not isinstance(one, PlyListProperty):
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


def _binary_rows(
    data: bytes, start: int, element: PlyElement, count: int, order: str
) -> NDArray[Any] | None:
    dtype = np.dtype([])
    for one in element.properties:
        fields: list[Any] = [(one.name, one.dtype(order))]
        if isinstance(one, PlyListProperty):
            of_length, of_values = map(np.dtype, one.list_dtype(order))
            place = start + dtype.itemsize
            stored = (
                data[place : place + of_length.itemsize] if count else bytes(of_length.itemsize)
            )
            if len(stored) < of_length.itemsize or of_length.kind == "f":
                return None
            length = int(np.frombuffer(stored, of_length)[0])
            if not 0 <= length * of_values.itemsize <= len(data):
                return None
            fields = [(_length_of(one), of_length), (one.name, of_values, (length,))]
        dtype = np.dtype([*_fields(dtype), *fields])
    if start + count * dtype.itemsize > len(data):
        return None
    rows = np.frombuffer(data, dtype, count, start) if count else np.empty(0, dtype)
    return rows if _is_even(rows, element) else None


def _text_rows(text: _Text, element: PlyElement, count: int) -> NDArray[Any] | None:
    try:
        columns, width = [], 0
        for one in element.properties:
            if isinstance(one, PlyListProperty):
                of_length, of_values = one.list_dtype()
                length = text.peek(width) if count else 0
                if not 0 <= length <= _LONGEST_ROW:
                    return None
                columns += [(_length_of(one), of_length), (one.name, of_values, (length,))]
                width += 1 + length
            else:
                columns.append((one.name, one.dtype()))
                width += 1
        rows, done = np.empty(count, columns), 0
        while done < count:
            block = text.take(width, count - done)
            if not _fill(rows[done : done + len(block)], block):
                return None
            done += len(block)
    except ValueError:
        return None
    return rows if _is_even(rows, element) else None


def _fill(rows: NDArray[Any], numbers: FloatArray) -> bool:
    """Put numbers (n, k) into rows; False where an integer's type can't hold one."""
    column = 0
    for name in rows.dtype.names or ():
        field = rows[name].reshape(len(rows), -1)
        values = numbers[:, column : column + field.shape[1]]
        column += field.shape[1]
        with np.errstate(invalid="ignore", over="ignore"):
            field[:] = values
        if field.dtype.kind != "f" and (field != values).any():
            return False
    return True


class _Text:
    """The numbers of a text in blocks of lines; `ValueError` where a word is no number or the text ends."""

    def __init__(self, data: bytes, start: int) -> None:
        self._blocks = blocks_of_lines(data, start)
        self._numbers = np.empty(0)

    def peek(self, place: int) -> int:
        """Return the number behind so many others."""
        while len(self._numbers) <= place:
            self._read()
        return int(self._numbers[place])

    def take(self, width: int, most: int) -> FloatArray:
        """Return the next rows (n, width), at least one and `most` at most."""
        while len(self._numbers) < width:
            self._read()
        rows = min(len(self._numbers) // width, most)
        taken = self._numbers[: rows * width].reshape(rows, width)
        self._numbers = self._numbers[rows * width :]
        return taken

    def _read(self) -> None:
        block = next(self._blocks, None)
        if block is None:
            raise ValueError("the text ends")
        # NumPy reads a number from white space without any.
        if not block.isspace():
            parsed = np.fromstring(block, sep=" ")
            self._numbers = np.concatenate([self._numbers, parsed])


def _is_even(rows: NDArray[Any], element: PlyElement) -> bool:
    return all(
        bool((rows[_length_of(one)] == rows[one.name].shape[1]).all())
        for one in element.properties
        if isinstance(one, PlyListProperty)
    )


def _length_of(one: PlyListProperty) -> str:
    # No name of a property has a line feed.
    return f"{one.name}\nlength"


def _fields(dtype: np.dtype[Any]) -> list[tuple[str, np.dtype[Any]]]:
    return [(name, dtype[name]) for name in dtype.names or ()]


def _uneven_table(
    data: bytes,
    start: int,
    element: PlyElement,
    count: int,
    order: str,
    wanted: Collection[str],
) -> tuple[Table, int] | None:
    """Read rows whose lists have any length, and return where they end; None where rows are missing."""
    kinds = [_kinds(one, order) for one in element.properties]
    if any(length is not None and length.kind == "f" for length, _ in kinds):
        return None
    read = [
        number
        for number, one in enumerate(element.properties)
        if isinstance(one, PlyListProperty) or one.name in wanted
    ]
    values, counts = [bytearray() for _ in kinds], [bytearray() for _ in kinds]
    left = count
    while left:
        if start >= len(data):
            return None
        starts = _row_starts(data, start, kinds, left)
        places, lengths, ends = _claimed(data, starts, kinds)
        if ends[-1] > len(data) or any((one < 0).any() for one in lengths):
            return None
        for number in read:
            kind = kinds[number][1]
            index = index_runs(places[number], lengths[number], kind.itemsize)
            values[number] += _at_each_byte(data, kind)[index].tobytes()
            counts[number] += lengths[number].astype(np.int32).tobytes()
        left -= len(starts)
        start = int(ends[-1])
    columns, lists = {}, {}
    for number in read:
        name, kind = element.properties[number].name, kinds[number][1]
        numbers = np.frombuffer(values[number], kind).astype(kind.newbyteorder("="), copy=False)
        if kinds[number][0] is None:
            columns[name] = numbers
        else:
            lists[name] = Lists(numbers, np.frombuffer(counts[number], np.int32))
    return Table(count, columns, lists), start


def _row_starts(data: bytes, start: int, kinds: Sequence[_Kinds], most: int) -> IntArray:
    """Return where the rows in a block begin, at least one and `most` at most."""
    # A row's length is known only from its beginning. So each byte of the block points to where a row that began
    # there would end. Following the pointers over one row, then over two rows, four rows and so on finds all
    # beginnings without a loop over rows.
    block = np.arange(start, min(start + _BLOCK_BYTES, len(data)))
    _, _, ends = _claimed(data, block, kinds)
    # The last place stands for all behind the block.
    jump = np.append(np.minimum(ends - start, len(block)), len(block))
    starts = np.zeros(1, dtype=np.int64)
    while len(starts) < most and starts[-1] < len(block):
        starts = np.concatenate([starts, jump[starts]])
        jump = jump[jump]
    return start + starts[starts < len(block)][:most]


def _claimed(
    data: bytes, starts: IntArray, kinds: Sequence[_Kinds]
) -> tuple[list[IntArray], list[IntArray], IntArray]:
    """Return where each property would begin in rows that began at `starts`, its length, and where they end."""
    # Where a length stands behind the end of the data, so does the end of its row.
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


def _tables_by_plyfile(
    data: bytes, plain: bytes, header: PlyHeader, columns: Mapping[str, Collection[str]]
) -> dict[str, Table]:
    """Read tables row by row by plyfile, whose lists are objects; it says which row is wrong."""
    with tempfile.TemporaryFile() as file:
        file.write(plain)
        file.write(memoryview(data)[header.length :])
        file.seek(0)
        try:
            with warnings.catch_warnings():
                # plyfile reads rows of text by NumPy, which warns of a list that is empty.
                warnings.filterwarnings("ignore", "loadtxt: input contained no data")
                return {
                    one.name: _table_of_objects(one, columns[one.name])
                    for one in PlyData.read(file).elements
                    if one.name in columns
                }
        except PlyElementParseError as error:
            if error.row is None or "early end" not in error.message:
                raise
            raise MeshError(
                f"it is truncated: its header promises {error.element.count} rows of "
                f"{error.element.name!r}, and {error.row} are there whole"
            ) from error


def _table_of_objects(element: PlyElement, wanted: Collection[str]) -> Table:
    columns, lists = {}, {}
    for one in element.properties:
        rows = element.data[one.name]
        if isinstance(one, PlyListProperty):
            counts = np.fromiter(map(len, rows), np.int32, len(rows))
            lists[one.name] = Lists(np.concatenate([np.empty(0, np.int64), *rows]), counts)
        elif one.name in wanted:
            columns[one.name] = rows
    return Table(len(element.data), columns, lists)
