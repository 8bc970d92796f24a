"""A table has the columns that were asked for, intervals are written in one way, and all is text."""

import pytest
from report.pages import plain, read_page

from visuohaptic.evaluation.intervals import Interval
from visuohaptic.report import cells
from visuohaptic.report.environment import make_environment
from visuohaptic.report.estimates import (
    Estimate,
    estimate,
    estimate_of,
    with_interval,
)
from visuohaptic.report.tables import by_strategy

ROWS = [
    {"name": "<b>", "share": Estimate(0.5, 0.4, 0.6), "of": {"count": 1234}},
    {"name": "two", "share": None, "of": {}, "mark": "exceeded"},
]
COLUMNS = (
    ("Name", "name"),
    ("Share", "share", cells.percent_with_interval),
    ("Count", "of.count", cells.grouped),
)


def written(rows, columns=COLUMNS, best=None):
    source = "{{ rows|table('Label', columns, 'Caption', best) }}"
    return make_environment().from_string(source).render(rows=rows, columns=columns, best=best)


def test_each_value_is_written_by_the_function_of_its_column():
    page = read_page(written(ROWS))
    assert plain(page.text) == (
        "Caption Name Share Count <b> 50.0 % 40.0 % to 60.0 % 1,234 two – –"
    )
    assert page.values("value") == ["0.5"]
    headings = [one.attributes.get("class") for one in page.named("th")]
    assert headings[:3] == [None, "number", "number"]


def test_a_row_may_have_a_mark_and_a_table_without_rows_has_its_headings():
    page = read_page(written(ROWS, best=ROWS[0]))
    assert [row.attributes.get("class") for row in page.named("tr")] == [None, "best", "exceeded"]
    assert read_page(written([])).text == "Caption Name Share Count"


def test_values_are_found_in_tuples_and_texts_may_be_aligned_as_numbers():
    rows = [{"key": "naive_bayes", "milliseconds": "9 (8 to 12)", "places": ("seen", None)}]
    columns = (
        ("Name", "key", cells.spaced),
        ("ms", "milliseconds", cells.number),
        ("First", "places.0"),
        ("Second", "places.1", cells.titled),
    )
    page = read_page(written(rows, columns))
    assert plain(page.text) == "Caption Name ms First Second naive bayes 9 (8 to 12) seen –"
    headings = [one.attributes.get("class") for one in page.named("th")]
    assert headings == [None, "number", None, None, None]


def test_there_is_one_column_per_strategy():
    rows = [{"state": "full", "counts": {"fixation": 3}}]
    columns = [("State", "state"), *by_strategy(["fixation", "farthest_point"], "counts")]
    text = plain(read_page(written(rows, columns)).text)
    assert text == "Caption State Eye fixations Farthest points full 3 –"


@pytest.mark.parametrize(
    ("cell", "value", "text"),
    [
        (cells.one_decimal, 0.25, "0.2"),
        (cells.two_decimals, 1.0, "1.00"),
        (cells.three_decimals, 0.5, "0.500"),
        (cells.seconds, 10.5, "10.5 s"),
        (cells.whole_percent, 0.625, "62 %"),
        (cells.exact_percent, 0.12345, "12.35 %"),
        (cells.titled_strategy, "fixation", "Eye fixations"),
        (cells.code, "<a>", "<code>&lt;a&gt;</code>"),
        (cells.exact_probability, 0.01234, '<data value="0.01234">0.012</data>'),
        (cells.percent_with_interval, 0.5, '<data value="0.5">50.0 %</data>'),
        (cells.points_with_interval, Estimate(0.5), '<data value="0.5">+50.0</data>'),
        (cells.duration_with_interval, Estimate(2.0), '<data value="2.0">2 s</data>'),
        (
            cells.percent_with_interval,
            Interval(0.5, 0.25, 0.75),
            '<data value="0.5">50.0 %</data><span class="interval">25.0 % to 75.0 %</span>',
        ),
        (cells.recomputed, "features", "descriptors"),
        (cells.accuracy_or_error, {"accuracy": None, "error": "too small."}, "failed: too small."),
    ],
)
def test_each_function_writes_its_value(cell, value, text):
    assert plain(str(cell(value))) == text


CELL = {"area": 0.5, "area_low": 0.4, "area_high": 0.6, "accuracy": 0.7, "low": 0.6, "high": 0.8}


def test_a_column_has_its_interval_in_the_columns_of_its_name_or_of_the_row():
    assert estimate_of(CELL, "area") == Estimate(0.5, 0.4, 0.6)
    assert estimate_of(CELL, "accuracy") == Estimate(0.7, 0.6, 0.8)
    assert estimate_of({"area": None}, "area") is None


def test_the_mean_of_one_object_has_no_ends():
    assert estimate(Interval(0.3, float("nan"), float("nan"))) == Estimate(0.3)
    assert with_interval(Estimate(0.5, 0.4, 0.6), "{:g}".format, " s") == "0.5 s (0.4 to 0.6)"
    assert with_interval(Estimate(0.5), "{:g}".format) == "0.5"
