"""The tables of a PLY file: views of its bytes where all rows of an element have one length."""

from __future__ import annotations

import io
import re
import tempfile
import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray
from plyfile import PlyData, PlyElement, PlyElementParseError, PlyListProperty

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import MeshError
from visuohaptic.geometry.ply_header import PlyHeader
from visuohaptic.meshes.text_numbers import blocks_of_lines

_MEANT = re.compile(r"\s*(?:ply|format|element|property)\b")
_COUNT = re.compile(rb"^(element \S+) (\d+)$", re.MULTILINE)
_LONGEST_ROW = 1 << 16  # numbers


def read_tables(data: bytes, header: PlyHeader) -> PlyData:
    """Read the tables of a PLY file; those of a binary one are views of `data` where they can be.

    Lists whose rows have one length are arrays (n, k), others arrays (n,) of objects. Raises
    `MeshError`, with the reason only, if rows are missing, and ``plyfile.PlyParseError`` if a table
    can't be read.
    """
    plain = plain_header(data[: header.length])
    tables = _even_tables(data, plain, header)
    return _uneven_tables(data, plain, header) if tables is None else tables


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


def _even_tables(data: bytes, plain: bytes, header: PlyHeader) -> PlyData | None:
    """Return tables whose rows have one length per element; None where one has others."""
    # plyfile would copy the rows; of a header that promises none it reads the properties.
    tables = PlyData.read(io.BytesIO(_COUNT.sub(rb"\1 0", plain)))
    counts = [int(count) for _, count in _COUNT.findall(plain)]
    if header.ascii:
        lines = data.count(b"\n", header.length) + (not data.endswith(b"\n"))
        text = _Text(data, header.length) if lines == header.rows else None
    start = header.length
    for element, count in zip(tables.elements, counts, strict=True):
        rows: NDArray[Any] | None
        if not header.ascii:
            rows = _binary_rows(data, start, element, count, tables.byte_order)
            start += 0 if rows is None else rows.nbytes
        else:
            rows = None if text is None else _text_rows(text, element, count)
        if rows is None:
            return None
        element.data = rows[[one.name for one in element.properties]]
    return tables


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


def _uneven_tables(data: bytes, plain: bytes, header: PlyHeader) -> PlyData:
    """Read tables row by row by plyfile, whose lists are objects."""
    with tempfile.TemporaryFile() as file:
        file.write(plain)
        file.write(memoryview(data)[header.length :])
        file.seek(0)
        try:
            with warnings.catch_warnings():
                # plyfile reads rows of text by NumPy, which warns of a list that is empty.
                warnings.filterwarnings("ignore", "loadtxt: input contained no data")
                return PlyData.read(file)
        except PlyElementParseError as error:
            if error.row is None or "early end" not in error.message:
                raise
            raise MeshError(
                f"it is truncated: its header promises {error.element.count} rows of "
                f"{error.element.name!r}, and {error.row} are there whole"
            ) from error
