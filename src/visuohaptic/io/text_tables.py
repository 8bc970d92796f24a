"""Read tables of numbers as text, as spreadsheets and other programs write them.

Encoding, separator and header are found from the first lines, and every row must follow. The decimal sign is found for
the columns that are converted together. pyarrow splits rows and parses numbers, but can't find separator and decimal
sign. `pandas.read_csv(sep=None)` and `csv.Sniffer` guess both, and read ``0,1 0,2 0,3`` as four columns.
"""

from __future__ import annotations

import codecs
import csv
import io
import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from pyarrow.csv import ConvertOptions, InvalidRow, ParseOptions, ReadOptions, read_csv

from meshreaders.base.regular_files import open_regular, read_bounded
from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import ParameterError, TableError

MOST_COLUMNS = 1000
"""Largest number of columns of a table."""

_NUMBER = re.compile(
    r"[+-]?([0-9]+[.,]?[0-9]*|[.,][0-9]+)([eE][+-]?[0-9]+)?|[+-]?(nan|inf)", re.IGNORECASE
)
_THOUSANDS = r"^[+-]?[1-9][0-9]{0,2}(,[0-9]{3})+$"
_COMMA_ADVICE = "if its commas are decimal signs, write points, or ; between the columns"


@dataclass(frozen=True, eq=False)
class TextTable:
    """A table of text cells.

    Attributes
    ----------
    source : str
        Name of the file, for errors.
    names : tuple of str
        Names in the header as written; () without a header.
    columns : tuple of pyarrow.ChunkedArray
        Cells of each column, as text.
    lines : ndarray of shape (n,)
        Line number of each row in the file, from 1.
    """

    source: str
    names: tuple[str, ...]
    columns: tuple[pa.ChunkedArray, ...]
    lines: IntArray

    def numbers(self, chosen: Sequence[int]) -> FloatArray:
        """Return the columns with the indices `chosen`, at least one, as finite numbers, shape (n, k), float64.

        The decimal sign is found in all chosen columns together, so call once for all columns of numbers. Commas are
        decimal signs if no chosen cell has a point, and in some chosen cell the comma can't separate thousands:
        ``0,5`` or ``1,2345``, but not ``1,234``. Otherwise a comma raises `TableError`, as does a cell without a finite
        number. The error names line and column.
        """
        has_commas = self._has_decimal_commas(chosen)
        return np.stack([self._parsed(index, has_commas) for index in chosen], axis=1)

    def position(self, row: int, column: int | None = None) -> str:
        """Return the position of a row or cell in the file, for errors: ``poses.csv, line 3, column x``.

        `row` and `column` are indices from 0. Without a header, the column is named by its number from 1.
        """
        line = f"{self.source}, line {self.lines[row]}"
        if column is None:
            return line
        return f"{line}, column {self.names[column] if self.names else column + 1}"

    def _parsed(self, index: int, has_commas: bool) -> FloatArray:  # noqa: FBT001
        """Return the cells of a column as finite numbers."""
        cells = self.columns[index]
        if has_commas:
            cells = pc.replace_substring(cells, ",", ".")
        try:
            values: FloatArray = pc.cast(cells, pa.float64()).to_numpy()
        except pa.ArrowInvalid:
            row = next(row for row, text in enumerate(cells.to_pylist()) if not _is_number(text))
            raise self._error(row, index, "a number is needed") from None
        infinite = np.flatnonzero(~np.isfinite(values))
        if len(infinite):
            raise self._error(int(infinite[0]), index, "a finite number is needed")
        return values

    def _has_decimal_commas(self, chosen: Sequence[int]) -> bool:
        """Return whether cells of the chosen columns have commas; raise `TableError` if they may not be decimal signs."""
        has_comma = {index: pc.match_substring(self.columns[index], ",") for index in chosen}
        index = next((index for index in chosen if pc.any(has_comma[index]).as_py()), None)
        if index is None:
            return False
        row = pc.index(has_comma[index], value=True).as_py()
        if any(pc.any(pc.match_substring(self.columns[one], ".")).as_py() for one in chosen):
            reason = "a number with one decimal sign and no thousands separators is needed"
            raise self._error(row, index, f"{reason}, the same sign in all cells")
        may_be_thousands = (
            pc.or_(pc.invert(rows), pc.match_substring_regex(self.columns[one], _THOUSANDS))
            for one, rows in has_comma.items()
        )
        if all(pc.all(column).as_py() for column in may_be_thousands):
            reason = "its comma may be a decimal sign or separate thousands; write decimal points"
            raise self._error(row, index, reason)
        return True

    def _error(self, row: int, index: int, reason: str) -> TableError:
        text = self.columns[index][row].as_py()
        shown = repr(text if len(text) <= 40 else f"{text[:40]}…") if text else "empty"
        return TableError(f"{self.position(row, index)} is {shown}: {reason}.")


