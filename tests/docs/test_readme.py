"""The README's answers and tables say what their sources say, and its folders exist."""

import re
from pathlib import Path

import pandas as pd
import pytest

from turned.leads import read_kept_leads
from variants.kept import PAPER_SET, kept_variants
from variants.summary import kept_summary
from variants.weighing import summarise_variants
from visuohaptic.evaluation.published import TABLE_1
from visuohaptic.parameters import CostParameters
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.leads import verdict
from visuohaptic.report.wording import points

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")
WORDS = " ".join(TEXT.split())
DEFAULT_RUN = ROOT / "tests/golden/kept/default_run"


def block(name, text=TEXT):
    return re.search(rf"<!-- {name} -->\n(.*?)<!-- /{name} -->", text, re.DOTALL)[1]


def table_rows(text, name):
    lines = block(name, text).splitlines()[2:]
    return [[cell.strip() for cell in line[1:-1].split("|")] for line in lines]


@pytest.fixture(scope="module")
def accuracies():
    """Rows of the table: classifier, by fixation, published, random, published, ours by both."""
    return {name: cells for name, *cells in table_rows(TEXT, "results")}


def test_only_naive_bayes_is_right_more_often_than_published(accuracies):
    above = {
        name
        for name, cells in accuracies.items()
        for here, published in ((0, 1), (2, 3))
        if cells[published] and float(cells[here].split()[0]) > float(cells[published].split()[0])
    }
    assert above == {"naïve Bayes"}
    assert "all classifiers except naïve Bayes are right less often than published" in WORDS


def test_with_the_svm_fixations_do_not_lead(accuracies):
    fixation, random = (float(accuracies["SVM"][place].split()[0]) for place in (0, 2))
    assert fixation <= random


def test_the_published_figures_are_those_of_the_paper(accuracies):
    shown = {
        float(cells[place].split()[0])
        for cells in accuracies.values()
        for place in (1, 3)
        if cells[place]
    }
    published = {round(100 * value, 2) for by in TABLE_1.values() for value in by.values()}
    assert shown == published


def test_the_answers_name_the_accuracies_of_the_tables(accuracies):
    said = " ".join(block("answers").split())
    assert f"right in {accuracies['SVM'][0].split(' (')[0]} of cases" in said
    ours = accuracies["linear discriminant"]
    short = " ".join(block("short").split())
    both = (accuracies["SVM"][0].split(" (")[0], ours[-2].split(" (")[0])
    assert "in {} (the paper's pipeline) to {} (ours) of cases".format(*both) in short
    assert f"`order_free`, in {ours[-2].split(' (')[0]}," in said
    kept = pd.read_parquet(ROOT / "studies/turned/kept_benchmark.parquet")
    of_fixation = kept[
        (kept["strategy"] == "fixation") & (kept["touches"] == 5) & (kept["known"] == "full")
    ]
    for turns, words in (
        ("none", "stand upright and face one way"),
        ("any", "are turned in any way"),
    ):
        means = []
        for pipeline in ("paper", "order_free"):
            rows = of_fixation[
                (of_fixation["turns"] == turns) & (of_fixation["pipeline"] == pipeline)
            ]
            means.append(100 * (rows["accuracy"] * rows["weight"]).sum() / rows["weight"].sum())
        assert "{:.1f} % and {:.1f} %".format(*means) in said
        assert words in said


def test_the_answers_count_the_leads_of_the_kept_tables():
    said = " ".join(block("answers").split())
    kept = read_kept_leads(IntervalParameters())
    seeing, salience = (verdict(kept.of(name)) for name in ("seeing", "salience"))
    assert f"in {len(seeing.ahead)} of {len(seeing.leads)} comparisons" in said
    for leads, end in ((seeing.ahead, max), (seeing.behind, min)):
        assert f"by up to {points(end(lead.difference.mean for lead in leads))}" in said
    assert all(lead.turns in {"none", "vertical"} for lead in seeing.ahead)
    assert {lead.turns for lead in seeing.behind} == {"any"}
    assert not salience.ahead
    assert f"in none of {len(salience.leads)} comparisons" in said
    largest = max(lead.difference.high for lead in kept.of("salience"))
    drawn = max(lead.difference.new_classes_high for lead in kept.of("salience"))
    assert f"by more than {100 * largest:.1f} points on other objects of these classes" in said
    assert f"by more than {100 * drawn:.1f} points on other classes" in said
    assert f"and behind in {len(salience.behind)}." in said
    of_classes = verdict(kept.of("seeing"), "classes")
    assert f"Counted for other classes, they are ahead in {len(of_classes.ahead)}." in said


def test_the_answers_say_what_positions_and_imprints_give_by_themselves():
    kept = pd.read_parquet(ROOT / "studies/cues/kept_paper.parquet")
    setting = {
        "tested": "new", "turns": "none", "frame": "full", "touches": 5, "pipeline": "order_free", "strategy": "fixation",
    }  # fmt: skip
    rows = kept[(kept[list(setting)] == pd.Series(setting)).all(axis=1)]
    means = {
        cue: 100 * (own["accuracy"] * own["weight"]).sum() / own["weight"].sum()
        for cue, own in rows.groupby("cues")
    }
    said = " ".join(block("answers").split())
    assert (
        f"give {means['pose']:.1f} % in our pipeline, imprints only {means['imprint']:.1f} %"
        in said
    )


def test_the_variants_are_those_of_the_study():
    literal = kept_summary().literal["fixation"]["support_vector_machine"]
    assert f"reaches {100 * literal:.1f} % with the SVM" in WORDS
    of_svm = summarise_variants(kept_variants(PAPER_SET).rows)["classifiers"][
        "support_vector_machine"
    ]
    assert of_svm["variants_reaching"] == 0
    assert f"none of {of_svm['variants']} variants 93.45 %" in WORDS


def test_the_settings_of_accuracy_and_time_are_those_of_the_default_run():
    frontier = pd.read_parquet(DEFAULT_RUN / "frontier.parquet")
    rows = table_rows((ROOT / "docs/accuracy_and_time.md").read_text(encoding="utf-8"), "costs")
    prices = CostParameters()
    seconds = frontier["touches"] * prices.touch_seconds + frontier["looks"] * prices.look_seconds
    expected = [
        (f"{100 * (1 - error):.1f} %", f"{robot:.1f} s")
        for error, robot in zip(frontier["error"], seconds, strict=True)
    ]
    assert sorted((cells[3].split(" (")[0], cells[5]) for cells in rows) == sorted(expected)


def test_the_table_of_folders_is_that_of_the_tree():
    rows = re.findall(r"^\| \w+ \| .* \| (.*/`) \| .*results/.* \|$", TEXT, re.M)
    folders = {name for row in rows for name in re.findall(r"`(\w+)/`", row)}
    assert {"meshes", "attention", "touches", "scene", "studies"} <= folders
    assert {name for name in folders if not (ROOT / "src/visuohaptic" / name).is_dir()} == set()
