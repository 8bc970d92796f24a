"""Read tables of numbers as text, as programs and spreadsheets of any locale write them.

Encoding, separator and header are decided once per file, and every row must follow. The decimal sign is decided once
for the columns that are converted together. A row of whole numbers and commas that can be read in two ways is refused,
so that a decimal comma does not become a separator. An empty cell counts as a cell, so that no row shifts. pyarrow
splits rows and parses numbers, but can't detect the separator and the decimal sign. `pandas.read_csv(sep=None)` and
`csv.Sniffer` guess both, and read ``0,1 0,2 0,3`` as four columns.
"""

from __future__ import annotations

import codecs
import csv
import io
import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from pyarrow.csv import ConvertOptions, InvalidRow, ParseOptions, ReadOptions, read_csv

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import TableError

MOST_COLUMNS = 1000
"""Largest number of columns of a table."""
LONGEST_LINE = 1_000_000
"""Largest number of characters of a line; a line of separators takes some 20 bytes per character."""
MOST_COMMENTS = 100_000
"""A file may have this many lines more than two per allowed row, for comments and empty lines."""

# UTF-32 before UTF-16: the little-endian mark of UTF-32 begins with that of UTF-16.
_ENCODINGS = {
    codecs.BOM_UTF8: "utf-8-sig",
    codecs.BOM_UTF32_LE: "utf-32",
    codecs.BOM_UTF32_BE: "utf-32",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
}
_SEPARATORS = (";", "\t", "|", ",", " ")
# With this separator, a control character that text files do not use, each line is one cell.
_NO_SEPARATOR = "\x1f"
_COMMENT_SIGNS = ("#", "%", "//")
_BLANKS = " \v\f\u00a0"
_NUMBER = re.compile(
    r"[+-]?([0-9]+[.,]?[0-9]*|[.,][0-9]+)([eE][+-]?[0-9]+)?|[+-]?(nan|inf)", re.IGNORECASE
)
_WHOLE, _DIGITS = re.compile(r"[+-]?[0-9]+"), re.compile(r"[0-9]+([eE][+-]?[0-9]+)?")
_THOUSANDS = r"^[+-]?[1-9][0-9]{0,2}(,[0-9]{3})+$"
_PLAIN_NUMBERS = "with one decimal sign and no thousands separators"
_COMMA_ADVICE = "; if its commas are decimal signs, write points, or ; between the columns"


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
        """Return the columns with the indices `chosen` as finite numbers, shape (n, k), float64.

        The decimal sign is found in all chosen columns together, so call once for all columns of numbers. Commas are
        decimal signs if no chosen cell has a point, and in some chosen cell the comma can't separate thousands:
        ``0,5`` or ``1,2345``, but not ``1,234``. Otherwise a comma raises `TableError`, as does a cell without a finite
        number. The error names line and column.
        """
        cells = {index: pc.replace_substring(self.columns[index], "−", "-") for index in chosen}
        has_comma = {index: pc.match_substring(column, ",") for index, column in cells.items()}
        if any(pc.any(column).as_py() for column in has_comma.values()):
            self._check_commas(cells, has_comma)
            cells = {
                index: pc.replace_substring(column, ",", ".") for index, column in cells.items()
            }
        if not chosen:
            return np.empty((len(self.lines), 0))
        return np.stack([self._parsed(index, cells[index]) for index in chosen], axis=1)

    def position(self, row: int, column: int | None = None) -> str:
        """Return the position of a row or cell in the file, for errors: ``poses.csv, line 3, column x``.

        `row` and `column` are indices from 0. Without a header, the column is named by its number from 1.
        """
        line = f"{self.source}, line {self.lines[row]}"
        if column is None:
            return line
        return f"{line}, column {self.names[column] if self.names else column + 1}"

    def _parsed(self, index: int, cells: pa.ChunkedArray) -> FloatArray:
        """Return the cells of a column, with decimal points, as finite numbers."""
        try:
            values: FloatArray = pc.cast(cells, pa.float64()).to_numpy()
        except pa.ArrowInvalid:
            texts = self.columns[index].to_pylist()
            row = next(row for row, text in enumerate(texts) if not _is_number(text))
            raise self._error(row, index, "a number is needed") from None
        infinite = np.flatnonzero(~np.isfinite(values))
        if len(infinite):
            raise self._error(int(infinite[0]), index, "a finite number is needed")
        return values

    def _check_commas(
        self, cells: dict[int, pa.ChunkedArray], has_comma: dict[int, pa.ChunkedArray]
    ) -> None:
        """Raise `TableError` unless commas are decimal signs; cells, and whether each has a comma, by column index."""
        index, rows = next(item for item in has_comma.items() if pc.any(item[1]).as_py())
        row = pc.index(rows, value=True).as_py()
        if not _is_number(self.columns[index][row].as_py()):
            raise self._error(row, index, f"a number {_PLAIN_NUMBERS} is needed")
        if any(pc.any(pc.match_substring(column, ".")).as_py() for column in cells.values()):
            raise self._error(
                row, index, f"other cells have points; numbers {_PLAIN_NUMBERS} are needed"
            )
        without_thousands = (
            pc.and_not(rows, pc.match_substring_regex(cells[column], _THOUSANDS))
            for column, rows in has_comma.items()
        )
        if not any(pc.any(column).as_py() for column in without_thousands):
            reason = "its comma may be a decimal sign or separate thousands; write decimal points"
            raise self._error(row, index, reason)

    def _error(self, row: int, index: int, reason: str) -> TableError:
        text = self.columns[index][row].as_py()
        return TableError(f"{self.position(row, index)} is {_short(text)}: {reason}.")


