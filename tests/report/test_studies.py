"""A study's words and rows come from its figures; a user's names are text and nothing else."""

import pytest
from report.pages import read_page
from report.synthetic import write_study

from visuohaptic.report.page import make_environment
from visuohaptic.report.studies import (
    NAMES,
    RECOMPUTED,
    condition_name,
    names_of_own_studies,
    read_study,
)
from visuohaptic.studies.ablations import PARTS
from visuohaptic.studies.conditions import _ORDER

ROWS = [
    ("whole_method", 0.8, None, None),
    ("kinesthetic_only", 0.85, "whole_method", 0.05),
    ("cutaneous_only", 0.5, "whole_method", -0.3),
    ("without_edge", None, None, None),
]
SETTLED = [None, 0.4, 0.003, None]
EVIL = "<script>alert(1)</script>"


def sentence(folder, rows=ROWS, **columns):
    study = read_study(write_study(folder, "ablations", rows, **columns), "ablations")
    return "".join(study["tables"][0]["sentences"])


def section_of(studies):
    template = make_environment().get_template("studies.html.jinja")
    return read_page(template.render(studies=studies, confidence="95 %"))


def test_the_largest_loss_and_gain_are_stated_and_no_more(tmp_path):
    text = sentence(tmp_path, adjusted_p=SETTLED)
    assert text.startswith(
        "Most is lost with “cutaneous cues only” (−30.0 percentage points); most"
    )
    assert "gained with “kinesthetic cues only” (+5.0 percentage points); with 12 objects" in text
    assert text.endswith("beyond chance (Holm-adjusted p below 0.05): cutaneous cues only.")
    text = sentence(tmp_path, ROWS[:2])
    assert "lost" not in text
    assert "no change is beyond chance (smallest Holm-adjusted p 1)" in text
    assert sentence(tmp_path, ROWS[:1]) == ""


def test_the_papers_pipeline_comes_first(tmp_path):
    study = read_study(write_study(tmp_path, "mine", ROWS[:2], pipeline=["best", "paper"]), "mine")
    assert [table["pipeline"] for table in study["tables"]] == ["paper", "best"]


def test_every_ablation_has_a_name_of_its_own_and_every_phase_has_words():
    assert set(NAMES) <= set(PARTS)
    assert len({condition_name(name) for name in PARTS}) == len(PARTS)
    assert {*_ORDER, "recognition"} <= set(RECOMPUTED)


def test_a_study_of_which_everything_failed_has_its_table_and_no_chart(tmp_path):
    write_study(tmp_path, "mine", [("as run", None, None, None)])
    page = section_of([read_study(tmp_path, "mine")])
    assert "As run failed: too small." in page.text
    assert not [label for label in page.values("aria-label") if "accuracy by condition" in label]


def test_own_studies_have_their_own_section_and_their_names_are_text(tmp_path):
    rows = [("as run", 0.8, None, None), (EVIL, 0.7, "as run", -0.1)]
    rows += [("without_edge", 0.7, "as run", -0.1)]
    write_study(tmp_path, "mine", rows, title=EVIL)
    write_study(tmp_path, "ablations", ROWS)
    assert names_of_own_studies(tmp_path) == ["mine"]
    page = section_of([read_study(tmp_path, "mine")])
    assert page.text.count(EVIL) >= 3
    assert "without_edge" in page.text
    assert not page.named("script")


@pytest.mark.parametrize("folder", [None, "none"])
def test_no_file_gives_no_study(folder):
    assert read_study(folder, "ablations") is None
    assert names_of_own_studies(folder) == []
