"""The section on objects that a model has not learnt says what was measured."""

from report.pages import plain

from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.evaluation import evaluation_figures, odd_sentence
from visuohaptic.studies.evaluation.models import MeasuredEvaluation, read_evaluation
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


def test_where_nothing_was_measured_the_kept_evaluation_is_shown(tmp_path):
    kept = read_evaluation(tmp_path / "none")
    assert kept.source is not None
    for measured, objects in ((kept, 22), (MeasuredEvaluation(evaluation_table()), 4)):
        figures = evaluation_figures(measured, IntervalParameters())
        assert figures["objects"] == objects
        assert figures["sentence"].startswith(f"Of {objects} objects that the model has not learnt")
        said = odd_sentence(figures)
        assert bool(said) == (measured is kept)
    (row,) = (
        row
        for row in evaluation_figures(kept, IntervalParameters())["rows"]
        if (row["strategy"], row["views"]) == ("fixation", 16)
    )
    said = plain(odd_sentence(evaluation_figures(kept, IntervalParameters())))
    assert f"classifies {100 * row['accuracy'].mean:.0f} % of 22 untypical objects" in said
    assert "correctly from 16 views" in said
    assert said.endswith(f"the sets contain the class of {100 * row['coverage'].mean:.0f} %.")
