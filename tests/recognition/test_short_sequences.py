"""Views that were touched less often than those a model learnt."""

import dataclasses

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pytest
from recognition.synthetic import features_table

from visuohaptic import recognition
from visuohaptic.evaluation.summary import select
from visuohaptic.recognition.parameters import RecognitionParameters

pytestmark = pytest.mark.slow
PARAMETERS = RecognitionParameters()
TABLE = features_table(objects=(24, 24, 24), separation=0.8)
# object0 to object2, object10 to object23
LEARNT = TABLE.filter(pc.less(TABLE["object"], "object3"))
NEW = TABLE.filter(pc.greater_equal(TABLE["object"], "object3"))


@pytest.fixture(scope="module")
def model():
    return recognition.fit_model(LEARNT, "best", "support_vector_machine", PARAMETERS, 1)


def one_view(table, touches, viewpoint=2):
    """Give each object's first touches from one view."""
    shown = select(table, viewpoint=viewpoint)
    shown = shown.filter(pc.less(shown["touch"], touches))
    names = sorted(set(zip(shown["class"].to_pylist(), shown["object"].to_pylist(), strict=True)))
    return [
        (category, select(shown, **{"class": category, "object": name})) for category, name in names
    ]


def answers(model, touches):
    """Classify each new object from each of its views: true classes and answers, both (views, objects)."""
    views = [one_view(NEW, touches, viewpoint) for viewpoint in range(4)]
    truth = [[category for category, _ in view] for view in views]
    return np.array(truth), np.array([[model.answer(rows) for _, rows in view] for view in views])


def unknown_share(model, touches):
    return np.mean([one.unknown for one in answers(model, touches)[1].ravel()])


@pytest.mark.parametrize("touches", [1, 2])
def test_answers_from_few_touches_are_not_surer_than_they_are_right(model, touches):
    truth, found = answers(model, touches)
    probabilities = [[one.probabilities for one in view] for view in found]
    named = np.array([[next(iter(one)) for one in view] for view in probabilities])
    surest = np.array([[max(one.values()) for one in view] for view in probabilities])
    surer = (surest - (named == truth)).mean(axis=0)
    assert surer.mean() < 2 * surer.std() / np.sqrt(len(surer))


@pytest.mark.parametrize("touches", [1, 3])
def test_sets_from_few_touches_hold_the_class_and_few_objects_are_unknown(model, touches):
    truth, found = answers(model, touches)
    pairs = zip(truth.ravel(), found.ravel(), strict=True)
    assert np.mean([category in one.candidates for category, one in pairs]) >= 0.8
    assert unknown_share(model, touches) <= 0.25
    assert unknown_share(dataclasses.replace(model, short={}), 1) > 0.9


def test_whole_sequences_are_classified_as_without_short_ones(model):
    without = RecognitionParameters(best={"short_touches": ()})
    plain = recognition.fit_model(LEARNT, "best", "support_vector_machine", without, 1)
    assert set(model.short) == {1, 2, 3, 4}
    assert not plain.short
    for _, rows in one_view(NEW, 5)[::7]:
        assert model.answer(rows) == plain.answer(rows)


def test_an_object_is_compared_with_known_ones_by_the_first_touches_of_a_view(model):
    table = features_table(objects=(24, 24, 24), touches=7, separation=0.8)
    new = table.filter(pc.greater_equal(table["object"], "object3"))
    for (_, rows), (_, first) in zip(one_view(new, 7), one_view(new, 5), strict=True):
        found, expected = model.answer(rows), model.answer(first)
        assert found.probabilities != expected.probabilities
        assert (found.strangeness, found.unknown) == (expected.strangeness, expected.unknown)


def test_views_of_several_lengths_have_one_answer_no_surer_than_those_of_each(model):
    _, rows = one_view(NEW, 5)[0]
    other = select(NEW, viewpoint=0, object="object3", **{"class": "class0"})
    short = other.filter(pc.less(other["touch"], 2))
    parts = [model.answer(part).probabilities for part in (rows, short)]
    found = model.answer(pa.concat_tables([rows, short])).probabilities
    assert max(found.values()) <= max(max(part.values()) for part in parts)
    logs = sum(
        share * np.log([part[name] for name in found])
        for share, part in zip((5 / 7, 2 / 7), parts, strict=True)
    )
    np.testing.assert_allclose(list(found.values()), np.exp(logs) / np.exp(logs).sum(), rtol=1e-9)


@pytest.mark.parametrize(("touches", "classified_as"), [(1, 1), (4, 4), (5, 5), (9, 10), (7, 5)])
def test_a_length_that_was_not_learnt_is_classified_as_the_one_that_is_most_like_it(
    touches, classified_as
):
    parameters = RecognitionParameters(touches=10, best={"short_touches": (1, 4, 5, 12)})
    table = features_table(objects=(2, 2), touches=10, separation=3.0)
    model = recognition.fit_model(table, "best", "naive_bayes", parameters, 1)
    assert set(model.short) == {1, 4, 5}
    rows = one_view(table, touches)[0][1]
    alone = {length: only for length, only in model.short.items() if length == classified_as}
    expected = dataclasses.replace(model, short=alone).answer(rows)
    assert model.answer(rows) == expected


def test_without_bags_or_a_second_object_nothing_more_is_learnt_or_compared():
    without = RecognitionParameters(best={"bags": ()})
    table = features_table(objects=(1, 1), separation=3.0)
    assert not recognition.fit_model(table, "best", "naive_bayes", without, 1).short
    alone = recognition.fit_model(table, "best", "naive_bayes", PARAMETERS, 1)
    answer = alone.answer(one_view(table, 2)[1][1])
    assert next(iter(answer.probabilities)) == "class1"
    assert answer.candidates is None
