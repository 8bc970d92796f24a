"""The two questions are answered by a rule, from tables alone."""

import pytest
from report.pages import plain
from report.test_comparison import BAYES, SVM, metrics

from visuohaptic.report.comparison import pipeline_tables
from visuohaptic.report.questions import (
    fixation_answer,
    recognition_answer,
    reproduction_answer,
    variant_counts_sentence,
    variant_leads_sentences,
)
from visuohaptic.report.variants import Lead, Spread, VariantsSummary


def run_of(fixation=0.7, random=0.6):
    """Give the tables of a run; intervals reach 5 points to either side."""
    accuracies = ({SVM: fixation, BAYES: 0.99}, {SVM: random, BAYES: 0.2})
    return pipeline_tables(metrics(*accuracies, {SVM: 0.1, BAYES: 0.5}))


def variants(verdict="not shown", **spread):
    return VariantsSummary(verdict=verdict, spread=(Spread(**spread),) if spread else ())


@pytest.mark.parametrize(
    ("accuracy", "finding"), [(0.31, "Yes"), (0.29, "Not shown"), (0.21, "No")]
)
def test_the_first_answer_follows_from_the_interval_and_chance(accuracy, finding):
    found = recognition_answer(run_of(accuracy), 4, 5, "unseen objects", "vertical")
    assert found.finding == finding
    assert plain(found.number).startswith(f"{100 * accuracy:.1f} % (")
    assert plain(found.sentence).startswith("of 5-touch sequences of unseen objects are correctly")
    assert plain(found.sentence).endswith(
        "(support vector machine, 12 objects); guessing gives 25 %."
    )
    assert found.beside == (
        "Objects are upright, turned about the vertical, in training and test.",
    )


@pytest.mark.parametrize(
    ("random", "finding", "excluded"),
    [
        (0.6, "Yes, on these objects", ""),
        (
            0.68,
            "Not settled by 12 objects",
            " The interval excludes a lead above 7.0 points and a lead below −3.0 points.",
        ),
        (0.8, "No, on these objects random touches lead", ""),
    ],
)
def test_a_lead_has_a_sign_only_where_its_interval_excludes_zero(random, finding, excluded):
    found = fixation_answer(run_of(random=random), variants("no"), ["Beside."])
    assert found.finding == finding
    assert " points (" in plain(found.number)
    assert plain(found.sentence).endswith(f"in the paper's pipeline.{excluded}")
    assert found.beside == ("Beside.",)
    assert (
        "(studies/variants): no (the default and the most literal variant exclude a gain"
        in found.rule
    )


def test_the_variants_are_counted_by_set():
    sentence = variant_counts_sentence(variants(objects=12, variants=9, ahead=1, behind=4))
    assert sentence.endswith(
        "significantly ahead of random touches in 1 of 9 variants on 12 objects (significantly behind in 4)."
    )
    assert variant_counts_sentence(variants()) == ""


NEAR = ({SVM: 0.93, BAYES: 0.57}, {SVM: 0.86, BAYES: 0.57})


@pytest.mark.parametrize(
    ("accuracies", "reach", "finding", "counts"),
    [
        (NEAR, 0.02, "Yes, within 5 points", (4, 0)),
        (NEAR, 0.05, "Not settled", (0, 0)),
        (
            ({SVM: 0.93, BAYES: 0.9}, {SVM: 0.5, BAYES: 0.9}),
            0.02,
            "No for 3 of 4 accuracies",
            (1, 3),
        ),
        (
            ({SVM: 0.7, BAYES: 0.9}, {SVM: 0.5, BAYES: 0.9}),
            0.02,
            "No for 4 of 4 accuracies",
            (0, 4),
        ),
    ],
)
def test_the_third_answer_asks_whether_whole_intervals_are_near(accuracies, reach, finding, counts):
    figures = metrics(*accuracies, {SVM: 0.1, BAYES: 0.5})
    for by_classifier in figures["results"]["paper"].values():
        for cell in by_classifier.values():
            mean = cell["accuracy"]["mean"]
            cell["accuracy"] = {"mean": mean, "low": mean - reach, "high": mean + reach}
    found = reproduction_answer(pipeline_tables(figures)[0])
    assert found.finding == finding
    within, outside = counts
    assert (
        f"Of 4 published accuracies {within} are reproduced, {outside} are not (our whole interval is more than 5 "
        f"points away), and {4 - within - outside} are not settled."
    ) in found.sentence
    assert plain(found.sentence).startswith(
        "here, 93.45 % published (support vector machine, eye fixations). "
    )


LEADS = [
    Lead(
        objects=objects,
        variant=variant,
        opponent=opponent,
        difference=one,
        low=one - 0.05,
        high=one + 0.05,
    )
    for objects in (12, 130)
    for variant, opponent, one in (
        ("default", "reachable", objects / 1000),
        ("default", "visible", -0.02),
        ("literal", "reachable", -0.03),
    )
]


def test_both_readings_on_most_objects_are_said_beside_the_second_answer():
    first, second = map(plain, variant_leads_sentences(VariantsSummary(verdict="no", leads=LEADS)))
    assert first.startswith(
        "The paper leaves steps open. We chose the default for these steps on 130 objects, and this choice may raise the "
        "lead on these objects. On the 130 objects the lead of the default is +13.0 points (+8.0 to +18.0) over random places in reach, and \N{MINUS SIGN}2.0 points"
    )
    assert first.endswith("(in this run).")
    dates = {12: "2026-11-23", 130: "2026-11-27"}
    kept = [lead.model_copy(update={"date": dates[lead.objects]}) for lead in LEADS]
    dated = variant_leads_sentences(VariantsSummary(verdict="no", leads=kept))[0]
    assert plain(dated).endswith("(measured on 2026-11-27).")
    assert "\N{MINUS SIGN}3.0 points (\N{MINUS SIGN}8.0 to +2.0) over random places" in second
    assert variant_leads_sentences(VariantsSummary(verdict="no", leads=LEADS[:2])) == []
    assert variant_leads_sentences(VariantsSummary(verdict="no")) == []


def test_nothing_is_said_of_a_comparison_that_was_not_made():
    figures = metrics({SVM: 0.7}, {SVM: 0.6}, {SVM: 0.1}) | {"comparisons": {}}
    assert fixation_answer(pipeline_tables(figures), variants()) is None
