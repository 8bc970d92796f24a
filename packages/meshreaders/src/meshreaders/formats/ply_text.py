"""Read the tables of a text PLY file."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from plyfile import PlyElement, PlyListProperty, PlyProperty

from meshreaders.base.arrays import FloatArray, IntArray
from meshreaders.base.errors import MeshError
from meshreaders.formats.ply_columns import GrowingTable, Table
from meshreaders.formats.text_numbers import blocks_of_lines, numbers_by_line
from meshreaders.polygons import index_runs


def read_text_tables(
    data: bytes,
    start: int,
    elements: Iterable[tuple[PlyElement, int]],
    columns: Mapping[str, Collection[str]],
) -> dict[str, Table] | None:
    """Read tables with one line per row.

    Parameters
    ----------
    data : bytes
        Content of the file; lines end in a line feed.
    start : int
        Index of the byte at which the first row begins.
    elements : iterable
        Elements and their numbers of rows, in the order of the file.
    columns : mapping
        Properties to read per element; lists are always read.

    Returns
    -------
    dict or None
        A table per key of `columns`; None if lines are missing, a line has too many or too few numbers, or a word is
        no number of the type of its property.
    """
    lines, tables = _Lines(data, start), {}
    for element, count in elements:
        table, rows_left = GrowingTable(element, columns.get(element.name, ())), count
        while rows_left:  # each turn reads a row at least
            block = lines.take(rows_left)
            if block is None or not _add_lines(table, element, *block):
                return None
            rows_left -= len(block[1])
        if element.name in columns:
            tables[element.name] = table.finished()
    return tables


class _Lines:
    """The numbers of a text, and the number of numbers per line."""

    def __init__(self, data: bytes, start: int) -> None:
        self._blocks = blocks_of_lines(data, start)
        self._numbers, self._widths = np.empty(0), np.empty(0, np.int64)

    def take(self, most: int) -> tuple[FloatArray, IntArray] | None:
        """Return numbers (n,) and widths (r,) of the next lines, from one line up to `most` lines.

        Returns None at the end of the text, or if a word is no number.
        """
        if not len(self._widths):
            block = next(self._blocks, None)
            if block is None:
                return None
            try:
                self._numbers, self._widths = numbers_by_line(block, 1)
            except MeshError:
                return None
        widths = self._widths[:most]
        end = int(widths.sum())
        numbers = self._numbers[:end]
        self._numbers, self._widths = self._numbers[end:], self._widths[most:]
        return numbers, widths


def _add_lines(
    table: GrowingTable, element: PlyElement, numbers: FloatArray, widths: IntArray
) -> bool:
    """Add lines to a table as rows; return False if a line is no row of the element."""
    ends = np.cumsum(widths)
    positions = ends - widths
    for prop in element.properties:
        # A short row must not take numbers of the next row.
        if (positions >= ends).any():
            return False
        counts = np.ones(len(positions), dtype=np.int64)
        if isinstance(prop, PlyListProperty):
            counts, positions = _lengths(prop, numbers[positions]), positions + 1
            if (counts < 0).any() or (positions + counts > ends).any():
                return False
            values = numbers[index_runs(positions, counts)]
        else:
            values = numbers[positions]
        if not _holds(_type_of(prop), values):
            return False
        table.add_values(prop, values, counts)
        positions = positions + counts
    table.add_rows(len(widths))
    return bool((positions == ends).all())


def _lengths(prop: PlyListProperty, numbers: FloatArray) -> IntArray:
    """Return the lengths of lists; -1 for a number that the type in the header can't represent."""
    kind = np.dtype(prop.list_dtype()[0])
    stored = _converted(numbers, kind)
    return np.where(stored == numbers, stored, -1).astype(np.int64)


def _holds(kind: np.dtype[Any], numbers: FloatArray) -> bool:
    """Return whether a type can represent all numbers; floating-point types may round."""
    return kind.kind == "f" or bool((_converted(numbers, kind) == numbers).all())


def _converted(numbers: FloatArray, kind: np.dtype[Any]) -> NDArray[Any]:
    with np.errstate(invalid="ignore", over="ignore"):
        return numbers.astype(kind)


def _type_of(prop: PlyProperty) -> np.dtype[Any]:
    return np.dtype(prop.list_dtype()[1] if isinstance(prop, PlyListProperty) else prop.dtype())
