"""The two questions are answered by a rule, from tables alone."""

import pytest
from report.test_comparison import BAYES, SVM, metrics
from studies.readings.test_verdicts import lead_of_one_map, tables

from visuohaptic.report.comparison import read_tables
from visuohaptic.report.questions import fixation_answer, recognition_answer


def run_of(fixation=0.7, random=0.6):
    """Give the tables of a run; intervals reach 5 points to either side."""
    accuracies = ({SVM: fixation, BAYES: 0.99}, {SVM: random, BAYES: 0.2})
    return read_tables(metrics(*accuracies, {SVM: 0.1, BAYES: 0.5}))


def made_up(lead):
    return {name: [row | {"objects": 12} for row in rows] for name, rows in tables(lead).items()}


@pytest.mark.parametrize(
    ("accuracy", "word"), [(0.31, "Yes"), (0.29, "That is not shown"), (0.21, "No")]
)
def test_the_first_answer_follows_from_the_interval_and_chance(accuracy, word):
    found = recognition_answer(run_of(accuracy), 4, 5, "an unknown object")
    assert found.word == word


def test_the_first_answer_has_its_figures():
    sentence = recognition_answer(run_of(), 4, 5, "an unknown object").sentence
    assert sentence.replace("\xa0", " ") == (
        "With the support vector machine, sequences of 5 touches on an unknown object are classified "
        "correctly in 70.0 % (65.0 % to 75.0 %) in pipeline paper; guessing among 4 classes gives "
        "25.0 %."
    )


@pytest.mark.parametrize(
    ("lead", "word"),
    [
        (lambda *_: 0.1, "Yes"),
        (lambda *_: -0.1, "No"),
        (lambda *_: 0.01, "That is not shown"),
        (lead_of_one_map, "It depends"),
    ],
)
def test_the_second_answer_follows_from_the_readings_and_not_from_the_run(lead, word):
    for random in (0.2, 0.95):
        assert fixation_answer(run_of(random=random), made_up(lead)).word == word


def test_the_second_answer_says_against_what_in_which_pipeline_and_on_how_many_objects():
    found = fixation_answer(run_of(), {"paper": made_up(lead_of_one_map)["paper"]})
    sentence = found.sentence.replace("\xa0", " ")
    assert sentence.startswith(
        "With the support vector machine on 12 objects, fixation is ahead of random places that the "
        "sensor can reach by +10.0 points (+5.0 to +15.0) in pipeline paper. Over the readings"
    )
    assert "significantly ahead in " in sentence
    assert "130" not in sentence


def test_nothing_is_said_of_a_comparison_that_was_not_made():
    figures = metrics({SVM: 0.7}, {SVM: 0.6}, {SVM: 0.1}) | {"comparisons": {}}
    assert fixation_answer(read_tables(figures), {}) is None
