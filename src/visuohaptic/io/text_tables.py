"""Tables of numbers as text, as programs and spreadsheets of any locale write them.

Encoding, separator, header and decimal sign are decided once, and every row is held to the decision: a
decimal comma never becomes a separator, and an empty cell never shifts a row. pyarrow splits rows and parses
numbers, but has no way to find the separator and the decimal sign. `pandas.read_csv(sep=None)` and
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
MOST_COMMENTS = 100_000

# UTF-32's mark begins as UTF-16's does.
_ENCODINGS = {
    codecs.BOM_UTF8: "utf-8-sig",
    codecs.BOM_UTF32_LE: "utf-32",
    codecs.BOM_UTF32_BE: "utf-32",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
}
_SEPARATORS = (";", "\t", "|", ",", " ")
# Stands in no text file, so that each line is one cell.
_NO_SEPARATOR = "\x1f"
_COMMENT_SIGNS = ("#", "%", "//")
_BLANKS = " \v\f\u00a0"
_NUMBER = re.compile(
    r"[+-]?([0-9]+[.,]?[0-9]*|[.,][0-9]+)([eE][+-]?[0-9]+)?|[+-]?(nan|inf)", re.IGNORECASE
)
_WHOLE, _DIGITS = re.compile(r"[+-]?[0-9]+"), re.compile(r"[0-9]+([eE][+-]?[0-9]+)?")
_THOUSANDS = r"^[+-]?[1-9][0-9]{0,2}(,[0-9]{3})+$"
_PLAIN = "with one decimal sign and no thousands separators"
_ADVICE = "; if its commas are decimal signs, write points, or ; between the columns"


@dataclass(frozen=True, eq=False)
class TextTable:
    """Cells of a table, as text.

    `source` names the file in errors. `names` are those of the header, () without a header. `columns` hold
    the cells of one column each, `lines` (n,) the line of each row in the file, from 1.
    """

    source: str
    names: tuple[str, ...]
    columns: tuple[pa.ChunkedArray, ...]
    lines: IntArray

    def numbers(self, chosen: Sequence[int]) -> FloatArray:
        """Return the columns of some indices as finite numbers, shape (n, k), float64.

        Raises `TableError`, which names line and column, if a cell holds no finite number, or a comma may
        be a decimal sign or a thousands separator.
        """
        cells = {index: pc.replace_substring(self.columns[index], "−", "-") for index in chosen}
        with_comma = {index: pc.match_substring(column, ",") for index, column in cells.items()}
        if any(pc.any(column).as_py() for column in with_comma.values()):
            self._check_commas(cells, with_comma)
            cells = {index: pc.replace_substring(part, ",", ".") for index, part in cells.items()}
        found = [self._parsed(index, cells[index]) for index in chosen]
        return np.stack(found, axis=1) if found else np.empty((len(self.lines), 0))

    def place(self, row: int, column: int | None = None) -> str:
        """Say where a row, or a cell of it, is: ``poses.csv, line 3, column x``."""
        place = f"{self.source}, line {self.lines[row]}"
        if column is None:
            return place
        return f"{place}, column {self.names[column] if self.names else column + 1}"

    def _parsed(self, index: int, cells: pa.ChunkedArray) -> FloatArray:
        try:
            values: FloatArray = pc.cast(cells, pa.float64()).to_numpy()
        except pa.ArrowInvalid:
            texts = self.columns[index].to_pylist()
            row = next(row for row, text in enumerate(texts) if not _is_number(text))
            raise self._refused(row, index, "a number is needed") from None
        endless = np.flatnonzero(~np.isfinite(values))
        if len(endless):
            raise self._refused(int(endless[0]), index, "a finite number is needed")
        return values

    def _check_commas(
        self, cells: dict[int, pa.ChunkedArray], with_comma: dict[int, pa.ChunkedArray]
    ) -> None:
        index, rows = next(item for item in with_comma.items() if pc.any(item[1]).as_py())
        row = pc.index(rows, value=True).as_py()
        if not _is_number(self.columns[index][row].as_py()):
            raise self._refused(row, index, f"a number {_PLAIN} is needed")
        if any(pc.any(pc.match_substring(column, ".")).as_py() for column in cells.values()):
            raise self._refused(row, index, f"other cells have points; numbers {_PLAIN} are needed")
        without_thousands = (
            pc.and_not(rows, pc.match_substring_regex(cells[one], _THOUSANDS))
            for one, rows in with_comma.items()
        )
        if not any(pc.any(column).as_py() for column in without_thousands):
            reason = "its comma may be a decimal sign or part thousands; write decimal points"
            raise self._refused(row, index, reason)

    def _refused(self, row: int, index: int, reason: str) -> TableError:
        text = self.columns[index][row].as_py()
        return TableError(f"{self.place(row, index)} is {_short(text)}: {reason}.")


def read_text_table(
    data: bytes,
    source: str,
    most_rows: int,
    widths: Collection[int] = (),
    header: Collection[str] = (),
) -> TextTable:
    """Read a table of text: a line per row, with or without a header.

    Parameters
    ----------
    data : bytes
        The file: UTF-8, or with a byte order mark UTF-16 or UTF-32. Other bytes count as Latin-1, as no
        number has such. Empty lines, and those that begin with #, % or //, are no rows.
    source : str
        The file's name, for errors.
    most_rows : int
        More rows are refused.
    widths : collection of int
        The numbers of columns that a table without a header may have.
    header : collection of str
        A comment right above the first row is its header if it has as many names as the row has cells, and
        these among them.

    Returns
    -------
    TextTable
        Cells without quotes and blanks at their ends. Columns are parted by semicolons, tabs, bars, commas
        or blanks, whichever the first row has; blanks count as separators only where nothing else does.

    Raises
    ------
    TableError
        If it is no text, has no or too many rows, a row has another number of cells than the first, or its
        commas may be decimal signs or separators.
    """
    lines = _split_lines(_decoded(data, source), source, most_rows)
    rows = [(number, line) for number, line in lines if not _is_comment(line)]
    separator = None
    if rows and re.fullmatch("sep=.", rows[0][1], re.IGNORECASE):  # Excel's own line
        separator = rows.pop(0)[1][-1]
    if not rows:
        raise TableError(f"{source} holds no rows; a line of numbers is needed.")
    names: list[str] = []
    if _is_header(rows[0][1], separator):
        names, separator = _read_header(rows, separator, source)
        del rows[0]
    else:
        separator = separator or _separator_of_numbers(rows[0], source, widths)
        rows = [(number, line.split("#")[0]) for number, line in rows]
        names = _commented_header(lines, rows[0], separator, header)
    return _split_cells(rows, names, separator, source, most_rows)


def _decoded(data: bytes, source: str) -> str:
    encoding = next((_ENCODINGS[mark] for mark in _ENCODINGS if data.startswith(mark)), "utf-8")
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError as error:
        if encoding != "utf-8":
            raise TableError(
                f"{source} begins with the mark of {encoding.upper()}, and byte {error.start} is none "
                "of it; save it as UTF-8."
            ) from None
        text = data.decode("latin-1")
    if "\0" in text:
        raise TableError(
            f"{source} holds zero bytes, so it is no text, or UTF-16 without a byte order mark; save it as UTF-8."
        )
    return text


def _split_lines(text: str, source: str, most_rows: int) -> list[tuple[int, str]]:
    """Return the lines that are not empty, with their numbers from 1."""
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    if text.count("\n") > 2 * most_rows + MOST_COMMENTS:
        raise TableError(f"{source} has more than {most_rows:,} rows, which is the most.")
    return [(number, line) for number, line in enumerate(text.split("\n"), 1) if line.strip()]


def _is_comment(line: str) -> bool:
    return line.lstrip().startswith(_COMMENT_SIGNS)


def _cells(line: str, separator: str) -> list[str]:
    if separator == " ":
        line = " ".join(line.split())
    # A cell as long as the line is within the limits of the file.
    csv.field_size_limit(max(csv.field_size_limit(), len(line) + 1))
    (cells,) = csv.reader([line], delimiter=separator, skipinitialspace=True)
    return [cell.strip() for cell in cells]


def _is_number(text: str) -> bool:
    return _NUMBER.fullmatch(text.replace("−", "-")) is not None


def _is_header(line: str, separator: str | None) -> bool:
    """Whether a line has names: some text, and no number in any cell."""
    return not any(map(_is_number, _cells(line.strip(), separator or _first_separator(line))))


def _first_separator(line: str) -> str:
    bare = _unquoted(line)
    return next((one for one in _SEPARATORS if one in bare), _NO_SEPARATOR)


def _unquoted(line: str) -> str:
    """Return a line with a word in place of each cell in quotes."""
    return re.sub(r'"[^"]*"', "quoted", line).strip()


def _read_header(
    rows: list[tuple[int, str]], separator: str | None, source: str
) -> tuple[list[str], str]:
    """Return the names, and the separator by which the first row has as many cells as there are names."""
    (number, line), *others = rows[:2]
    if not others:
        raise TableError(f"{source} has a header in line {number} and no row of numbers below.")
    row_number, row = others[0]
    for one in [separator] if separator else _SEPARATORS:
        names, cells = _cells(line, one), _cells(row, one)
        if len(names) == len(cells) > 1:
            # Above decimal commas, commas and blanks may part the names.
            return [name.rstrip(",") for name in names] if one == " " else names, one
        # Programs end rows with a separator that the header lacks.
        if len(names) + 1 == len(cells) > 2 and not cells[-1]:
            return [*names, ""], one
    if not any(one in f"{line.strip()}{row.strip()}" for one in ";\t|") and "," not in line:
        return [line.strip()], _NO_SEPARATOR
    common = separator or _first_separator(line)
    raise TableError(
        f"{source}, line {row_number} has {len(_cells(row, common))} cells, and the header in line {number} "
        f"{len(_cells(line, common))} names{_ADVICE}."
    )


def _separator_of_numbers(first: tuple[int, str], source: str, widths: Collection[int]) -> str:
    """Return what parts the cells of a row of numbers without a header."""
    number, line = first
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
        and len(wholes) in (widths or {len(wholes)})
        and all(map(_WHOLE.fullmatch, wholes))
        and all(map(_DIGITS.fullmatch, digits))
    )
    if not may_be_decimal:
        return ","
    if len(cells) == 2 and len(cells) not in widths:
        return _NO_SEPARATOR
    if widths and len(cells) not in widths:
        return ","
    raise TableError(
        f"{source}, line {number}: its commas may part {len(cells)} whole numbers, or be decimal signs of "
        f"{len(wholes)} numbers; write decimal points, or ; between the columns."
    )


def _commented_header(
    lines: list[tuple[int, str]], first: tuple[int, str], separator: str, needed: Collection[str]
) -> list[str]:
    """Return the names of a comment right above the first row, [] if it is none that names columns."""
    above = [line for number, line in lines if number < first[0]][-1:]
    for line in above:
        names = _cells(line.lstrip("#%/ \t"), separator)
        known = {name.lower() for name in names}
        if needed and known >= set(needed) and len(names) == len(_cells(first[1], separator)):
            return names
    return []


def _split_cells(
    rows: list[tuple[int, str]], names: list[str], separator: str, source: str, most_rows: int
) -> TextTable:
    if len(rows) > most_rows:
        raise TableError(f"{source} has more than {most_rows:,} rows, which is the most.")
    # Below a header, a tab at an end may part an empty cell.
    ends = _BLANKS if names else None
    kept = [line.strip(ends) for _, line in rows]
    if separator == " ":
        kept = [" ".join(line.split()) for line in kept]
    width = len(names) or len(_cells(kept[0], separator))
    if width > MOST_COLUMNS:
        raise TableError(f"{source} has {width:,} columns; at most {MOST_COLUMNS:,} are allowed.")
    body = "\n".join([*kept, ""]).encode()
    wrong: list[InvalidRow] = []

    def keep(row: InvalidRow) -> str:
        wrong.append(row)
        return "skip"

    labels = list(map(str, range(width)))
    cells = read_csv(
        io.BytesIO(body),
        # One block, as a row must not be longer than that; one thread counts the rows.
        ReadOptions(use_threads=False, column_names=labels, block_size=len(body) + 1),
        ParseOptions(delimiter=separator, invalid_row_handler=keep),
        ConvertOptions(column_types=dict.fromkeys(labels, pa.string()), strings_can_be_null=False),
    )
    if wrong:
        row = wrong[0]
        raise TableError(
            f"{source}, line {rows[row.number - 1][0]} has {row.actual_columns} cells, and "
            f"{row.expected_columns} are needed as in {'the header' if names else 'the first row'}{_ADVICE}."
        )
    columns = [pc.utf8_trim_whitespace(column) for column in cells.columns]
    if (
        width > 1
        and not (names and names[-1])
        and not pc.any(pc.not_equal(columns[-1], "")).as_py()
    ):
        # Each row ends with a separator.
        del columns[-1], names[-1:]
    lines = np.array([number for number, _ in rows], dtype=np.int64)
    return TextTable(source, tuple(names), tuple(columns), lines)


def _short(text: str) -> str:
    if not text:
        return "empty"
    return repr(text if len(text) <= 40 else f"{text[:40]}…")
