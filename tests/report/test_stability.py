"""What is exact, and what is not, is said in sentences: of the run's objects, and of the hard cases of the code."""

import json
from dataclasses import replace

import numpy as np
import pytest
from report.pages import plain, read_page
from report.synthetic import PARAMETERS, write_run

from visuohaptic.base.errors import ReportError
from visuohaptic.report.page import render_page
from visuohaptic.report.run import read_run
from visuohaptic.report.stability import (
    describe_checks,
    describe_hard_cases,
    read_hard_cases,
    stability_figures,
)
from visuohaptic.stability.findings import Result
from visuohaptic.stability.rows import result_table
from visuohaptic.stability.tolerances import TOLERANCES, Tolerance
from visuohaptic.tables.schema import read_table, write_table
from visuohaptic.tables.stability import STABILITY

KEY = "cup/mug"
NARROW = Tolerance(16 * 2.0**-53, "object radii", "along the normal")
GRAZING = Result("grazing rays", NARROW, 1234, 2e-16, "slope 1e-9")
FINITE = Tolerance(0, "images", "finite")
EXACT = Result("stretched imprints", FINITE, 6, 0.0, "a flat one")
TOUCHES = "touches by themselves"
ON_OBJECT = Result(TOUCHES, TOLERANCES[TOUCHES], 4, 0.0, "viewpoint 3, fixation, touch 2")
TOTALS = {
    "cases": 55000,
    "requirements": 66,
    "exceeded": ["invariance, turned object"],
    "version": "9.8.7",
    "date": "1976-07-01",
}


def broken(result, error=1.0):
    return replace(result, worst_error=error)


def written(folder, results, key=KEY, name="stability.parquet"):
    write_table(STABILITY, result_table(results, key), folder / name)
    return folder / name


def write_totals(path, **changes):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(TOTALS | changes))
    return path


@pytest.mark.slow
def test_an_exceeded_tolerance_is_said_first_in_its_section_and_at_its_object(tmp_path):
    (tmp_path / "objects").mkdir()
    checked = []
    for key in ("cup/mug", "ball/marble"):
        result = broken(ON_OBJECT, np.inf) if key == "cup/mug" else ON_OBJECT
        name = f"{key.replace('/', '-')}.parquet"
        checked.append(written(tmp_path / "objects", [result], key, name=name))
    totals = write_totals(tmp_path / "hard_cases.json")
    files = replace(write_run(tmp_path), extras={"hard_cases": totals}, stability=checked)
    page = read_page(render_page(read_run(files, PARAMETERS, [])))
    for said in (
        "8 hard cases of 1 kind: 1 tolerance exceeded (cup/mug: touches by themselves)",
        "Numerical checks on this object: 4 hard cases of 1 kind: 1 tolerance exceeded",
        "on this object: 4 hard cases of 1 kind were tried. Every error is within",
        "the worst error is not finite",
        "55,000 hard cases of 66 kinds with known results",
    ):
        assert said in page.text


def test_objects_share_a_requirement_and_the_one_that_exceeds_it_is_named(tmp_path):
    paths = [
        written(tmp_path, [ON_OBJECT], "cup/mug", name="a.parquet"),
        written(tmp_path, [broken(ON_OBJECT)], "ball/marble", name="b.parquet"),
    ]
    figures = stability_figures(read_table(STABILITY, paths))
    (checks,) = figures.requirements.values()
    assert [check.held for check in checks] == [False, True]
    assert [check.title for check in figures.broken] == ["ball/marble: touches by themselves"]
    assert set(figures.objects) == {"cup/mug", "ball/marble"}


def test_the_section_names_the_requirement_nearest_to_its_tolerance():
    figures = stability_figures(result_table([GRAZING, EXACT], KEY))
    said = plain(describe_checks(figures.checks))
    assert "1,240 hard cases of 2 kinds were tried" in said
    assert "1 kind has no error at all" in said
    assert said.endswith("The largest error is 11.26 % of its tolerance (cup/mug: grazing rays).")
    exceeded = stability_figures(result_table([broken(EXACT), GRAZING], KEY))
    sentence = describe_checks(exceeded.checks)
    assert sentence.endswith("1 tolerance exceeded (cup/mug: stretched imprints).")


def test_totals_of_the_hard_cases_are_one_sentence_and_another_file_is_refused(tmp_path):
    path = write_totals(tmp_path / "hard_cases.json")
    said = describe_hard_cases(read_hard_cases(path))
    assert "55,000 hard cases of 66 kinds with known results (1976-07-01, version 9.8.7)" in said
    assert said.endswith("1 tolerance exceeded (invariance, turned object).")
    held = describe_hard_cases(read_hard_cases(write_totals(path, exceeded=[])))
    assert held.endswith(": every error is within its tolerance.")
    path.write_text("{}")
    with pytest.raises(ReportError, match="run make test-hard again"):
        read_hard_cases(path)
