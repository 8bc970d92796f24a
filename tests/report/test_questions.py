"""The questions are answered by written rules, from tables only."""

import pytest
from report.pages import plain
from report.test_comparison import BAYES, SVM, lead, metrics

from visuohaptic.report.comparison import pipeline_tables
from visuohaptic.report.estimates import Estimate
from visuohaptic.report.questions import (
    recognition_answer,
    reproduction_answer,
    strategies_answer,
    verdict_on,
)


def run_of(fixation=0.7, random=0.6):
    """Return the tables of a run; intervals reach 5 points to either side."""
    accuracies = ({SVM: fixation, BAYES: 0.99}, {SVM: random, BAYES: 0.2})
    return pipeline_tables(metrics(*accuracies, {SVM: 0.1, BAYES: 0.5}))


def other_strategies(**leads):
    """Return the table of a run with leads of fixations over other strategies, as (points, p)."""
    figures = metrics({SVM: 0.7}, {SVM: 0.6}, {SVM: 0.5})
    compared = figures["comparisons"]["paper"][SVM]
    compared |= {name: lead(mean, p) for name, (mean, p) in leads.items()}
    return pipeline_tables(figures)[0]


def test_a_run_with_random_places_only_has_no_answer_on_other_strategies():
    assert strategies_answer(other_strategies()) is None
    assert strategies_answer(other_strategies(random_visible=(0.1, 0.001))) is None


def test_another_strategy_is_ahead_or_behind_after_holms_correction():
    # With random places four comparisons: the p values are multiplied by 4, 3, 2 and 1.
    found = strategies_answer(
        other_strategies(mine=(-0.12, 0.001), curvature=(0.2, 0.01), grid=(0.05, 0.2))
    )
    assert found.finding == "Fixations are behind mine and ahead of the most curved places"
    assert plain(found.number) == "−12.0 points"
    assert plain(found.sentence) == (
        "(new objects −17.0 to −7.0, new classes −27.0 to +3.0) is the lead of fixations over mine, over the most curved "
        "places +20.0 (+15.0 to +25.0), over grid +5.0 (+0.0 to +10.0) (support vector machine, the paper's pipeline)."
    )


def test_a_strategy_that_is_neither_ahead_nor_behind_is_said_to_be_not_shown():
    found = strategies_answer(other_strategies(mine=(0.12, 0.03)))
    assert found.finding == "No difference is shown by 12 objects"


@pytest.mark.parametrize(
    ("accuracy", "finding"), [(0.31, "Yes"), (0.29, "Not shown"), (0.21, "No")]
)
def test_the_first_answer_follows_from_the_interval_and_chance(accuracy, finding):
    found = recognition_answer(run_of(accuracy), 4, 5, "unseen objects", "vertical")
    assert found.finding == finding
    assert plain(found.number) == f"{100 * accuracy:.1f} %"
    assert plain(found.sentence).startswith(
        f"(new objects {100 * accuracy - 5:.1f} % to {100 * accuracy + 5:.1f} %"
    )
    assert ") of 5-touch sequences of unseen objects are correctly" in plain(found.sentence)
    assert plain(found.sentence).endswith(
        "(support vector machine, 12 objects); guessing gives 25 %."
    )
    assert found.caveats == (
        "Objects are upright, turned about the vertical, in training and test.",
    )


NEAR = ({SVM: 0.93, BAYES: 0.57}, {SVM: 0.86, BAYES: 0.57})


@pytest.mark.parametrize(
    ("here", "expected"),
    [
        (Estimate(0.80, 0.76, 0.84), "reproduced"),
        # Equivalence within the margin also if the difference is measurable.
        (Estimate(0.82, 0.81, 0.84), "reproduced"),
        (Estimate(0.80, 0.70, 0.90), "undecided"),
        (Estimate(0.90, 0.80, 0.95), "undecided"),
        (Estimate(0.90, 0.81, 0.95), "differs"),
        (Estimate(0.70, 0.60, 0.79), "differs"),
        (Estimate(0.80), "undecided"),
    ],
)
def test_three_words_judge_a_published_accuracy_of_80_percent(here, expected):
    assert verdict_on(here, 0.80) == expected


@pytest.mark.parametrize(
    ("accuracies", "reach", "finding", "differing", "same"),
    [
        (NEAR, 0.02, "Reproduced", 0, 4),
        (NEAR, 0.06, "Undecided", 0, 0),
        (({SVM: 0.93, BAYES: 0.9}, {SVM: 0.5, BAYES: 0.9}), 0.02, "Differs", 3, 1),
        (({SVM: 0.7, BAYES: 0.9}, {SVM: 0.5, BAYES: 0.9}), 0.1, "Differs", 4, 0),
    ],
)
def test_the_third_answer_counts_what_differs_and_what_is_reproduced(
    accuracies, reach, finding, differing, same
):
    figures = metrics(*accuracies, {SVM: 0.1, BAYES: 0.5})
    for by_classifier in figures["results"]["paper"].values():
        for cell in by_classifier.values():
            mean = cell["accuracy"]["mean"]
            cell["accuracy"] = {"mean": mean, "low": mean - reach, "high": mean + reach}
    found = reproduction_answer(pipeline_tables(figures)[0])
    assert found.finding == finding
    said = plain(found.sentence)
    assert (
        f"of 4 published accuracies {differing} differ (they lie outside our interval), {same} are reproduced, and "
        f"{4 - differing - same} are undecided."
    ) in said
    assert ("With 12 objects none can be shown to be reproduced" in said) == (2 * reach > 0.1)
