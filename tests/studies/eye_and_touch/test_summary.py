"""The summary says what the table holds."""

from itertools import product

import numpy as np
import pytest

from eye_and_touch.seeing import SIGHTS
from eye_and_touch.sensing import ADAPTIVE, BLIND, STRATEGIES
from eye_and_touch.study import (
    CHECKED,
    CLEAN,
    CUES,
    LOOK,
    PRODUCT,
    SIDE_BY_SIDE,
    STOPPING,
    TOUCH,
)
from eye_and_touch.summary import cells_of, sum_up_senses
from eye_and_touch.tables import EYE_AND_TOUCH
from visuohaptic.evaluation.intervals import compare_differences
from visuohaptic.parameters import CostParameters
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.tables.schema import build_rows, names_of

COST = CostParameters(budgets=(5, 12), touch_seconds=5, look_seconds=0.5)
INTERVALS = IntervalParameters()
TOUCHES = 2
CLASSES = ("cup", "lamp")


def rows_of(key, accuracy, seconds):
    """Return two objects of each of two splits, with a class per split; a trial of each is surely right or wrong."""
    for split, share in enumerate(accuracy):
        gaps = [0.0] * 9 + [4 * (share - 1)]
        for number in range(2):
            yield (*key, CLASSES[split], f"{split}{number}", split, 0, 4, share, seconds, gaps)


def table_of(accuracy_of):
    """Return a table whose accuracy is a function of sight, answer, strategy and touches."""
    touches, strategies = range(1, TOUCHES + 1), (*STRATEGIES, ADAPTIVE)
    keys = [
        *((sight, cue, "none", 0, None, 0.5) for sight in SIGHTS for cue in CUES),
        *(
            (CLEAN, TOUCH, strategy, count, None, 0.5 * (strategy != BLIND) + 5 * count)
            for strategy, count in product(strategies, touches)
        ),
        *(
            (*key, None, 0.5 + 5 * key[-1])
            for key in product(SIGHTS, (PRODUCT, CHECKED), strategies, touches)
        ),
        *(
            (sight, STOPPING, strategy, TOUCHES, budget, budget - 1)
            for sight, strategy, budget in product(SIGHTS, strategies, COST.budgets)
        ),
        *((sight, SIDE_BY_SIDE, STRATEGIES[0], TOUCHES, None, 10.5) for sight in SIGHTS),
    ]
    rows = [row for *key, seconds in keys for row in rows_of(key, accuracy_of(*key[:4]), seconds)]
    names = names_of(EYE_AND_TOUCH.columns)
    return build_rows(EYE_AND_TOUCH, [dict(zip(names, row, strict=True)) for row in rows])


def poor_sight(sight, answer, _strategy, touches):
    """The eye is right in clean sight alone; touch gains a quarter a touch; both are what is better."""
    seen = 0.5 if sight == CLEAN else 0.25
    felt = 0.25 * (1 + touches)
    if answer in CUES:
        return seen, seen
    return (felt, felt) if answer == TOUCH else (max(seen, felt),) * 2


@pytest.fixture(scope="module")
def found():
    return sum_up_senses(table_of(poor_sight), COST, TOUCHES, INTERVALS)


def test_accuracy_is_the_mean_over_objects_and_calibration_the_gap_of_the_tenths():
    cell = cells_of(table_of(lambda *_: (1.0, 0.5)))[CLEAN, LOOK, "none", 0, None]
    assert cell.mean == 0.75
    assert cell.calibration_error == pytest.approx(0.25)


def test_both_senses_are_compared_with_the_better_of_their_parts(found):
    for one in found["sights"]:
        assert one["gains"][PRODUCT]["over"] == TOUCH
        assert one["gains"][PRODUCT]["difference"] == 0
        lead = 0.25 if one["sight"] == CLEAN else 0.5
        assert one["gains"][TOUCH]["difference"] == pytest.approx(lead)
        assert one["gains"][TOUCH]["over"] == LOOK


def test_a_gain_has_the_intervals_of_new_objects_and_of_new_classes():
    def answered(_sight, answer, _strategy, _touches):
        return (1.0, 0.5) if answer == TOUCH else (0.5, 0.5)

    found = sum_up_senses(table_of(answered), COST, TOUCHES, INTERVALS)
    gain = found["sights"][0]["gains"][TOUCH]
    differences = np.array([0.5, 0.5, 0.0, 0.0])
    same = compare_differences(differences, np.ones(4), INTERVALS, classes=[0, 0, 1, 1])
    objects, classes = same.difference, same.difference_new_classes
    assert classes.high - classes.low >= objects.high - objects.low
    assert gain["difference"] == 0.25
    assert [gain["difference_low"], gain["difference_high"]] == [objects.low, objects.high]
    wide = [gain["difference_new_classes_low"], gain["difference_new_classes_high"]]
    assert wide == [classes.low, classes.high]


def test_a_budget_buys_as_many_touches_as_fit_and_blind_ones_pay_no_look(found):
    names = ("budget", "strategy", "answer")
    touches = {tuple(row[name] for name in names): row["touches"] for row in found["budgets"]}
    assert touches[5, BLIND, TOUCH] == 1
    assert not {(5, STRATEGIES[0], CHECKED), (5, STRATEGIES[0], TOUCH)} & set(touches)
    assert touches[12, STRATEGIES[0], TOUCH] == touches[12, BLIND, TOUCH] == 2


def test_the_rule_is_compared_with_numbers_of_touches_that_take_as_long(found):
    rows = [row for row in found["budgets"] if row["answer"] == STOPPING]
    gains = {row["budget"]: row["gain"]["difference"] for row in rows}
    # The rule is right in 3 of 4 in 4 and 11 s. A look reaches a half in 0.5 s, one touch no more,
    # and two touches 3 of 4 in 10.5 s.
    assert gains[5] == pytest.approx(0.25)
    assert gains[12] == pytest.approx(0.0)


def test_the_worth_of_touching_is_its_best_rise_a_second(found):
    worth = {row["sight"]: (row["touches"], row["accuracy_a_second"]) for row in found["worth"]}
    assert worth[CLEAN] == (TOUCHES, pytest.approx(0.25 / 10))
    assert worth["dark"] == (1, pytest.approx(0.25 / 5))
