"""Tables of a PLY file whose rows are lines of text."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from plyfile import PlyElement, PlyListProperty, PlyProperty

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import MeshError
from visuohaptic.meshes.ply_columns import GrowingTable, Table
from visuohaptic.meshes.polygons import index_runs
from visuohaptic.meshes.text_numbers import blocks_of_lines, numbers_by_line


def read_text_tables(
    data: bytes,
    start: int,
    elements: Iterable[tuple[PlyElement, int]],
    columns: Mapping[str, Collection[str]],
) -> dict[str, Table] | None:
    """Read tables whose rows are a line each.

    Parameters
    ----------
    data : bytes
        The file; its lines end in a line feed.
    start : int
        Where the first row begins.
    elements : iterable
        Each element, with its number of rows, in the file's order.
    columns : mapping
        The properties to be read per element; all lists are read.

    Returns
    -------
    dict or None
        A table per key of `columns`; None where lines are missing, a line has other numbers than its
        row needs, or a word is no number of its property's type.
    """
    lines, tables = _Lines(data, start), {}
    for element, count in elements:
        table, left = GrowingTable(element, columns.get(element.name, ())), count
        while left:
            block = lines.take(left)
            if block is None or not _add_lines(table, element, *block):
                return None
            left -= len(block[1])
        if element.name in columns:
            tables[element.name] = table.finished()
    return tables


class _Lines:
    """The lines of a text, as numbers and how many each line has."""

    def __init__(self, data: bytes, start: int) -> None:
        self._blocks = blocks_of_lines(data, start)
        self._numbers, self._widths = np.empty(0), np.empty(0, np.int64)

    def take(self, most: int) -> tuple[FloatArray, IntArray] | None:
        """Return numbers (n,) and widths (r,) of the next lines, 1 to `most`; None at the text's end.

        Also returns None where a word is no number.
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
    """Add rows of a line each to a table; False where a line is no row of the element."""
    ends = np.cumsum(widths)
    places = ends - widths
    for one in element.properties:
        # A row that ends too early would take its numbers from the next one.
        if (places >= ends).any():
            return False
        counts = np.ones(len(places), dtype=np.int64)
        if isinstance(one, PlyListProperty):
            counts, places = _lengths(one, numbers[places]), places + 1
            if (counts < 0).any() or (places + counts > ends).any():
                return False
            values = numbers[index_runs(places, counts)]
        else:
            values = numbers[places]
        if not _holds(_type_of(one), values):
            return False
        table.add_values(one, values, counts)
        places = places + counts
    table.add_rows(len(widths))
    return bool((places == ends).all())


def _lengths(one: PlyListProperty, numbers: FloatArray) -> IntArray:
    """Return the lengths of lists, -1 where a number is no length that the file's type can hold."""
    kind = np.dtype(one.list_dtype()[0])
    stored = _converted(numbers, kind)
    return np.where(stored == numbers, stored, -1).astype(np.int64)


def _holds(kind: np.dtype[Any], numbers: FloatArray) -> bool:
    """Tell whether a type can hold all numbers; floating-point types may round."""
    return kind.kind == "f" or bool((_converted(numbers, kind) == numbers).all())


def _converted(numbers: FloatArray, kind: np.dtype[Any]) -> NDArray[Any]:
    with np.errstate(invalid="ignore", over="ignore"):
        return numbers.astype(kind)


def _type_of(one: PlyProperty) -> np.dtype[Any]:
    return np.dtype(one.list_dtype()[1] if isinstance(one, PlyListProperty) else one.dtype())
