"""A model is evaluated on objects that it has not learnt, and on no others."""

import dataclasses

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pytest
from recognition.synthetic import features_table, with_column

from visuohaptic.base.errors import RecognitionError
from visuohaptic.evaluation.held_out import evaluate_model, summarise_evaluation
from visuohaptic.evaluation.summary import select
from visuohaptic.recognition.model import fit_model
from visuohaptic.recognition.parameters import IntervalParameters, RecognitionParameters

ALL = features_table(objects=(5, 5, 5), viewpoints=4, separation=2.0)
LEARNT = ALL.filter(pc.is_in(ALL["object"], pa.array(["object0", "object1", "object2"])))


@pytest.fixture(scope="module")
def model():
    return fit_model(LEARNT, "order_free", "naive_bayes", RecognitionParameters(), 1)


@pytest.fixture(scope="module")
def evaluated(model):
    return evaluate_model(model, ALL)


def test_each_object_that_was_not_learnt_is_named_by_every_choice_of_its_views(evaluated):
    named = evaluated.group_by(["class", "object", "views"]).aggregate([([], "count_all")])
    counts = {tuple(row.values())[:3]: row["count_all"] for row in named.to_pylist()}
    assert counts == {
        (f"class{place}", name, views): choices
        for place in range(3)
        for name in ("object3", "object4")
        for views, choices in ((1, 4), (4, 1))
    }


def test_the_answers_are_those_that_the_model_gives(model, evaluated):
    one = select(ALL, **{"class": "class1"}, object="object3")
    answer = model.answer(select(one, viewpoint=2))
    (row,) = select(evaluated, **{"class": "class1"}, object="object3", views=1, bag=2).to_pylist()
    assert row["correct"] == (next(iter(answer.probabilities)) == "class1")
    assert row["candidates"] == len(answer.candidates)
    assert row["covered"] == ("class1" in answer.candidates)
    # Of too few objects, the model calls no object unknown.
    assert (row["unknown"], answer.unknown) == (False, None)


def test_a_model_of_several_strategies_is_evaluated_on_the_touches_by_each(model):
    random = features_table("random", objects=(4, 4, 4), viewpoints=4, separation=2.0, seed=3)
    other = features_table("contour", objects=(5, 5, 5), viewpoints=4, separation=2.0, seed=3)
    learnt = random.filter(pc.is_in(random["object"], pa.array(["object0", "object1", "object2"])))
    both = fit_model(
        pa.concat_tables([LEARNT, learnt]), "order_free", "naive_bayes", RecognitionParameters(), 1
    )
    found = evaluate_model(both, pa.concat_tables([ALL, random, other]))
    counts = found.group_by("strategy").aggregate([([], "count_all")]).to_pylist()
    # Two new objects of each class by fixation, and one by random, each from one and from four views.
    assert {row["strategy"]: row["count_all"] for row in counts} == {"fixation": 30, "random": 15}


def test_the_summary_is_of_shares_over_objects(evaluated):
    one, every = summarise_evaluation(evaluated, IntervalParameters())
    assert (one["views"], every["views"], every["stated"]) == (1, 4, 0.9)
    rows = select(evaluated, views=1)
    assert one["accuracy"][0] == pytest.approx(np.mean(rows["correct"].to_numpy()))
    assert one["set_size"] == pytest.approx(np.mean(rows["candidates"].to_numpy()))
    assert "found_unknown" not in one


def test_an_object_of_a_class_that_the_model_does_not_know_is_counted_apart(model):
    names = pc.replace_substring(ALL["class"], "class2", "ball")
    found = evaluate_model(model, with_column(ALL, "class", names.combine_chunks()))
    strange = select(found, known=False).to_pylist()
    assert not any(row["correct"] or row["covered"] for row in strange)
    figures = summarise_evaluation(found, IntervalParameters())[-1]
    known = summarise_evaluation(select(found, known=True), IntervalParameters())[-1]
    assert figures["accuracy"] == known["accuracy"]
    assert "found_unknown" in figures


def test_a_model_that_knows_all_objects_or_has_no_prediction_sets_is_not_evaluated(model):
    with pytest.raises(RecognitionError, match="None of 9 objects touched by fixation is new"):
        evaluate_model(model, LEARNT)
    with pytest.raises(RecognitionError, match="no prediction sets"):
        evaluate_model(dataclasses.replace(model, certainties={}), ALL)
