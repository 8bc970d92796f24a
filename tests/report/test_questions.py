"""The two questions are answered by a rule, from tables alone."""

import pytest
from report.pages import plain
from report.test_comparison import BAYES, SVM, metrics

from visuohaptic.report.comparison import pipeline_tables
from visuohaptic.report.questions import (
    recognition_answer,
    reproduction_answer,
    variant_counts_sentence,
)
from visuohaptic.report.variants import Spread, VariantsSummary


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


def test_the_variants_are_counted_by_set():
    counts = {"variants": 9, "ahead": 1, "behind": 4, "ahead_holm": 0, "behind_holm": 2}
    sentence = variant_counts_sentence(variants(objects=12, **counts))
    assert sentence.endswith(
        "Fixations are ahead of random touches with p below 0.05, each variant tested by itself, in 1 of 9 variants on 12 "
        "objects (behind in 4). After Holm's correction for the number of variants they are ahead in 0 and behind in 2 of "
        "the 9 on 12 objects."
    )
    few = variant_counts_sentence(variants(objects=5, **counts))
    assert few.endswith(
        "on 5 objects (the smallest p value of so few objects, 0.062, is too large)."
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
