"""Sentences follow the figures."""

import pytest

from visuohaptic.report.comparison import (
    draws_sentence,
    gain_sentence,
    merge_notes,
    pipeline_tables,
)

COUNTS = {"splits": 81, "repeats": 1, "objects": 12, "sequences": 192, "notes": []}
TESTED = {"objects": 12, "exact": True}


def interval(mean):
    return {"mean": mean, "low": mean - 0.05, "high": mean + 0.05}


def wide_interval(mean):
    return {"mean": mean, "low": mean - 0.15, "high": mean + 0.15}


def lead(mean, p_value):
    return {
        "difference": interval(mean),
        "p_value": p_value,
        "difference_new_classes": wide_interval(mean),
        "p_value_new_classes": max(p_value, 0.2),
        **TESTED,
    }


def cell(mean):
    names = ("accuracy", "object_accuracy", "balanced_accuracy")
    shares = dict.fromkeys(names, interval(mean))
    shares |= {f"{name}_new_classes": wide_interval(mean) for name in names}
    return {**COUNTS, **shares, "class_accuracy": {"cup": interval(mean)}}


def metrics(fixation, random, p_values):
    """Return metrics of classifiers by their accuracies and p values."""
    cells = {
        strategy: {name: cell(mean) for name, mean in means.items()}
        for strategy, means in (("fixation", fixation), ("random", random))
    }
    compared = {
        name: {"random": lead(mean - random[name], p_values[name])}
        for name, mean in fixation.items()
    }
    return {"results": {"paper": cells}, "comparisons": {"paper": compared}}


SVM, BAYES = "support_vector_machine", "naive_bayes"


def table(p_values):
    accuracies = {SVM: 0.93, BAYES: 0.3}, {SVM: 0.8, BAYES: 0.4}
    return pipeline_tables(metrics(*accuracies, dict(zip((SVM, BAYES), p_values, strict=True))))[0]


def test_leads_and_accuracies_carry_the_interval_of_new_classes():
    row = table((0.01, 0.3)).rows[0]
    compared = row.comparisons["random"].difference
    assert compared.p_value == 0.01
    assert compared.p_value_new_classes == 0.2
    assert compared.new_classes_low < compared.low < compared.high < compared.new_classes_high
    accuracy = row.accuracy["fixation"]
    assert accuracy.new_classes_low == pytest.approx(accuracy.mean - 0.15)
    assert accuracy.p_value is None


def test_the_gain_is_said_with_what_is_significant():
    sentence = gain_sentence(table((0.001, 0.6)))
    assert (
        "Fixations are ahead of random probing with 1 of 2 classifiers and behind with 1"
        in sentence
    )
    assert "significant for support vector machine (+13.0)" in sentence
    unsettled = gain_sentence(table((0.03, 0.6)))
    assert (
        "no difference is significant (the smallest p after Holm's correction is 0.06)" in unsettled
    )


def test_the_spread_over_draws_is_said_where_there_are_several():
    figures = metrics({SVM: 0.9}, {SVM: 0.8}, {SVM: 0.5})
    assert draws_sentence(pipeline_tables(figures)[0]) == ""
    compared = figures["comparisons"]["paper"][SVM]["random"]
    compared["draws"] = {"count": 3, "leads": [0.1, 0.04, -0.02], "standard_deviation": 0.06}
    sentence = draws_sentence(pipeline_tables(figures)[0])
    assert "support vector machine by random probing are means over 3 draws" in sentence
    assert (
        "The lead of fixations over each single draw is between −2.0 and +10.0 points" in sentence
    )
    assert sentence.endswith("(standard deviation 6.0 points).")


def test_a_single_lead_has_no_spread_over_draws():
    figures = metrics({SVM: 0.9}, {SVM: 0.8}, {SVM: 0.5})
    compared = figures["comparisons"]["paper"][SVM]["random"]
    # The workflow writes this if all further draws failed.
    compared["draws"] = {"count": 1, "leads": [0.1], "standard_deviation": 0.0}
    (found,) = pipeline_tables(figures)
    assert found.headline.comparisons["random"].draws is None
    assert draws_sentence(found) == ""


def test_only_the_papers_pipeline_stands_beside_the_paper():
    figures = metrics({SVM: 0.9}, {SVM: 0.8}, {SVM: 0.5})
    figures["results"]["order_free"] = figures["results"]["paper"]
    tables = pipeline_tables(figures)
    assert tables[0].best.key == SVM
    assert [table.name for table in tables] == ["paper", "order_free"]
    assert tables[0].rows[0].published
    assert not tables[1].rows[0].published


def test_notes_that_differ_in_a_number_are_one():
    notes = {"chosen: tree_leaf 8", "chosen: tree_leaf 1", "singular: shrunk", "chosen: c 1e-05"}
    assert merge_notes(notes) == (
        "chosen: c 1e-05", "chosen: tree leaf 1 or 8", "singular: shrunk",
    )  # fmt: skip
    assert merge_notes([]) == ()


def test_p_values_are_corrected_for_all_classifiers_and_strategies_of_the_pipeline():
    figures = metrics({SVM: 0.9, BAYES: 0.8}, {SVM: 0.7, BAYES: 0.6}, {SVM: 0.01, BAYES: 0.02})
    figures["results"]["paper"]["curvature"] = {name: cell(0.5) for name in (SVM, BAYES)}
    for name, p_value in ((SVM, 0.015), (BAYES, 0.4)):
        compared = lead(0.3, p_value)
        figures["comparisons"]["paper"][name]["curvature"] = compared
    (found,) = pipeline_tables(figures)
    adjusted = {
        (row.key, strategy): comparison.adjusted_p
        for row in found.rows
        for strategy, comparison in row.comparisons.items()
    }
    # Holm by hand: of four sorted p values the first times 4, the second times 3, and so on, never falling.
    assert adjusted == {
        (SVM, "random"): pytest.approx(4 * 0.01),
        (SVM, "curvature"): pytest.approx(3 * 0.015),
        (BAYES, "random"): pytest.approx(3 * 0.015),
        (BAYES, "curvature"): pytest.approx(0.4),
    }
