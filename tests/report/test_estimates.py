"""Figures are written with their intervals in one way."""

import pytest

from visuohaptic.recognition.intervals import Interval
from visuohaptic.report.estimates import (
    Figure,
    estimate,
    figure_of,
    points_above_interval,
    share_above_interval,
    with_interval,
)

ROW = {"area": 0.5, "area_low": 0.4, "area_high": 0.6, "accuracy": 0.7, "low": 0.6, "high": 0.8}


def test_a_column_has_its_interval_in_the_columns_of_its_name_or_of_the_row():
    assert figure_of(ROW, "area") == Figure(0.5, 0.4, 0.6)
    assert figure_of(ROW, "accuracy") == Figure(0.7, 0.6, 0.8)
    assert figure_of({"area": None}, "area") is None


def test_the_mean_of_one_object_has_no_ends():
    assert estimate(Interval(0.3, float("nan"), float("nan"))) == Figure(0.3)
    assert with_interval(Figure(0.5, 0.4, 0.6), "{:g}".format, " s") == "0.5 s (0.4 to 0.6)"
    assert with_interval(Figure(0.5), "{:g}".format) == "0.5"


@pytest.mark.parametrize(
    ("written", "marked"),
    [
        (share_above_interval(Figure(1.0, 0.7, 1.0)), True),
        (share_above_interval(Figure(0.9, 0.7, 1.0)), False),
        (points_above_interval(Figure(0.0, -0.2, 0.2)), True),
        (points_above_interval(Figure(0.0, -0.1, 0.2)), False),
    ],
)
def test_an_exact_limit_has_its_mark(written, marked):
    assert ("†" in written) == marked
    assert '<span class="interval">' in written