def read_table_file(
    path: str | Path, most_rows: int, largest_bytes: int, content: str
) -> TextTable:
    """Read a table from a text file as `read_text_table`; `content` says what the file holds, such as ``poses``.

    Raises `ParameterError` if the file can't be read, has more than `largest_bytes`, or is no such table.
    """
    try:
        with open_regular(path) as stream:
            data = read_bounded(stream, largest_bytes)
    except OSError as error:
        raise ParameterError(f"{path} can't be read: {error.strerror}.") from error
    if len(data) > largest_bytes:
        raise ParameterError(
            f"{path} is larger than {largest_bytes / 1e6:g} MB, the limit of a file of {content}."
        )
    try:
        return read_text_table(data, str(path), most_rows)
    except TableError as error:
        raise ParameterError(str(error)) from error


def read_text_table(
    data: bytes, source: str, most_rows: int, header_names: Collection[str] = ()
) -> TextTable:
    """Read a table from the bytes of a text file: one row per line, with or without a header.

    The first line is the header if none of its cells is a number. This line also decides on the separator: a semicolon
    or tab if the line has one, else blanks between numbers, else a comma, else blanks.

    Parameters
    ----------
    data : bytes
        Content of the file: UTF-8, or UTF-16 with a byte order mark. Other bytes are read as Latin-1. Empty lines,
        lines that begin with #, and Excel's line ``sep=;`` are skipped.
    source : str
        Name of the file, for errors.
    most_rows : int
        Largest number of rows that is allowed.
    header_names : collection of str
        Names in lower case. Right above a first row of numbers, a comment is the header if it has all these names, in
        any case, and as many names as the row has cells. By default no comment is a header.

    Returns
    -------
    TextTable
        Cells without quotes and without blanks at their ends.

    Raises
    ------
    TableError
        If the file is no text, or has no rows, more than `most_rows` rows or more than `MOST_COLUMNS` columns. Also if a
        row has another number of cells than the header or the first row, or if the first row has no header
        and only whole numbers between commas, which may be decimal signs.
    """
    text = _decoded(data, source).replace("\r\n", "\n").replace("\r", "\n")
    lines = [(number, line) for number, line in enumerate(text.split("\n"), 1) if line.strip()]
    rows = [(number, line) for number, line in lines if not re.match(r"\s*#|sep=.$", line)]
    if not rows:
        raise TableError(f"{source} holds no rows; at least one line of numbers is needed.")
    first, line = rows[0]
    separator = _separator_of(line)
    width = len(line.split()) if separator == " " else line.count(separator) + 1
    if width > MOST_COLUMNS:
        raise TableError(
            f"{source}, line {first} has {width:,} columns; at most {MOST_COLUMNS:,} are allowed."
        )
    names: list[str] = []
    cells = _cells(line, separator)
    if not any(map(_is_number, cells)):
        names = cells
        del rows[0]
        if not rows:
            raise TableError(f"{source} has a header in line {first} and no row of numbers below.")
    elif separator == "," and all(map(_is_whole, cells)):
        raise TableError(
            f"{source}, line {first}: its commas may separate {len(cells)} whole numbers, or be decimal signs; write "
            "decimal points, or ; between the columns."
        )
    elif header_names:
        above = next((line for number, line in reversed(lines) if number < first), "")
        commented = _cells(above.lstrip("# \t"), _separator_of(above))
        if {*header_names} <= {name.lower() for name in commented} and len(commented) == len(cells):
            names = commented
    if len(rows) > most_rows:
        raise TableError(
            f"{source} has more than {most_rows:,} rows; at most {most_rows:,} are allowed."
        )
    return _split_cells(rows, names, len(cells), separator, source)


