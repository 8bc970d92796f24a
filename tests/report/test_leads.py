"""Leads are read from kept accuracies and metrics, and answered by a written rule."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from report.pages import plain

import visuohaptic.report
from visuohaptic.evaluation.leads import LEADS
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.estimates import Figure
from visuohaptic.report.leads import (
    KeptLeads,
    Lead,
    question_sentence,
    read_kept_leads,
    run_leads,
    verdict,
)
from visuohaptic.report.questions import lead_answer
from visuohaptic.report.turned import TurnedSet

KEPT = Path(visuohaptic.report.__file__).parent


def lead(mean, half=0.03, p=0.5, name="salience", pipeline="paper", turns="none", p_classes=0.9):
    """Make a lead with an interval for new classes of twice the width."""
    figure = Figure(mean, mean - half, mean + half, p, mean - 2 * half, mean + 2 * half, p_classes)
    return Lead(name, pipeline, turns, "full", 5, 142, figure)


def kept_of(*leads):
    return KeptLeads(leads, 142, ("2026-11-28",))


@pytest.mark.parametrize(
    ("leads", "word", "excluded"),
    [
        ([lead(0.1, p=0.001), lead(0.08, p=0.02)], "yes", 0.13),
        # Holm's correction takes one of two leads back.
        ([lead(0.1, p=0.001), lead(0.08, p=0.06)], "not settled", 0.13),
        ([lead(0.01), lead(-0.08, p=0.001)], "no", 0.04),
        ([lead(0.01), lead(0.03)], "not settled", 0.06),
        ([lead(0.02, p=0.01, half=0.01), lead(0.0)], "not settled", 0.03),
    ],
)
def test_the_word_follows_the_rule(leads, word, excluded):
    found = verdict(leads)
    assert found.word == word
    assert found.excluded == pytest.approx(excluded)


def test_a_lead_without_an_interval_excludes_nothing():
    single = Lead("salience", "paper", "none", "full", 1, 1, Figure(0.0, p_value=1.0))
    found = verdict([lead(0.0), single])
    assert (found.word, found.excluded) == ("not settled", None)
    assert verdict([lead(0.0), single], "classes").excluded is None


def test_new_classes_have_their_own_p_values_and_ends():
    leads = [lead(0.1, p=0.001, p_classes=0.2), lead(0.08, p=0.001, p_classes=0.03)]
    assert verdict(leads).word == "yes"
    found = verdict(leads, "classes")
    # Holm's correction of 0.03 for two leads.
    assert found.ahead == ()
    assert found.excluded == pytest.approx(0.16)


def test_p_values_are_corrected_for_the_number_of_leads():
    twenty = [lead(0.1, p=0.004) for _ in range(20)]
    assert not verdict(twenty).ahead
    assert len(verdict(twenty[:12]).ahead) == 12


def test_no_names_the_largest_lead_that_is_excluded_and_where_fixations_are_behind():
    leads = [lead(0.01), lead(-0.08, p=0.001, turns="vertical")]
    assert plain(question_sentence("salience", kept_of(*leads))) == (
        "Salience does not help on objects of these classes. In none of 2 conditions are fixations ahead of random places in "
        "sight. A lead above 4.0 points is excluded in each; for new classes only a lead above 7.0 points is excluded; "
        "fixations are behind in 1, in the paper's pipeline, upright, turned about the vertical (−8.0 points (new objects "
        "−11.0 to −5.0, new classes −14.0 to −2.0)) (142 objects, measured on 2026-11-28)."
    )


def test_a_lead_that_is_not_excluded_is_not_called_no():
    said = question_sentence("salience", kept_of(lead(0.04)))
    assert said.startswith("Salience is not shown to help. In none of 1 condition")
    assert "A lead above 7.0 points is excluded" in said


def test_seeing_is_said_to_help_in_the_poses_with_a_lead():
    leads = [
        lead(0.1, p=0.001, name="sight", p_classes=0.01),
        lead(0.0, name="seeing"),
        lead(-0.07, p=0.001, name="sight", turns="any"),
    ]
    assert plain(question_sentence("seeing", kept_of(*leads))) == (
        "Seeing can help if objects are upright, facing one way, and is not shown to help if they are turned in any way. In 1 "
        "of 3 comparisons places that are seen are ahead of random places in reach, in the paper's pipeline, "
        "upright, facing one way (+10.0 points (new objects +7.0 to +13.0, new classes +4.0 to +16.0)), and in 1 they are "
        "behind, in the paper's pipeline, turned in any way (−7.0 points (new objects −10.0 to −4.0, new classes "
        "−13.0 to −1.0)); for new classes, too, they are ahead in 1 and behind in none (142 objects, measured on 2026-11-28)."
    )


def test_two_upright_poses_are_named_together():
    leads = [lead(0.1, p=0.001, name="sight", turns=turns) for turns in ("none", "vertical")]
    said = question_sentence("seeing", kept_of(*leads))
    assert said.startswith("Seeing can help if objects are upright. In 2 of 2 comparisons")


METRICS = {
    "leads": {
        "paper": {
            "support_vector_machine": {
                "seeing": {
                    "difference": {"mean": 0.1, "low": -0.02, "high": 0.22},
                    "difference_new_classes": {"mean": 0.1, "low": -0.12, "high": 0.32},
                    "p_value_new_classes": 0.2, "classes": 4,
                    "p_value": 0.08, "objects": 12, "exact": True,
                    "draws": {"count": 5, "leads": [0.1], "standard_deviation": 0.026},
                },
                "salience": {
                    "difference": {"mean": 0.01, "low": None, "high": None},
                    "difference_new_classes": {"mean": 0.01, "low": None, "high": None},
                    "p_value_new_classes": None, "classes": 1,
                    "p_value": 1.0, "objects": 1, "exact": True,
                    "draws": {"count": 1, "leads": [0.01], "standard_deviation": 0.0},
                },
            }
        }
    }
}  # fmt: skip


def own_leads(**classifiers):
    chosen = classifiers or {"paper": "support_vector_machine"}
    return run_leads(METRICS, chosen, "none", "full")


def test_an_answer_has_the_lead_of_the_run_and_what_is_excluded():
    found = lead_answer("seeing", own_leads())
    assert found.finding == "Not settled by 12 objects"
    assert plain(found.number) == "+10.0 points"
    assert plain(found.sentence).startswith(
        "(new objects −2.0 to +22.0, new classes −12.0 to +32.0) is the lead of fixations over random places in reach in the "
        "paper's pipeline (mean of 5 draws of random places in reach; standard deviation over draws 2.6 points). A lead above 22.0 points is excluded (new classes: 32.0)."
    )
    assert found.caveats == ()


def test_a_lead_of_one_object_has_no_interval_and_excludes_nothing():
    found = lead_answer("salience", own_leads())
    assert found.finding == "Not settled by 1 object"
    assert plain(found.number) == "+1.0 points"
    assert found.sentence.startswith("is the lead of fixations over random places in sight")
    assert "excluded" not in found.sentence
    assert found.caveats == ()


@pytest.mark.parametrize(
    ("question", "missing"),
    [("seeing", "random places in reach"), ("salience", "random places in sight")],
)
def test_a_run_that_lacks_a_strategy_says_what_it_can_not_say(question, missing):
    found = lead_answer(question, own_leads(order_free="linear_discriminant"))
    assert found.finding == "This run can't say"
    assert found.number == ""
    assert missing in found.sentence


@pytest.mark.parametrize(("mean", "half"), [(0.0, 1.0), (-0.5, 0.1)])
def test_a_lead_that_excludes_nothing_or_lies_below_0_has_no_sentence_on_what_is_excluded(
    mean, half
):
    assert "excluded" not in lead_answer("salience", [lead(mean, half)]).sentence


def test_a_run_of_another_version_without_leads_has_none():
    assert run_leads({}, {"paper": "support_vector_machine"}, "none", "full") == ()


# The kept leads, recomputed from the files.


@pytest.fixture(scope="module")
def kept():
    return read_kept_leads(IntervalParameters())


def recomputed():
    """Leads in points by name, pipeline, turns and known part of the frame, from the kept files with pandas only."""
    drawn = json.loads((KEPT / "draws.json").read_text())["benchmark"]
    turned = json.loads((KEPT / "turned.json").read_text())["benchmark"]
    accuracies, weights = {}, {}
    for cell in turned["cells"]:
        if cell["touches"] == 5 and cell["known"] not in {"statistics", "trained_upright"}:
            key = cell["pipeline"], cell["turns"], cell["known"]
            accuracies[*key, cell["strategy"]] = pd.Series(cell["accuracy"], turned["objects"])
            weights[*key, cell["strategy"]] = pd.Series(cell["weights"], turned["objects"])
    for name, one in drawn["pipelines"].items():
        key = name, "none", "full"
        for strategy in LEADS["seeing"] + LEADS["salience"]:
            accuracies.pop((*key, strategy), None)
        for strategy, draws in {"fixation": [one["fixation"]], **one["draws"]}.items():
            table = pd.DataFrame(draws, columns=drawn["objects"], dtype=float)
            accuracies[*key, strategy] = table.mean()
            weights[*key, strategy] = pd.Series(one["weights"], drawn["objects"])
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
        classes = difference.index.str.partition("/").get_level_values(0)
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


def test_leads_are_of_five_touches_also_if_others_stand_behind_them(monkeypatch):
    named = {"turns": "any", "known": "full", "pipeline": "paper", "classifier": "svm", "draws": 5}
    cells = [
        {**named, "touches": touches, "strategy": strategy, "accuracy": [value, value], "weights": [1.0, 1.0]}
        for touches, strategy, value in (
            (5, "fixation", 0.5), (5, "random", 0.25), (20, "fixation", 1.0), (20, "random", 0.0),
        )
    ]  # fmt: skip
    kept = TurnedSet.model_validate(
        {
            "commit": "0",
            "date": "2026-11-28",
            "objects": ["a/b", "c/d"],
            "choosing": [],
            "cells": cells,
        }
    )
    monkeypatch.setattr("visuohaptic.report.leads.read_turned", lambda: {"benchmark": kept})
    monkeypatch.setattr("visuohaptic.report.leads.read_kept", dict)
    (found,) = read_kept_leads(IntervalParameters()).leads
    assert (found.difference.mean, found.draws, found.objects) == (0.25, 5, 2)
    monkeypatch.setattr("visuohaptic.report.leads.read_turned", dict)
    assert read_kept_leads(IntervalParameters()) is None
