"""Tables of numbers as text are read as they were written, or refused by the true reason."""

import csv
import io

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from visuohaptic.base.errors import TableError
from visuohaptic.io.text_tables import read_text_table

FINITE = st.floats(allow_nan=False, allow_infinity=False)
USUAL = st.floats(-1000, 1000).map(lambda value: float(f"{value:.4g}"))
TEXT = st.text("abc ,;é\"'", min_size=1, max_size=6).map(lambda text: f"a{text}a")


def read(text, encoding="utf-8"):
    table = read_text_table(text.encode(encoding), "table.txt", 1000, {"x", "y"})
    return table.names, table.numbers(range(len(table.columns))).tolist()


@st.composite
def written(draw):
    """A table of numbers and a text column, as a spreadsheet of some locale writes it."""
    width = draw(st.integers(1, 5))
    numbers = st.lists(draw(st.sampled_from([FINITE, USUAL])), min_size=width, max_size=width)
    rows = draw(st.lists(numbers, min_size=1, max_size=5))
    separator, decimal = draw(
        st.sampled_from(
            [
                (",", "."),
                (";", "."),
                ("\t", "."),
                (" ", "."),
                (";", ","),
                ("\t", ","),
                (" ", ","),
                (",", ","),
            ]
        )
    )
    names = [f"name{index}" for index in range(width)] if draw(st.booleans()) else []
    texts = draw(st.lists(TEXT, min_size=len(rows), max_size=len(rows))) if names else []
    cells = [[repr(value).replace(".", decimal) for value in row] for row in rows]
    if texts:
        cells = [[*row, text] for row, text in zip(cells, texts, strict=True)]
    stream = io.StringIO()
    ending = draw(st.sampled_from(["\n", "\r\n", "\r"]))
    writer = csv.writer(
        stream,
        delimiter=separator,
        lineterminator=ending,
        quoting=draw(st.sampled_from([csv.QUOTE_MINIMAL, csv.QUOTE_ALL])),
    )
    writer.writerows([[*names, "text"], *cells] if names else cells)
    encoding = draw(st.sampled_from(["utf-8", "utf-8-sig", "utf-16"]))
    comment = draw(st.sampled_from(["", "# a comment, with; signs\n", "\n\n"]))
    return rows, (comment + stream.getvalue()).encode(encoding)


@settings(max_examples=300)
@given(written())
def test_a_table_of_any_locale_is_read_equal_or_refused_for_its_commas(table):
    rows, data = table
    values, sentence = read_or_refused(data)
    if sentence:
        # The only tables that can be read in two ways have commas.
        assert "comma" in sentence
        return
    np.testing.assert_array_equal(values, rows)


@settings(max_examples=300)
@given(st.text('0123456789.,;-e \t\n#"xy|', max_size=60))
def test_any_text_is_read_or_refused_in_a_sentence(text):
    _, sentence = read_or_refused(text.encode())
    assert sentence.startswith("table.txt" if sentence else "")
    assert "\n" not in sentence


def read_or_refused(data):
    """The numbers of all columns but a last one of text, and the sentence of a refusal."""
    try:
        table = read_text_table(data, "table.txt", 1000)
        has_text = table.names[-1:] == ("text",)
        return table.numbers(range(len(table.columns) - has_text)), ""
    except TableError as error:
        return None, str(error)


@pytest.mark.parametrize(
    ("text", "rows"),
    [
        ("0,1 0,2\n0,4 1\n", [[0.1, 0.2], [0.4, 1]]),
        ("0.1, 0.2\n0.4, 1\n", [[0.1, 0.2], [0.4, 1]]),
        ("  0.1   0.2 \n\n0.4\t1\n", [[0.1, 0.2], [0.4, 1]]),
        ("0,1;0,2\n0,4;1\n", [[0.1, 0.2], [0.4, 1]]),
        ('"0,1","0,2"\n"0,4","1"\n', [[0.1, 0.2], [0.4, 1]]),
        ("0.1 0.2\n# second\n0.4 1", [[0.1, 0.2], [0.4, 1]]),
        ("-0.1 +0.2\n.4 1.", [[-0.1, 0.2], [0.4, 1]]),
        ("0.5\n1.25\n", [[0.5], [1.25]]),
        ("1,2.5,3\n1,2,3\n", [[1, 2.5, 3], [1, 2, 3]]),
    ],
)
def test_rows_of_numbers_without_a_header_are_read(text, rows):
    assert read(text) == ((), rows)


