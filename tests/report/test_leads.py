"""Leads are read from metrics, and answered by a written rule."""

import pytest
from report.pages import plain

from visuohaptic.report.estimates import Estimate
from visuohaptic.report.leads import Lead, run_leads, verdict
from visuohaptic.report.questions import lead_answer


def lead(mean, half=0.03, p=0.5, name="salience", pipeline="paper", turns="none", p_classes=0.9):
    """Make a lead with an interval for new classes of twice the width."""
    figure = Estimate(
        mean, mean - half, mean + half, p, mean - 2 * half, mean + 2 * half, p_classes
    )
    return Lead(name, pipeline, turns, "full", 5, 142, figure)


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
    single = Lead("salience", "paper", "none", "full", 1, 1, Estimate(0.0, p_value=1.0))
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
