"""The section on objects that a model has not learnt says what was measured."""

from report.pages import plain

from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.held_out import held_out_figures
from visuohaptic.tables.schema import build_table
from visuohaptic.tables.studies import EVALUATION


def evaluation_table():
    """Return four objects that a model has not learnt, named by 1 view in two ways and by 2, and one of no known class."""
    rows = [
        {
            "strategy": "fixation", "classifier": "naive_bayes", "class": category, "object": f"new{place}",
            "views": views, "bag": bag, "known": category != "ball", "correct": place < 2,
            "covered": place < 3, "candidates": 1 + views, "unknown": place == 3,
            "stated": 0.9, "learnt": 7,
        }
        for place, category in enumerate(("cup", "cup", "box", "box", "ball"))
        for views, bag in ((1, 0), (1, 1), (2, 0))
    ]  # fmt: skip
    return build_table(EVALUATION, {name: [row[name] for row in rows] for name in rows[0]})


def test_the_sentence_counts_only_objects_of_known_classes():
    figures = held_out_figures(evaluation_table(), IntervalParameters())
    assert (figures["objects"], figures["learnt"]) == (4, 7)
    assert plain(figures["sentence"]).startswith(
        "Of 4 objects that the model has not learnt, 50.0 % are correctly classified by eye fixations of 2 views"
    )
    assert [row["views"] for row in figures["rows"]] == [1, 2]