@pytest.mark.parametrize(
    ("text", "names", "rows"),
    [
        ("sep=;\nx;y\n0,1;0,2\n", ("x", "y"), [[0.1, 0.2]]),
        ("x y\n0,1 0,2\n", ("x", "y"), [[0.1, 0.2]]),
        ("x, y\n0.1, 0.2\n", ("x", "y"), [[0.1, 0.2]]),
        ("the x,y\n1,2\n", ("the x", "y"), [[1, 2]]),
        ("y\n0,5\n", ("y",), [[0.5]]),
        ("# y x\n1 2\n", ("y", "x"), [[1, 2]]),
        ("# y x of a part\n1 2\n", (), [[1, 2]]),
    ],
)
def test_a_header_names_the_columns(text, names, rows):
    assert read(text) == (names, rows)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("x\ty\n0.1\t\n", "line 2, column y is empty: a number is needed"),
        ("\n1 2\n3 4 5\n", "line 3 has 3 cells; 2 are needed, as in the first row"),
        (
            "x,y\n0,5,1,2\n",
            "line 2 has 4 cells; 2 are needed, as in the header; if its commas are decimal signs",
        ),
        (
            "0,5,1,25\n",
            "line 1: its commas may separate 4 whole numbers, or be decimal signs; write",
        ),
        (
            "1,234;1,500\n",
            "column 1 is '1,234': its comma may be a decimal sign or separate thousands",
        ),
        ("1,5;2.5\n", "column 1 is '1,5': a number with one decimal sign .* the same sign in all"),
        ("1.234,5;2\n", r"column 1 is '1\.234,5': a number with one decimal sign and no thousands"),
        ("0,5\n1,25\n", "may separate 2 whole numbers, or be decimal signs"),
        ("x|y\n1|2\n", r"line 2, column x\|y is '1\|2': a number is needed"),
        ("x;y\n1;2;\n", "line 2 has 3 cells; 2 are needed"),
        ("1 2 # of a part\n3 4\n", "line 2 has 2 cells; 6 are needed"),
        ("−1 2\n", "column 1 is '−1': a number is needed"),
        ("1 2\n3 a\n", "line 2, column 2 is 'a'"),
        ("1 1_0\n", "column 2 is '1_0'"),
        ("1 1e400\n", "column 2 is '1e400': a finite number"),
        ("1 ١\n", "column 2 is '١'"),
        ("x,y\n", "header in line 1 and no row"),
        ("# 1 2\n", "no rows"),
        ("1\n" * 1001, "more than 1,000 rows"),
        (" ".join(["1"] * 1001), "1,001 columns"),
    ],
)
def test_what_is_no_table_of_numbers_is_refused_with_its_place(text, sentence):
    with pytest.raises(TableError, match=sentence):
        read(text)


def test_text_without_a_byte_order_mark_is_utf_8_or_latin_1():
    assert read("Größe\n1\n", encoding="latin-1") == (("Größe",), [[1]])
    with pytest.raises(TableError, match=r"UTF-16 without a byte order mark"):
        read("x y\n1 2\n", encoding="utf-16-le")


@pytest.mark.parametrize("separator", [",", " "])
def test_a_line_of_very_many_cells_is_refused_by_its_number(separator):
    line = f"1{separator}" * 500_000 + "1"
    with pytest.raises(TableError, match=r"a\.csv, line 2 has 500,001 cells; 2 are needed"):
        read_text_table(f"x{separator}y\n{line}\n".encode(), "a.csv", 10)
