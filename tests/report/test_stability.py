"""What the numerical suite wrote comes onto the page, and nothing else from its file does."""

import json

import pytest
from markupsafe import Markup
from report.pages import read_page
from report.synthetic import PARAMETERS, write_run

from visuohaptic.errors import ReportError
from visuohaptic.report.page import render_page
from visuohaptic.report.run import RunFiles, read_run
from visuohaptic.report.stability import read_precision, read_stability

CHECK = {
    "family": "rays", "case": "grazing", "cases": 1234, "worst_error": 2e-16, "tolerance": 1e-15,
    "unit": "object radii", "reason": "a dot product", "hardest": "slope 1e-9",
    "drawing": '<svg viewBox="0 0 1 1"><line x1="0"/></svg>',
}  # fmt: skip
MUTATION = {
    "change": "a sign",
    "file": "a.py",
    "line": "x = +1",
    "broken": "x = -1",
    "caught_by": "test_a",
}


def written(folder, data, name="stability.json"):
    path = folder / name
    path.write_text(json.dumps(data))
    return path


@pytest.mark.slow
def test_checks_mutations_and_kernels_come_onto_the_page(tmp_path):
    stability = written(tmp_path, {"checks": [CHECK], "mutations": [MUTATION], "seconds": 3})
    row = {
        "kernel": "ray cast", "settings": "in float64", "worst_error": 1e-15, "rms_error": 1e-16,
        "unit": "distance", "seconds": 0.25, "per": "million rays",
    }  # fmt: skip
    files = write_run(tmp_path)
    extras = {"stability": stability, "precision": written(tmp_path, [row], "precision.json")}
    files = RunFiles(**{**vars(files), "extras": extras})
    page = read_page(render_page(read_run(files, PARAMETERS, [])))
    assert "stability" in page.values("id")
    assert page.mismatches == []
    for text in (
        "1,234",
        "grazing",
        "2e-16",
        "a dot product",
        "Every tolerance held",
        "test_a",
        "in float64",
    ):
        assert text in page.text


def test_a_broken_tolerance_is_said(tmp_path):
    figures = read_stability(written(tmp_path, {"checks": [CHECK, {**CHECK, "worst_error": 1e-3}]}))
    assert len(figures.broken) == 1
    assert figures.cases == 2468
    unknown = read_stability(written(tmp_path, {"checks": [{**CHECK, "worst_error": None}]}))
    assert unknown.broken


@pytest.mark.parametrize(
    "drawing",
    [
        "<svg><script>alert(1)</script></svg>", '<svg onload="x"></svg>', "<img src=x>", "",
        '<svg ><a href="http://x">x</a></svg>', '<svg \nonclick="x"></svg>', '<svg id="a"/onload="x"></svg>',
    ],
)  # fmt: skip
def test_a_drawing_that_is_more_than_shapes_is_left_out(tmp_path, drawing):
    figures = read_stability(written(tmp_path, {"checks": [{**CHECK, "drawing": drawing}]}))
    assert figures.families["rays"][0].drawing == ""


def test_a_plain_drawing_is_shown(tmp_path):
    figures = read_stability(written(tmp_path, {"checks": [CHECK]}))
    assert isinstance(figures.families["rays"][0].drawing, Markup)


def test_files_that_are_not_there_leave_the_section_out(tmp_path):
    assert read_stability(None) is None
    assert read_stability(tmp_path / "none.json") is None
    assert read_precision(tmp_path / "none.json") == {}


@pytest.mark.parametrize("content", ["{", "3", '{"checks": [{"cases": 3}]}', '{"rows": []}'])
def test_a_file_of_something_else_is_named(tmp_path, content):
    path = tmp_path / "stability.json"
    path.write_text(content)
    with pytest.raises(ReportError, match=r"stability.json"):
        read_stability(path)