def read_text_table(
    data: bytes,
    source: str,
    most_rows: int,
    usual_widths: Collection[int] = (),
    header_names: Collection[str] = (),
) -> TextTable:
    """Read a table from the bytes of a text file: one row per line, with or without a header.

    The first line that is no comment is the header if none of its cells is a number. The separator is then the first of
    semicolon, tab, bar, comma and blank that divides the header and the row below into equally many cells, at least
    two. Without a header, the first row decides: semicolon, tab or bar if the row has any; else blanks if they
    separate cells; else commas. A first line ``sep=;``, which Excel writes, decides before these rules.

    Parameters
    ----------
    data : bytes
        Content of the file: UTF-8, or UTF-16 or UTF-32 with a byte order mark. Other bytes are read as Latin-1.
        Empty lines and lines that begin with #, % or // are skipped. In a table without a header, # and all that
        follows in the line is skipped too.
    source : str
        Name of the file, for errors.
    most_rows : int
        Largest number of rows that is allowed.
    usual_widths : collection of int
        Numbers of columns that are expected without a header. They only decide whether commas in the first row are
        separators or decimal signs, if no other separator is there. A table of any other number of columns is read
        all the same. A first row ``1,2`` is one number, 1.2, unless 2 columns are expected.
    header_names : collection of str
        Names in lower case. Above a first row of numbers, a comment is the header if it has all these names, in any
        case, and as many names as the row has cells. By default no comment is a header.

    Returns
    -------
    TextTable
        Cells without quotes and without blanks at their ends. If all rows end with a separator, the empty column
        behind it is dropped.

    Raises
    ------
    TableError
        If the file is no text, or has no rows, more than `most_rows` rows or more than `MOST_COLUMNS` columns, or a
        line has more than `LONGEST_LINE` characters. Also if
        a row has another number of cells than the header or the first row, or if commas in the first row may be
        either decimal signs or separators.
    """
    lines = _split_lines(_decoded(data, source), source, most_rows)
    rows = [(number, line) for number, line in lines if not _is_comment(line)]
    separator = None
    if rows and re.fullmatch("sep=.", rows[0][1], re.IGNORECASE):
        separator = rows.pop(0)[1][-1]
    if not rows:
        raise TableError(f"{source} holds no rows; at least one line of numbers is needed.")
    names: list[str] = []
    if _is_header(rows[0][1], separator):
        names, separator = _read_header(rows, separator, source)
        del rows[0]
    else:
        separator = separator or _separator_of_numbers(rows[0], source, usual_widths)
        rows = [(number, line.split("#")[0]) for number, line in rows]
        names = _commented_header(lines, rows[0], separator, header_names)
    return _split_cells(rows, names, separator, source, most_rows)


