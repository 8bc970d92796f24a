"""The two questions are answered by a rule, from tables alone."""

import pytest
from report.pages import plain
from report.test_comparison import BAYES, SVM, metrics

from visuohaptic.report.comparison import pipeline_tables
from visuohaptic.report.estimates import Figure
from visuohaptic.report.questions import (
    papers_pipeline_sentences,
    recognition_answer,
    reproduction_answer,
    variant_counts_sentence,
    verdict_on,
)
from visuohaptic.report.variants import Changed, Spread, VariantsSummary


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
    assert plain(found.number) == f"{100 * accuracy:.1f} %"
    assert plain(found.sentence).startswith(
        f"(new objects {100 * accuracy - 5:.1f} % to {100 * accuracy + 5:.1f} %"
    )
    assert ") of 5-touch sequences of unseen objects are correctly" in plain(found.sentence)
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
    ("here", "expected"),
    [
        (Figure(0.80, 0.76, 0.84), "reproduced"),
        # Equivalence within the margin also if the difference is measurable.
        (Figure(0.82, 0.81, 0.84), "reproduced"),
        (Figure(0.80, 0.70, 0.90), "undecided"),
        (Figure(0.90, 0.80, 0.95), "undecided"),
        (Figure(0.90, 0.81, 0.95), "differs"),
        (Figure(0.70, 0.60, 0.79), "differs"),
        (Figure(0.80), "undecided"),
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
        f"Of 4 published accuracies {differing} differ (they lie outside our interval), {same} are reproduced, and "
        f"{4 - differing - same} are undecided."
    ) in said
    word = {"Reproduced": "reproduced", "Undecided": "undecided"}.get(
        finding, "reproduced" if same else "differs"
    )
    assert said.startswith(
        f"here, 93.45 % published (support vector machine, eye fixations): {word}. "
    )
    assert ("With 12 objects none can be shown to be reproduced" in said) == (2 * reach > 0.1)


def test_the_papers_pipeline_is_called_a_variant():
    changed = Changed(choice="channels of attention", default="five named", today="eight equal")
    literal = {"fixation": {SVM: 0.478}}
    kept = VariantsSummary(verdict="no", literal=literal, changed=(changed,))
    assert plain(papers_pipeline_sentences(kept)).endswith(
        "not the touches. Applied to later tables, the rule chooses other channels of attention: eight equal in place of "
        "five named; the default stays. The most literal variant classifies 47.8 % of the sequences by fixation correctly "
        "(support vector machine, the paper's set)."
    )
    assert papers_pipeline_sentences(VariantsSummary(verdict="no")).endswith("not the touches.")
