import pytest

from visuohaptic.base.csv_cells import csv_cell


@pytest.mark.parametrize(
    "text",
    ["=1+1", "+1+1", "-1+1", "@SUM(A1)", "\t=1", "\r=1", '=HYPERLINK("a")', "-", "-1 -x", "\t"],
)
def test_text_that_a_spreadsheet_would_run_gets_an_apostrophe(text):
    assert csv_cell(text) == f"'{text}"


@pytest.mark.parametrize(
    "value", ["chair", "1=1", "", "-1", "+0.5", "-1e-3", "-1 0 0", -1.5, None, 3]
)
def test_other_text_and_numbers_stay(value):
    assert csv_cell(value) is value
