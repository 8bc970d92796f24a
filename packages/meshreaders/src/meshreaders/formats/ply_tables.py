"""Read the rows of a PLY file as one table per element."""

from __future__ import annotations

import io
import re
import tempfile
import warnings
from collections.abc import Collection, Mapping

import numpy as np
from plyfile import PlyData, PlyElement, PlyElementParseError, PlyListProperty

from meshreaders.base.errors import MeshError
from meshreaders.base.ply_header import PlyHeader
from meshreaders.formats.ply_binary import read_binary_tables
from meshreaders.formats.ply_columns import Lists, Table
from meshreaders.formats.ply_text import read_text_tables

_KEPT = re.compile(r"\s*(?:ply|format|element|property)\b")
_COUNT = re.compile(rb"^(element \S+) (\d+)$", re.MULTILINE)


def read_tables(
    data: bytes, header: PlyHeader, columns: Mapping[str, Collection[str]]
) -> dict[str, Table]:
    """Read the tables of the elements that are keys of `columns`; no array is a view of `data`.

    `columns` has the properties to read per element; lists are always read. Raises `MeshError` with the reason if
    rows are missing, and ``plyfile.PlyParseError`` if a table can't be read.
    """
    plain = plain_header(data[: header.length])
    # plyfile would copy the rows, so it gets a header with 0 rows, to read only the properties.
    described = PlyData.read(io.BytesIO(_COUNT.sub(rb"\1 0", plain)))
    counts = [int(count) for _, count in _COUNT.findall(plain)]
    elements = list(zip(described.elements, counts, strict=True))
    if header.ascii:
        tables = read_text_tables(data, header.length, elements, columns)
    else:
        order = described.byte_order
        tables = read_binary_tables(data, header.length, elements, order, columns)
    return _tables_by_plyfile(data, plain, header, columns) if tables is None else tables


def plain_header(header: bytes) -> bytes:
    """Return the header without comments, which may have any encoding, and with single blanks between words."""
    lines = [" ".join(line.split()) for line in decoded(header).splitlines() if _KEPT.match(line)]
    return "\n".join([*lines, "end_header\n"]).encode("ascii", "replace")


def decoded(header: bytes) -> str:
    """Return a header as text: UTF-8, or Latin-1 if it is no UTF-8."""
    try:
        return header.decode("utf-8")
    except UnicodeDecodeError:
        return header.decode("latin-1")


def _tables_by_plyfile(
    data: bytes, plain: bytes, header: PlyHeader, columns: Mapping[str, Collection[str]]
) -> dict[str, Table]:
    """Read tables with plyfile, row by row; its errors name the wrong row."""
    with tempfile.TemporaryFile() as file:
        file.write(plain)
        file.write(memoryview(data)[header.length :])
        file.seek(0)
        try:
            with warnings.catch_warnings():
                # plyfile reads text with NumPy, which warns of empty lists.
                warnings.filterwarnings("ignore", "loadtxt: input contained no data")
                return {
                    element.name: _table_of_objects(element, columns[element.name])
                    for element in PlyData.read(file).elements
                    if element.name in columns
                }
        except PlyElementParseError as error:
            if error.row is None or "early end" not in error.message:
                raise
            raise MeshError(
                f"it is truncated: its header promises {error.element.count} rows of "
                f"{error.element.name!r}, and {error.row} are complete"
            ) from error


def _table_of_objects(element: PlyElement, column_names: Collection[str]) -> Table:
    """Return the table of an element of plyfile; plyfile stores lists as Python objects."""
    columns, lists = {}, {}
    for prop in element.properties:
        rows = element.data[prop.name]
        if isinstance(prop, PlyListProperty):
            counts = np.fromiter(map(len, rows), np.int32, len(rows))
            lists[prop.name] = Lists(np.concatenate([np.empty(0, np.int64), *rows]), counts)
        elif prop.name in column_names:
            columns[prop.name] = rows
    return Table(len(element.data), columns, lists)
