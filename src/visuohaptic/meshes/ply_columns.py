"""Columns and lists of a PLY element, as arrays."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from plyfile import PlyElement, PlyListProperty, PlyProperty

from visuohaptic.base.arrays import IntArray


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


def is_read(one: PlyProperty, wanted: Collection[str]) -> bool:
    """Tell whether a property is part of a table: all lists are, and the columns in `wanted`."""
    return isinstance(one, PlyListProperty) or one.name in wanted


class GrowingTable:
    """A table that is read block after block of rows; its arrays grow without a second copy."""

    def __init__(self, element: PlyElement, wanted: Collection[str]) -> None:
        self._properties = [one for one in element.properties if is_read(one, wanted)]
        self._values = {one.name: bytearray() for one in self._properties}
        self._counts = {one.name: bytearray() for one in self._properties}
        self._rows = 0

    def add_values(self, one: PlyProperty, values: NDArray[Any], counts: IntArray) -> None:
        """Add the numbers (n,) of a property, and how many each row of the block has, (r,)."""
        if one.name not in self._values:
            return
        self._values[one.name] += values.astype(_kind_of(one), copy=False).tobytes()
        if isinstance(one, PlyListProperty):
            self._counts[one.name] += counts.astype(np.int32).tobytes()

    def add_rows(self, count: int) -> None:
        """Count the rows of a block whose values have been added."""
        self._rows += count

    def finished(self) -> Table:
        """Return the table of all rows so far."""
        columns, lists = {}, {}
        for one in self._properties:
            values = np.frombuffer(self._values[one.name], _kind_of(one))
            if isinstance(one, PlyListProperty):
                lists[one.name] = Lists(values, np.frombuffer(self._counts[one.name], np.int32))
            else:
                columns[one.name] = values
        return Table(self._rows, columns, lists)


def _kind_of(one: PlyProperty) -> np.dtype[Any]:
    """Return the type of a property's numbers in the machine's byte order."""
    stored = one.list_dtype()[1] if isinstance(one, PlyListProperty) else one.dtype()
    return np.dtype(stored).newbyteorder("=")
