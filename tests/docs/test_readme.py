"""The README's answers and tables say what their sources say, and its folders exist."""

import json
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
    """Rows of the table: classifier, by fixation, published, random, published."""
    return {name: cells for name, *cells in table_rows(TEXT, "results")}


def test_only_naive_bayes_is_right_more_often_than_published(accuracies):
    above = {
        name
        for name, cells in accuracies.items()
        for here, published in ((0, 1), (2, 3))
        if cells[published] and float(cells[here].split()[0]) > float(cells[published].split()[0])
    }
    assert above == {"naïve Bayes"}
    assert "All classifiers except naïve Bayes are right less often than published" in WORDS


def test_with_the_svm_fixations_do_not_lead(accuracies):
    fixation, random = (float(accuracies["SVM"][place].split()[0]) for place in (0, 2))
    assert fixation <= random


def test_the_published_figures_are_those_of_the_paper(accuracies):
    shown = {float(cells[place].split()[0]) for cells in accuracies.values() for place in (1, 3)}
    published = {round(100 * value, 2) for by in TABLE_1.values() for value in by.values()}
    assert shown == published


def test_the_answers_name_the_accuracies_of_the_tables(accuracies):
    said = " ".join(block("answers").split())
    headline = pd.read_csv(DEFAULT_RUN / "reports-headline.csv", index_col="figure")["number"]
    paper, ours = (f"{headline[name]:.1f} %" for name in ("fixation", "order_free_fixation"))
    assert accuracies["SVM"][0].startswith(f"{paper} (")
    assert (
        f"in {paper} of cases by the paper's pipeline and in {ours} by ours (`order_free`)" in said
    )
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
    assert f"of {len(seeing.leads)} comparisons seeing led in {len(seeing.ahead)}," in said
    assert f"trailed in {len(seeing.behind)}, with objects turned in any way, by" in said
    of_classes = verdict(kept.of("seeing"), "classes")
    assert f"it led in {len(of_classes.ahead)} and trailed in {len(of_classes.behind)}." in said
    for leads, end in ((seeing.ahead, max), (seeing.behind, min)):
        assert f"by up to {points(end(lead.difference.mean for lead in leads))}" in said
    assert all(lead.turns in {"none", "vertical"} for lead in seeing.ahead)
    assert {lead.turns for lead in seeing.behind} == {"any"}
    assert not salience.ahead
    assert (
        f"in none of {len(salience.leads)} comparisons and trailed in {len(salience.behind)},"
        in said
    )
    largest = max(lead.difference.high for lead in kept.of("salience"))
    drawn = max(lead.difference.new_classes_high for lead in kept.of("salience"))
    assert f"a lead above {100 * largest:.1f} points is excluded in each." in said
    assert f"For other classes leads up to {100 * drawn:.1f} points remain possible." in said


def test_most_of_the_accuracy_is_where_the_arm_is():
    kept = pd.read_parquet(ROOT / "studies/cues/kept_paper.parquet")
    setting = {
        "tested": "new", "turns": "none", "frame": "full", "touches": 5, "pipeline": "order_free", "strategy": "fixation",
    }  # fmt: skip
    rows = kept[(kept[list(setting)] == pd.Series(setting)).all(axis=1)]
    means = {
        cue: (own["accuracy"] * own["weight"]).sum() / own["weight"].sum()
        for cue, own in rows.groupby("cues")
    }
    assert means["pose"] > 0.95 * means["all"] > means["imprint"]
    assert "mostly by [where the arm is](studies/cues/README.md)" in " ".join(
        block("answers").split()
    )


def test_the_cost_of_a_view_is_that_of_study_views():
    kept = json.loads((ROOT / "studies/views/kept_benchmark.json").read_text(encoding="utf-8"))
    second = {
        pipeline: next(iter(kept["figures"][pipeline]["fixation"].values()))["2 views"]
        for pipeline in ("order_free", "paper")
    }
    said = " ".join(block("answers").split())
    prices = CostParameters()
    assert f"takes a robot {prices.look_seconds + 5 * prices.touch_seconds:.1f} s" in said
    assert f"gains {points(second['order_free']['difference'])} points in our pipeline" in said
    assert second["order_free"]["difference_low"] > 0
    assert second["paper"]["difference_low"] <= 0 <= second["paper"]["difference_high"]


def test_the_variants_are_those_of_the_study():
    literal = kept_summary().literal["fixation"]["support_vector_machine"]
    assert f"not the default, has {100 * literal:.1f} % with the SVM" in WORDS
    of_svm = summarise_variants(kept_variants(PAPER_SET).rows)["classifiers"][
        "support_vector_machine"
    ]
    assert of_svm["variants_reaching"] == 0
    assert (
        f"none of {of_svm['variants']} [variants](studies/variants/README.md) reaches 93.45 %"
        in WORDS
    )


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


def test_the_named_folders_and_phases_are_those_of_the_tree():
    phases = re.search(r"Each phase \((.*?)\)", WORDS)[1].split(", ")
    assert len(phases) == 6
    for name in phases:
        assert (ROOT / "src/visuohaptic" / name).is_dir()
        assert (ROOT / "tests" / name).is_dir()
        assert (ROOT / f"workflow/scripts/{name}.py").is_file()
    named = set(re.findall(r"`([a-z/]+)/`", WORDS[WORDS.index("Each phase") :]))
    assert {"attention", "sensor", "scene"} <= named
    homes = (ROOT, ROOT / "src/visuohaptic")
    made_by_a_run = {"results"}
    missing = {name for name in named if not any((home / name).is_dir() for home in homes)}
    assert missing - made_by_a_run == set()
