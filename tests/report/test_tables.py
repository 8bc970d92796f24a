"""A table has the columns and formats that were asked for, intervals are written in one way, and all is text."""

from report.pages import plain, read_page

from visuohaptic.evaluation.intervals import Interval
from visuohaptic.report.estimates import (
    Figure,
    estimate,
    figure_of,
    with_interval,
)
from visuohaptic.report.page import make_environment

ROWS = [
    {"name": "<b>", "share": 0.5, "share_low": 0.4, "share_high": 0.6, "of": {"count": 1234}},
    {"name": "two", "share": None, "of": {}, "mark": "exceeded"},
]
COLUMNS = (("Name", "name"), ("Share", "share", "±percent"), ("Count", "of.count", "{:,}"))


def written(rows, columns=COLUMNS, best=None):
    source = "{{ rows|table('Label', columns, 'Caption', best) }}"
    return make_environment().from_string(source).render(rows=rows, columns=columns, best=best)


def test_each_value_has_its_format_and_its_interval():
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


def test_formats_are_filters_one_after_another_or_patterns():
    rows = [{"key": "naive_bayes", "seconds": 0.25, "all": (Figure(1.0, 0.7, 1.0),)}]
    columns = ("Name", "key", "spaced|titled"), ("s", "seconds", "%.1f"), ("A", "all.0", "±percent")
    text = plain(read_page(written(rows, columns)).text)
    assert text == "Caption Name s A Naive bayes 0.2 100.0 % 70.0 % to 100.0 %"


CELL = {"area": 0.5, "area_low": 0.4, "area_high": 0.6, "accuracy": 0.7, "low": 0.6, "high": 0.8}


def test_a_column_has_its_interval_in_the_columns_of_its_name_or_of_the_row():
    assert figure_of(CELL, "area") == Figure(0.5, 0.4, 0.6)
    assert figure_of(CELL, "accuracy") == Figure(0.7, 0.6, 0.8)
    assert figure_of({"area": None}, "area") is None


def test_the_mean_of_one_object_has_no_ends():
    assert estimate(Interval(0.3, float("nan"), float("nan"))) == Figure(0.3)
    assert with_interval(Figure(0.5, 0.4, 0.6), "{:g}".format, " s") == "0.5 s (0.4 to 0.6)"
    assert with_interval(Figure(0.5), "{:g}".format) == "0.5"