def _decoded(data: bytes, source: str) -> str:
    """Return the text of a file without its byte order mark."""
    encoding = next((_ENCODINGS[mark] for mark in _ENCODINGS if data.startswith(mark)), "utf-8")
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError as error:
        if encoding != "utf-8":
            raise TableError(
                f"{source} begins with the byte order mark of {encoding.upper()}, but byte {error.start} is invalid "
                "there; save the file as UTF-8."
            ) from None
        text = data.decode("latin-1")
    if "\0" in text:
        raise TableError(
            f"{source} holds zero bytes: it is no text, or UTF-16 without a byte order mark; save it as UTF-8."
        )
    return text


def _split_lines(text: str, source: str, most_rows: int) -> list[tuple[int, str]]:
    """Return (number from 1, line) of each line that is not empty, comments included."""
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    if text.count("\n") > 2 * most_rows + MOST_COMMENTS:
        raise TableError(
            f"{source} has more than {most_rows:,} rows; at most {most_rows:,} are allowed."
        )
    lines = [(number, line) for number, line in enumerate(text.split("\n"), 1) if line.strip()]
    number, longest = max(lines, key=lambda pair: len(pair[1]), default=(0, ""))
    if len(longest) > LONGEST_LINE:
        raise TableError(
            f"{source}, line {number} has {len(longest):,} characters; at most {LONGEST_LINE:,} are allowed."
        )
    return lines


def _is_comment(line: str) -> bool:
    return line.lstrip().startswith(_COMMENT_SIGNS)


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
    return _NUMBER.fullmatch(text.replace("−", "-")) is not None


def _is_header(line: str, separator: str | None) -> bool:
    """Return whether a line is a header: no cell is a number; None takes the line's first separator."""
    return not any(map(_is_number, _cells(line.strip(), separator or _first_separator(line))))


def _first_separator(line: str) -> str:
    """Return the first of `_SEPARATORS` that is in a line outside of quotes, or `_NO_SEPARATOR`."""
    bare = _unquoted(line)
    return next((separator for separator in _SEPARATORS if separator in bare), _NO_SEPARATOR)


def _unquoted(line: str) -> str:
    """Return a line with each text in quotes replaced, so that no separator is inside a cell."""
    return re.sub(r'"[^"]*"', "quoted", line).strip()


def _read_header(
    rows: list[tuple[int, str]], separator: str | None, source: str
) -> tuple[list[str], str]:
    """Return the names in the header, and the separator; header and row below have equally many cells."""
    number, line = rows[0]
    if len(rows) == 1:
        raise TableError(f"{source} has a header in line {number} and no row of numbers below.")
    row_number, row = rows[1]
    for candidate in [separator] if separator else _SEPARATORS:
        names, cells = _cells(line, candidate), _cells(row, candidate)
        if len(names) == len(cells) > 1:
            if candidate == " ":
                # Above rows of decimal commas, names may be separated by a comma and a blank.
                names = [name.rstrip(",") for name in names]
            return names, candidate
        # Some programs end rows, but not the header, with a separator.
        if len(names) + 1 == len(cells) > 2 and not cells[-1]:
            return [*names, ""], candidate
    both_lines = f"{line.strip()}{row.strip()}"
    if "," not in line and not any(candidate in both_lines for candidate in ";\t|"):
        return [line.strip()], _NO_SEPARATOR
    common = separator or _first_separator(line)
    raise TableError(
        f"{source}, line {row_number} has {len(_cells(row, common))} cells, and the header in line {number} "
        f"{len(_cells(line, common))} names{_COMMA_ADVICE}."
    )


