"""Tables of numerical errors come onto the page, and nothing else from their drawings does."""

from dataclasses import replace

import numpy as np
import pytest
from markupsafe import Markup
from report.pages import plain, read_page
from report.synthetic import PARAMETERS, write_run

from visuohaptic.report import sections
from visuohaptic.report.page import render_page
from visuohaptic.report.run import read_run
from visuohaptic.report.stability import (
    describe_checks,
    stability_answer,
    stability_figures,
)
from visuohaptic.stability.findings import Result
from visuohaptic.stability.rows import result_table
from visuohaptic.stability.stored import StoredHardCases, stored_hard_cases
from visuohaptic.stability.tolerances import TOLERANCES, Tolerance
from visuohaptic.tables.schema import read_table, write_table
from visuohaptic.tables.stability import STABILITY

DRAWING = '<svg viewBox="0 0 1 1"><line x1="0"/></svg>'
NARROW = Tolerance(16 * 2.0**-53, "object radii", "along the normal")
GRAZING = Result("rays/grazing", NARROW, 1234, 2e-16, "slope 1e-9", DRAWING)
FINITE = Tolerance(0, "images", "finite")
EXACT = Result("images/stretched imprints", FINITE, 6, 0.0, "a flat one", "")
TOUCHES = "objects/touches by themselves"
ON_OBJECT = Result(TOUCHES, TOLERANCES[TOUCHES], 4, 0.0, "viewpoint 3, fixation, touch 2", "")
MADE = {
    "version": "9.8.7",
    "processor": "a Z80",
    "command": "make",
    "date": "1976-07-01",
    "minutes": 17.5,
}


def broken(result, error=1.0):
    return replace(result, worst_error=error)


def written(folder, results, key="/", name="stability.parquet"):
    write_table(STABILITY, result_table(results, key), folder / name)
    return folder / name


@pytest.mark.slow
def test_an_exceeded_tolerance_is_said_first_in_its_section_and_at_its_object(
    tmp_path, monkeypatch
):
    kept = StoredHardCases(result_table([broken(GRAZING, np.inf)]), MADE)
    monkeypatch.setattr(sections, "stored_hard_cases", lambda: kept)
    (tmp_path / "objects").mkdir()
    for key in ("cup/mug", "ball/marble"):
        result = broken(ON_OBJECT) if key == "cup/mug" else ON_OBJECT
        written(tmp_path / "objects", [result], key, name=f"{key.replace('/', '-')}.parquet")
    files = replace(write_run(tmp_path), extras={"stability": tmp_path / "objects"})
    page = read_page(render_page(read_run(files, PARAMETERS, [])))
    for said in (
        "8 hard cases of 1 kind: 1 tolerance exceeded (cup/mug: objects, touches",
        "1 tolerance exceeded (rays, grazing)",
        "Numerical checks on this object: 4 hard cases of 1 kind: 1 tolerance exceeded",
        "on this object: 4 hard cases of 1 kind were tried, and every error is within",
        "the worst error is not finite",
    ):
        assert said in page.text


def test_what_is_kept_with_the_package_says_how_it_was_made_and_what_it_exceeds():
    kept = stored_hard_cases()
    assert set(kept.made) == set(MADE)
    # The limits of docs/stability.md say why.
    exceeded = {check.kind for check in stability_figures(kept.table).broken}
    assert exceeded <= {("invariance", "turned object: saliency map")}


def test_objects_share_a_requirement_and_the_worst_is_named(tmp_path):
    paths = [
        written(tmp_path, [ON_OBJECT], "cup/mug", name="a.parquet"),
        written(tmp_path, [broken(ON_OBJECT)], "ball/marble", name="b.parquet"),
    ]
    figures = stability_figures(read_table(STABILITY, paths))
    (check,) = figures.families["objects"]
    assert (check.cases, check.held) == (8, False)
    assert check.hardest == "ball/marble: viewpoint 3, fixation, touch 2"
    assert [check.key for check in figures.broken] == ["ball/marble"]
    assert set(figures.objects) == {"cup/mug", "ball/marble"}


def test_the_answer_is_one_line_and_the_section_names_the_requirement_nearest_to_its_tolerance():
    figures = stability_figures(result_table([GRAZING, EXACT]))
    assert stability_answer([figures]) == (
        "1,240 numerically hard cases computed; every error is within its tolerance."
    )
    said = plain(describe_checks(figures.checks))
    assert "1,240 hard cases of 2 kinds were tried" in said
    assert "1 kind has no error at all" in said
    assert said.endswith("as a share of what is allowed, is 11.26 % (rays, grazing).")
    exceeded = stability_figures(result_table([broken(EXACT), GRAZING]))
    sentence = stability_answer([exceeded])
    assert sentence.endswith("1 tolerance exceeded (images, stretched imprints).")
    assert describe_checks(exceeded.checks) == sentence


@pytest.mark.parametrize(
    "drawing",
    [
        DRAWING + "<script>alert(1)</script>",
        "<svg ><script>alert(1)</script></svg>",
        '<svg onload="x"></svg>',
        '<svg ><line onclick="x"/></svg>',
    ],
)
def test_a_drawing_that_is_more_than_shapes_is_left_out(drawing):
    results = [replace(GRAZING, drawing=drawing), replace(EXACT, drawing=DRAWING)]
    left_out, plain_shapes = stability_figures(result_table(results)).checks
    assert left_out.drawing == ""
    assert isinstance(plain_shapes.drawing, Markup)
