"""A study's words and rows come from its figures; a user's names are text and nothing else."""

import sys
from types import SimpleNamespace

import pytest
from report.pages import read_page
from report.synthetic import write_study

from visuohaptic.base.errors import VisuohapticError
from visuohaptic.report.cells import recomputed
from visuohaptic.report.chapters import chapters_of
from visuohaptic.report.environment import make_environment
from visuohaptic.report.section import study_sections
from visuohaptic.report.studies import names_of_own_studies, read_study
from visuohaptic.report.wording import spaced
from visuohaptic.studies.conditions import _ORDER
from visuohaptic.studies.registry import REPOSITORY

ROWS = [
    ("whole_method", 0.8, None, None),
    ("kinesthetic_only", 0.85, "whole_method", 0.05),
    ("cutaneous_only", 0.5, "whole_method", -0.3),
    ("without_edge", None, None, None),
]
SETTLED = [None, 0.4, 0.003, None]
EVIL = "<script>alert(1)</script>"


def sentence(folder, rows=ROWS, **columns):
    study = read_study(write_study(folder, "parts", rows, **columns), "parts", spaced)
    return "".join(study["tables"][0]["sentences"])


def section_of(studies):
    template = make_environment().get_template("studies.html.jinja")
    return read_page(template.render(studies=studies, confidence="95 %"))


def test_the_largest_loss_and_gain_are_stated_and_no_more(tmp_path):
    text = sentence(tmp_path, adjusted_p=SETTLED)
    assert text.startswith(
        "The largest loss is with “cutaneous only” (−30.0 percentage points); the largest"
    )
    assert "gain is with “kinesthetic only” (+5.0 percentage points); with 12 objects" in text
    assert text.endswith(
        "these changes are significant (p after Holm's correction below 0.05): cutaneous only."
    )
    text = sentence(tmp_path, ROWS[:2])
    assert "loss" not in text
    assert "no change is significant (the smallest p after Holm's correction is 1)" in text
    assert sentence(tmp_path, ROWS[:1]) == ""


def test_the_papers_pipeline_comes_first(tmp_path):
    study = read_study(
        write_study(tmp_path, "mine", ROWS[:2], pipeline=["order_free", "paper"]), "mine"
    )
    assert [table["pipeline"] for table in study["tables"]] == ["paper", "order_free"]


def test_every_phase_has_words():
    assert all(map(recomputed, {*_ORDER, "recognition"}))


def test_a_study_of_which_everything_failed_has_its_table_and_no_chart(tmp_path):
    write_study(tmp_path, "mine", [("as run", None, None, None)])
    page = section_of([read_study(tmp_path, "mine")])
    assert "As run failed: too small." in page.text
    assert not [label for label in page.values("aria-label") if "accuracy by condition" in label]


def test_own_studies_have_their_own_section_and_their_names_are_text(tmp_path):
    rows = [("as run", 0.8, None, None), (EVIL, 0.7, "as run", -0.1)]
    rows += [("without_edge", 0.7, "as run", -0.1)]
    for name in ("mine", "ablations", "effects"):
        write_study(tmp_path, name, rows, title=EVIL)
    files = SimpleNamespace(study_folders=[REPOSITORY])
    run = SimpleNamespace(files=files, parts=lambda _: sorted(tmp_path.glob("*.parquet")))
    assert names_of_own_studies(run) == ["mine"]
    page = section_of([read_study(tmp_path, "mine")])
    assert page.text.count(EVIL) >= 3
    assert "without_edge" in page.text
    assert not page.named("script")


@pytest.mark.parametrize("folder", [None, "none"])
def test_no_file_gives_no_study(folder):
    assert read_study(folder, "ablations") is None


def bring_section(folder, text):
    """Write a study with a section, which no module of an earlier test stands for."""
    for name in ("brought", "brought.section"):
        sys.modules.pop(name, None)
    (folder / "brought/templates").mkdir(parents=True)
    (folder / "brought/__init__.py").touch()
    (folder / "brought/section.py").write_text(text)
    return folder


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("1 / 0", "can't be run: ZeroDivisionError"),
        ("", "has no SECTION; one Section, or a sequence SECTIONS, is needed"),
        ("SECTIONS = ()", "has no SECTION; one Section, or a sequence SECTIONS, is needed"),
    ],
)
def test_a_section_that_a_study_brings_is_refused_in_one_sentence(
    tmp_path, monkeypatch, text, sentence
):
    monkeypatch.setattr("sys.path", [*sys.path])
    with pytest.raises(VisuohapticError, match=rf"brought/section.py {sentence}"):
        study_sections([bring_section(tmp_path, text)])


SECTION = """
from visuohaptic.report.section import Section
SECTION = Section("", "Brought", lambda context: {"said": context})
"""


def test_a_study_brings_its_section_with_its_template(tmp_path, monkeypatch):
    monkeypatch.setattr("sys.path", [*sys.path])
    bring_section(tmp_path, SECTION)
    (tmp_path / "brought/templates/section.html.jinja").write_text("{{ said|titled }}")
    run = SimpleNamespace(
        files=SimpleNamespace(study_folders=[tmp_path]), extra_path=lambda _: None
    )
    sections = chapters_of(run)["Studies"]
    assert [(one.name, one.title) for one in sections[:1]] == [("study-brought", "Brought")]
    template = make_environment(sections).get_template(sections[0].template_path)
    assert template.render(sections[0].values("so much.")) == "So much."


SECTIONS = """
from visuohaptic.report.section import Section, sentences_section
SECTIONS = (
    Section("brought", "Brought", lambda context: {}),
    sentences_section("kept_before", "Kept", lambda context: context, CHAPTER),
)
"""


def brought_sections(folder, text):
    run = SimpleNamespace(files=SimpleNamespace(study_folders=[bring_section(folder, text)]))
    return chapters_of(run)


def test_a_study_brings_sentences_to_another_chapter_with_a_template_of_the_report(
    tmp_path, monkeypatch
):
    monkeypatch.setattr("sys.path", [*sys.path])
    chapters = brought_sections(tmp_path, SECTIONS.replace("CHAPTER", '"Other objects"'))
    assert chapters["Studies"][0].name == "study-brought"
    kept = chapters["Other objects"][0]
    assert (kept.name, kept.title) == ("study-brought-kept-before", "Kept")
    values = kept.values(["First.", "", "Second."])
    template = make_environment([kept]).get_template(kept.template_path)
    assert template.render(values) == "<p>First.</p>\n<p>Second.</p>\n"
    assert kept.values([""]) is None


def test_a_chapter_that_the_page_does_not_have_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("sys.path", [*sys.path])
    with pytest.raises(
        VisuohapticError,
        match=r"brought/section\.py: 'Others' is no chapter of the report; one of ",
    ):
        brought_sections(tmp_path, SECTIONS.replace("CHAPTER", '"Others"'))
