"""The rows of a PLY file as a table per element."""

from __future__ import annotations

import io
import re
import tempfile
import warnings
from collections.abc import Collection, Mapping

import numpy as np
from plyfile import PlyData, PlyElement, PlyElementParseError, PlyListProperty

from visuohaptic.base.errors import MeshError
from visuohaptic.geometry.ply_header import PlyHeader
from visuohaptic.meshes.ply_binary import read_binary_tables
from visuohaptic.meshes.ply_columns import Lists, Table
from visuohaptic.meshes.ply_text import read_text_tables

_KEPT = re.compile(r"\s*(?:ply|format|element|property)\b")
_COUNT = re.compile(rb"^(element \S+) (\d+)$", re.MULTILINE)


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
    elements = list(zip(described.elements, counts, strict=True))
    if header.ascii:
        tables = read_text_tables(data, header.length, elements, columns)
    else:
        order = described.byte_order
        tables = read_binary_tables(data, header.length, elements, order, columns)
    return _tables_by_plyfile(data, plain, header, columns) if tables is None else tables


def plain_header(header: bytes) -> bytes:
    """Return the header without comments, which may be in any encoding, and with one blank between words."""
    lines = [" ".join(line.split()) for line in decoded(header).splitlines() if _KEPT.match(line)]
    return "\n".join([*lines, "end_header\n"]).encode("ascii", "replace")


def decoded(header: bytes) -> str:
    """Return a header as text, UTF-8 or else Latin-1."""
    try:
        return header.decode("utf-8")
    except UnicodeDecodeError:
        return header.decode("latin-1")


def _tables_by_plyfile(
    data: bytes, plain: bytes, header: PlyHeader, columns: Mapping[str, Collection[str]]
) -> dict[str, Table]:
    """Read tables with plyfile, row by row; its errors say which row is wrong."""
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
    """Return the table of an element of plyfile, whose lists are objects."""
    columns, lists = {}, {}
    for one in element.properties:
        rows = element.data[one.name]
        if isinstance(one, PlyListProperty):
            counts = np.fromiter(map(len, rows), np.int32, len(rows))
            lists[one.name] = Lists(np.concatenate([np.empty(0, np.int64), *rows]), counts)
        elif one.name in wanted:
            columns[one.name] = rows
    return Table(len(element.data), columns, lists)
