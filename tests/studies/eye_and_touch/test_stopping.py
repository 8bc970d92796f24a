"""The rule goes on exactly while a second of touching is expected to bring more than it must."""

import numpy as np
import pytest

from eye_and_touch.trials import (
    expected_gain,
    learn_pace,
    touches_made,
    worth_of_budget,
)

# After 0, 1 and 2 touches: four rehearsals, of which 1, 2 and 4 are right.
CORRECT = np.array([[1, 0, 0, 0], [1, 1, 0, 0], [1, 1, 1, 1]], dtype=bool)
CONFIDENCE = np.array([[0.5, 0.5, 0.5, 0.5], [0.75, 0.75, 0.75, 0.75], [0.9, 0.9, 0.9, 0.9]])


def test_pace_is_the_share_of_doubt_that_the_best_number_of_touches_removes_a_second():
    # Doubt is 2 at first: one touch of 5 s gains 1, two gain 3; then doubt is 1 and a touch gains 2.
    assert learn_pace(CORRECT, CONFIDENCE, 5.0) == pytest.approx([1 / 10, 1 / 5, 0.0])


def touches(pace, confidence, worth):
    return touches_made(worth, expected_gain(np.array(pace), np.array(confidence)))


def test_the_rule_stops_at_the_first_touch_that_is_not_worth_it():
    confidence = [[0.9, 0.5, 0.5], [0.9, 0.9, 0.5], [0.9, 0.9, 0.6]]
    assert touches([0.1, 0.1, 0.0], confidence, 0.03).tolist() == [0, 1, 2]


@pytest.mark.parametrize("most", [0.0, 0.4, 1.0, 1.9, 10.0])
def test_rehearsals_keep_within_the_budget_and_would_not_with_the_next_lower_worth(most):
    confidence = np.sort(np.random.default_rng(4).uniform(0.2, 1, size=(4, 50)), axis=0)
    gain = expected_gain(np.array([0.1, 0.08, 0.05, 0.0]), confidence)
    worth = worth_of_budget(gain, most)
    assert touches_made(worth, gain).mean() <= most
    lower = gain[gain < worth]
    if lower.size:
        assert touches_made(lower.max(), gain).mean() > most