def _decoded(data: bytes, source: str) -> str:
    """Return the text of a file without its byte order mark."""
    has_mark = data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    try:
        text = data.decode("utf-16" if has_mark else "utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    if "\0" in text:
        raise TableError(
            f"{source} holds zero bytes: it is no text, or UTF-16 without a byte order mark; save it as UTF-8."
        )
    return text


def _separator_of(line: str) -> str:
    """Return the separator of a line: semicolon, tab, comma or blank."""
    bare = line.replace('"', "")
    for separator in ";\t":
        if separator in bare:
            return separator
    has_blanks = re.search(r"[0-9.]\s+[-+.,0-9]", bare)
    return "," if "," in bare and not has_blanks else " "


def _cells(line: str, separator: str) -> list[str]:
    """Return the cells of a line, without quotes and without blanks at their ends."""
    if separator == " ":
        line = " ".join(line.split())
    # A cell may be as long as its line; the size of the file is limited elsewhere.
    csv.field_size_limit(max(csv.field_size_limit(), len(line) + 1))
    (cells,) = csv.reader([line], delimiter=separator, skipinitialspace=True)
    return [cell.strip() for cell in cells]


def _is_number(text: str) -> bool:
    """Return whether a text is one number, with at most one point or comma; NaN and infinity count."""
    return _NUMBER.fullmatch(text) is not None


def _is_whole(text: str) -> bool:
    """Return whether a text has digits without a decimal sign, also before an exponent."""
    return re.fullmatch("[+-]?[0-9]+([eE][+-]?[0-9]+)?", text) is not None


def _split_cells(
    rows: list[tuple[int, str]], names: list[str], width: int, separator: str, source: str
) -> TextTable:
    """Return the table of all rows; raise `TableError` if a row has another number of cells than `width`."""
    lines = [line for _, line in rows]
    if separator == " ":
        lines = [" ".join(line.split()) for line in lines]
    body = "\n".join([*lines, ""]).encode()
    invalid_rows: list[InvalidRow] = []

    def note(row: InvalidRow) -> str:
        invalid_rows.append(row)
        return "skip"

    labels = list(map(str, range(width)))
    cells = read_csv(
        io.BytesIO(body),
        # One block, because a row must fit into a block. One thread, so that rows are counted in order.
        ReadOptions(use_threads=False, column_names=labels, block_size=len(body) + 1),
        ParseOptions(delimiter=separator, invalid_row_handler=note),
        ConvertOptions(column_types=dict.fromkeys(labels, pa.string()), strings_can_be_null=False),
    )
    if invalid_rows:
        row = invalid_rows[0]
        raise TableError(
            f"{source}, line {rows[row.number - 1][0]} has {row.actual_columns:,} cells; {row.expected_columns} are "
            f"needed, as in {'the header' if names else 'the first row'}; {_COMMA_ADVICE}."
        )
    columns = tuple(pc.utf8_trim_whitespace(column) for column in cells.columns)
    line_numbers = np.array([number for number, _ in rows], dtype=np.int64)
    return TextTable(source, tuple(names), columns, line_numbers)