def _separator_of_numbers(
    first_row: tuple[int, str], source: str, usual_widths: Collection[int]
) -> str:
    """Return the separator of a table without a header, from its first row; raise `TableError` if unclear."""
    number, line = first_row
    bare = _unquoted(line.split("#")[0])
    for separator in _SEPARATORS[:3]:
        if separator in bare:
            return separator
    if re.search(r"[^\s,]\s+[^\s,]", bare):
        return " "
    if "," not in bare:
        return _NO_SEPARATOR
    cells = _cells(bare, ",")
    wholes, digits = cells[::2], cells[1::2]
    may_be_decimal = (
        len(wholes) == len(digits)
        and len(wholes) in (usual_widths or {len(wholes)})
        and all(map(_WHOLE.fullmatch, wholes))
        and all(map(_DIGITS.fullmatch, digits))
    )
    if not may_be_decimal:
        return ","
    if len(cells) == 2 and len(cells) not in usual_widths:
        return _NO_SEPARATOR
    if usual_widths and len(cells) not in usual_widths:
        return ","
    raise TableError(
        f"{source}, line {number}: its commas may separate {len(cells)} whole numbers, or be decimal signs of "
        f"{len(wholes)} numbers; write decimal points, or ; between the columns."
    )


def _commented_header(
    lines: list[tuple[int, str]],
    first_row: tuple[int, str],
    separator: str,
    needed_names: Collection[str],
) -> list[str]:
    """Return the names in the comment right above the first row; [] if the comment is no header."""
    row_number, row = first_row
    lines_above = [line for number, line in lines if number < row_number]
    if not lines_above or not needed_names:
        return []
    names = _cells(lines_above[-1].lstrip("#%/ \t"), separator)
    has_needed = {name.lower() for name in names} >= set(needed_names)
    return names if has_needed and len(names) == len(_cells(row, separator)) else []


def _split_cells(
    rows: list[tuple[int, str]], names: list[str], separator: str, source: str, most_rows: int
) -> TextTable:
    """Return the table of all rows; raise `TableError` if a row has another number of cells than the table."""
    if len(rows) > most_rows:
        raise TableError(
            f"{source} has more than {most_rows:,} rows; at most {most_rows:,} are allowed."
        )
    # Below a header, a tab at the end of a line may separate an empty cell.
    stripped = _BLANKS if names else None
    lines = [line.strip(stripped) for _, line in rows]
    if separator == " ":
        lines = [" ".join(line.split()) for line in lines]
    width = len(names) or len(_cells(lines[0], separator))
    if width > MOST_COLUMNS:
        raise TableError(f"{source} has {width:,} columns; at most {MOST_COLUMNS:,} are allowed.")
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
            f"{source}, line {rows[row.number - 1][0]} has {row.actual_columns} cells; "
            f"{row.expected_columns} are needed, as in {'the header' if names else 'the first row'}{_COMMA_ADVICE}."
        )
    columns = [pc.utf8_trim_whitespace(column) for column in cells.columns]
    if (
        width > 1
        and not (names and names[-1])
        and not pc.any(pc.not_equal(columns[-1], "")).as_py()
    ):
        # Every row ends with a separator, which makes an empty last column.
        del columns[-1], names[-1:]
    line_numbers = np.array([number for number, _ in rows], dtype=np.int64)
    return TextTable(source, tuple(names), tuple(columns), line_numbers)


def _short(text: str) -> str:
    """Return a cell in quotes for errors, at most 40 characters; "empty" for an empty cell."""
    if not text:
        return "empty"
    return repr(text if len(text) <= 40 else f"{text[:40]}…")
