"""The two questions are answered by a rule, from tables alone."""

import pytest
from report.pages import plain
from report.test_comparison import BAYES, SVM, metrics

from visuohaptic.report.comparison import read_tables
from visuohaptic.report.questions import (
    fixation_answer,
    recognition_answer,
    reproduction_answer,
    variants_sentence,
)
from visuohaptic.report.variants import Spread, VariantsSummary


def run_of(fixation=0.7, random=0.6):
    """Give the tables of a run; intervals reach 5 points to either side."""
    accuracies = ({SVM: fixation, BAYES: 0.99}, {SVM: random, BAYES: 0.2})
    return read_tables(metrics(*accuracies, {SVM: 0.1, BAYES: 0.5}))


def variants(verdict="not shown", **spread):
    return VariantsSummary(verdict=verdict, spread=(Spread(**spread),) if spread else ())


@pytest.mark.parametrize(("accuracy", "word"), [(0.31, "Yes"), (0.29, "Not shown"), (0.21, "No")])
def test_the_first_answer_follows_from_the_interval_and_chance(accuracy, word):
    found = recognition_answer(run_of(accuracy), 4, 5, "unseen objects")
    assert found.word == word
    assert plain(found.number).startswith(f"{100 * accuracy:.1f} % (")
    assert plain(found.sentence).startswith("of 5-touch sequences of unseen objects correctly")
    assert plain(found.sentence).endswith("(support vector machine); guessing 25 %.")


def test_the_second_answer_follows_from_the_variants_and_not_from_the_run():
    for verdict in ("yes", "no", "not shown", "depends"):
        assert fixation_answer(run_of(random=0.2), variants(verdict)).verdict == verdict
    found = fixation_answer(run_of(), variants("no"))
    assert plain(found.number) == "+10.0 points (+5.0 to +15.0)"
    assert "above random touches, the paper's pipeline, 12 objects; " in plain(found.sentence)


def test_the_variants_are_counted_by_set():
    sentence = variants_sentence(variants(objects=12, variants=9, ahead=1, behind=4))
    assert sentence.endswith(
        "significantly ahead of random touches on 12 objects in 1 of 9 variants, and behind in 4."
    )
    assert variants_sentence(variants()) == ""


@pytest.mark.parametrize(
    ("accuracies", "word"),
    [
        (({SVM: 0.93, BAYES: 0.57}, {SVM: 0.86, BAYES: 0.57}), "Yes"),
        (({SVM: 0.93, BAYES: 0.9}, {SVM: 0.5, BAYES: 0.9}), "Depends"),
        (({SVM: 0.7, BAYES: 0.9}, {SVM: 0.5, BAYES: 0.9}), "No"),
    ],
)
def test_the_third_answer_counts_published_accuracies_within_intervals(accuracies, word):
    figures = metrics(*accuracies, {SVM: 0.1, BAYES: 0.5})
    found = reproduction_answer(read_tables(figures)[0])
    assert found.word == word
    assert "of 4 published accuracies lie within" in found.sentence
    assert plain(found.sentence).startswith("here, 93.45 % published (support vector machine); ")


def test_nothing_is_said_of_a_comparison_that_was_not_made():
    figures = metrics({SVM: 0.7}, {SVM: 0.6}, {SVM: 0.1}) | {"comparisons": {}}
    assert fixation_answer(read_tables(figures), variants()) is None
