"""Columns and lists of a PLY element as arrays."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from plyfile import PlyElement, PlyListProperty, PlyProperty

from meshreaders.base.arrays import IntArray


@dataclass(frozen=True)
class Lists:
    """Lists of one property.

    Attributes
    ----------
    values : numpy.ndarray
        Shape (n,): numbers of all lists, row after row.
    counts : numpy.ndarray
        Shape (r,), int32: number of numbers per row.
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
        Numbers (r,) per property that is no list, in the type of the file.
    lists : dict
        `Lists` per property that is a list.
    """

    rows: int
    columns: dict[str, NDArray[Any]]
    lists: dict[str, Lists]


def is_read(prop: PlyProperty, column_names: Collection[str]) -> bool:
    """Return whether a property is part of a table: a list, or a column in `column_names`."""
    return isinstance(prop, PlyListProperty) or prop.name in column_names


class GrowingTable:
    """A table that is built from blocks of rows; its arrays grow without a second copy."""

    def __init__(self, element: PlyElement, column_names: Collection[str]) -> None:
        self._properties = [prop for prop in element.properties if is_read(prop, column_names)]
        self._values = {prop.name: bytearray() for prop in self._properties}
        self._counts = {prop.name: bytearray() for prop in self._properties}
        self._rows = 0

    def add_values(self, prop: PlyProperty, values: NDArray[Any], counts: IntArray) -> None:
        """Add the numbers (n,) of a property for a block of rows, with `counts` (r,) numbers per row."""
        if prop.name not in self._values:
            return
        self._values[prop.name] += values.astype(_kind_of(prop), copy=False).tobytes()
        if isinstance(prop, PlyListProperty):
            self._counts[prop.name] += counts.astype(np.int32).tobytes()

    def add_rows(self, count: int) -> None:
        """Add the number of rows of a block, after the values of all properties."""
        self._rows += count

    def finished(self) -> Table:
        """Return the table of all added rows."""
        columns, lists = {}, {}
        for prop in self._properties:
            values = np.frombuffer(self._values[prop.name], _kind_of(prop))
            if isinstance(prop, PlyListProperty):
                lists[prop.name] = Lists(values, np.frombuffer(self._counts[prop.name], np.int32))
            else:
                columns[prop.name] = values
        return Table(self._rows, columns, lists)


def _kind_of(prop: PlyProperty) -> np.dtype[Any]:
    """Return the type of the numbers of a property, in native byte order."""
    stored = prop.list_dtype()[1] if isinstance(prop, PlyListProperty) else prop.dtype()
    return np.dtype(stored).newbyteorder("=")
