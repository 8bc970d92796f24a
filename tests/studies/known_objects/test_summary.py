"""The accuracy per number of touches, and the rule that stops where an answer is certain."""

import numpy as np
import pyarrow as pa
import pytest

from known_objects.summary import CERTAIN, by_view, stop_when_certain, summarise
from known_objects.tables import KNOWN_OBJECTS
from visuohaptic.evaluation.intervals import object_interval
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.tables.schema import build_rows

INTERVALS = IntervalParameters()

PROBABILITY = np.array([[0.5, 0.96, 0.4, 0.3], [0.97, 0.2, 0.6, 0.5], [0.1, 0.99, 0.95, 0.6]])
CORRECT = np.array(
    [[False, True, True, False], [True, False, True, False], [False, True, False, True]]
)
OWNERS = np.array([0, 0, 1, 1])


def answers(strategy="fixation", correct=CORRECT):
    rows = [
        {
            "strategy": strategy,
            "turn": view % 2,
            "class": "ycb",
            "object": f"object{OWNERS[view]}",
            "viewpoint": 3,
            "touches": touch + 1,
            "answer": "ycb/object0",
            "probability": PROBABILITY[touch, view],
            "correct": bool(correct[touch, view]),
        }
        for view in range(4)
        for touch in range(3)
    ]
    return build_rows(KNOWN_OBJECTS, rows)


def test_rows_are_arranged_by_view_and_touch():
    objects, owners, correct, probability = by_view(answers())
    assert objects == ["ycb/object0", "ycb/object1"]
    assert owners.tolist() == OWNERS.tolist()
    np.testing.assert_array_equal(correct, CORRECT)
    np.testing.assert_array_equal(probability, PROBABILITY)


def test_touching_stops_at_the_first_certain_answer_or_after_the_last_touch():
    assert CERTAIN == 0.95
    found = stop_when_certain(OWNERS, CORRECT, PROBABILITY, INTERVALS)
    # Views stop after 2, 1, 3 and 3 touches; the last was never certain, and right by then.
    assert found["certain"] == 0.75
    assert found["made"] == pytest.approx(9 / 4)
    assert found["right"] == pytest.approx(2 / 3)
    assert found["stopped"] == 0.75
    assert found["median"] == 2
    assert found["made_low"] >= 1
    assert found["made_high"] <= 3
    whole = object_interval(np.array([1.0, 0.0]), np.array([2.0, 1.0]), INTERVALS)
    assert (found["right_low"], found["right_high"]) == (whole.low, whole.high)


def test_without_a_certain_answer_no_share_is_right():
    found = stop_when_certain(OWNERS, CORRECT, 0.9 * PROBABILITY, INTERVALS)
    assert found["certain"] == 0
    assert found["right"] is None
    assert found["median"] is None
    assert found["made"] == 3
    assert found["stopped"] == 0.5


def test_strategies_are_compared_in_pairs_with_fixation():
    table = pa.concat_tables([answers(), answers("random", ~CORRECT)])
    first, second = summarise(table, INTERVALS)
    assert [one["accuracy"] for one in first["by_touches"]] == [0.5, 0.5, 0.5]
    assert first["by_touches"][0]["lead"] is None
    assert second["by_touches"][2]["lead"] == pytest.approx(0)
    assert second["strategy"] == "random"
    assert second["views"] == [2, 2]
