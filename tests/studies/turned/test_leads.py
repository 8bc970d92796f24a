"""Kept leads are those of the kept tables, and the sentences on them follow a written rule."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from report.pages import plain
from report.test_leads import lead
from studies.kept_tables import write_kept

from turned.leads import KeptLeads, question_sentence, read_kept_leads
from turned.tables import TURNED
from visuohaptic.evaluation.leads import LEADS
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.leads import verdict
from visuohaptic.tables.schema import build_rows

ROOT = Path(__file__).parents[3]


def kept_of(*leads):
    return KeptLeads(leads, 142, ("2026-11-28",))


def test_no_names_the_largest_lead_that_is_excluded_and_where_fixations_are_behind():
    leads = [lead(0.01), lead(-0.08, p=0.001, turns="vertical")]
    assert plain(question_sentence("salience", kept_of(*leads))) == (
        "No, on objects of these classes: in none of 2 conditions are fixations ahead of random places in sight, and a lead "
        "above 4.0 points is excluded (for new classes, above 7.0 points). They are behind in 1, in the paper's pipeline, "
        "upright, turned about the vertical: −8.0 points (new objects −11.0 to −5.0, new classes −14.0 to −2.0) "
        "(142 objects, after Holm's correction, measured on 2026-11-28)."
    )


def test_a_lead_that_is_not_excluded_is_not_called_no():
    said = question_sentence("salience", kept_of(lead(0.04)))
    assert said.startswith("Not shown: in none of 1 condition")
    assert "a lead above 7.0 points is excluded" in said


def test_fixations_that_are_ahead_are_counted():
    said = question_sentence("salience", kept_of(lead(0.1, p=0.001), lead(0.0)))
    assert plain(said).startswith(
        "In some conditions: in 1 of 2 conditions fixations are ahead of random places in sight, in the paper's pipeline"
    )


def test_seeing_is_said_to_help_in_the_poses_with_a_lead():
    leads = [
        lead(0.1, p=0.001, name="sight", p_classes=0.01),
        lead(0.0, name="seeing"),
        lead(-0.07, p=0.001, name="sight", turns="any"),
    ]
    assert plain(question_sentence("seeing", kept_of(*leads))) == (
        "It can, if objects are upright, facing one way: in 1 of 3 comparisons places that are seen are ahead of random "
        "places in reach, in the paper's pipeline, upright, facing one way: +10.0 points (new objects +7.0 to +13.0, new "
        "classes +4.0 to +16.0). They are behind in 1, in the paper's pipeline, turned in any way: −7.0 points (new objects "
        "−10.0 to −4.0, new classes −13.0 to −1.0). For new classes they are ahead in 1 and behind in none (142 objects, after "
        "Holm's correction, measured on 2026-11-28)."
    )


def test_seeing_without_a_lead_is_not_shown_to_help():
    said = question_sentence("seeing", kept_of(lead(0.0, name="sight")))
    assert said.startswith("Not shown: in none of 1 comparison are places that are seen ahead")


def test_two_upright_poses_are_named_together():
    leads = [lead(0.1, p=0.001, name="sight", turns=turns) for turns in ("none", "vertical")]
    said = question_sentence("seeing", kept_of(*leads))
    assert said.startswith("It can, if objects are upright: in 2 of 2 comparisons")


# The kept leads, recomputed from the files.


@pytest.fixture(scope="module")
def kept():
    return read_kept_leads(IntervalParameters())


def recomputed():
    """Leads in points by name, pipeline, turns and known part of the frame, from the kept files with pandas only."""
    drawn, turned = (
        pd.read_parquet(ROOT / f"studies/{name}/kept_benchmark.parquet")
        for name in ("draws", "turned")
    )
    accuracies, weights = {}, {}
    turned = turned[
        (turned["touches"] == 5) & ~turned["known"].isin(["statistics", "trained_upright"])
    ]
    for key, rows in turned.groupby(["pipeline", "turns", "known", "strategy"]):
        by_object = rows.set_index(["class", "object"])
        accuracies[key], weights[key] = by_object["accuracy"], by_object["weight"]
    for name in drawn["pipeline"].unique():
        for strategy in LEADS["seeing"] + LEADS["salience"]:
            accuracies.pop((name, "none", "full", strategy), None)
    for (name, strategy), rows in drawn.groupby(["pipeline", "strategy"]):
        key, by_object = (name, "none", "full", strategy), rows.groupby(["class", "object"])
        accuracies[key], weights[key] = by_object["accuracy"].mean(), by_object["weight"].first()
    found = {}
    for *key, strategy in accuracies:
        for name, (first, second) in LEADS.items():
            if strategy == first and (*key, second) in accuracies:
                difference = accuracies[*key, first] - accuracies[*key, second]
                weight = weights[*key, first].where(difference.notna())
                found[name, *key] = (difference, weight)
    return found


def test_kept_leads_are_the_weighted_means_of_the_files(kept):
    expected = {
        key: float((difference * weight).sum() / weight.sum())
        for key, (difference, weight) in recomputed().items()
    }
    found = {
        (one.name, one.pipeline, one.turns, one.known): one.difference.mean for one in kept.leads
    }
    assert found == pytest.approx(expected, abs=1e-6)
    assert len(found) == len(kept.leads)


def test_leads_by_class_are_the_weighted_means_of_the_class(kept):
    by_class = {(one.name, one.pipeline, one.turns, one.known): one.by_class for one in kept.leads}
    for key, (difference, weight) in recomputed().items():
        classes = difference.index.get_level_values("class")
        expected = (difference * weight).groupby(classes).sum() / weight.groupby(classes).sum()
        means = {name: one.mean for name, one in by_class[key].items()}
        assert means == pytest.approx(expected.to_dict(), abs=1e-6)


def test_the_counts_of_the_sentences_follow_from_sign_changes_of_the_files(kept):
    generator = np.random.default_rng(1)
    for question, names in (("seeing", ("seeing", "sight")), ("salience", ("salience",))):
        p_values = {}
        for key, (difference, weight) in recomputed().items():
            if key[0] in names:
                terms = (difference * weight).dropna().to_numpy()
                signs = generator.choice([-1.0, 1.0], size=(20_000, len(terms)))
                reached = np.abs(signs @ terms) >= np.abs(terms.sum()) - 1e-12
                p_values[key] = (np.sign(terms.sum()), (reached.sum() + 1) / 20_001)
        ahead, behind = set(), set()
        for place, (key, (sign, p)) in enumerate(
            sorted(p_values.items(), key=lambda one: one[1][1])
        ):
            if p * (len(p_values) - place) >= 0.05:
                break
            (ahead if sign > 0 else behind).add(key)
        found = verdict(kept.of(question))
        assert {(one.name, one.pipeline, one.turns, one.known) for one in found.ahead} == ahead
        assert {(one.name, one.pipeline, one.turns, one.known) for one in found.behind} == behind


def test_leads_are_of_five_touches_also_if_others_stand_behind_them(tmp_path):
    named = {
        "turns": "any", "known": "full", "pipeline": "paper", "classifier": "svm", "draws": 5,
        "weight": 1.0, "held_out": True,
    }  # fmt: skip
    rows = [
        {**named, "touches": touches, "strategy": strategy, "accuracy": value, "class": category, "object": "b"}
        for touches, strategy, value in (
            (5, "fixation", 0.5), (5, "random", 0.25), (20, "fixation", 1.0), (20, "random", 0.0),
        )
        for category in ("a", "c")
    ]  # fmt: skip
    folders = {"draws_folder": tmp_path, "turned_folder": tmp_path / "turned"}
    assert read_kept_leads(IntervalParameters(), **folders) is None
    folders["turned_folder"].mkdir()
    write_kept(build_rows(TURNED, rows), folders["turned_folder"], "benchmark")
    (found,) = read_kept_leads(IntervalParameters(), **folders).leads
    assert (found.difference.mean, found.draws, found.objects) == (0.25, 5, 2)
