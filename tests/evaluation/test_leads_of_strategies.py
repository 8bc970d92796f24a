"""Leads of fixation and of places in sight, by hand from accuracies of few objects."""

import numpy as np
import pytest

from visuohaptic.evaluation.by_object import ObjectAccuracies
from visuohaptic.evaluation.leads import LEADS, LEADS_OF, DrawnAccuracies, compare_by_lead
from visuohaptic.recognition.parameters import IntervalParameters

OBJECTS = (("box", "a"), ("box", "b"), ("cup", "c"), ("cup", "d"))


def drawn(*draws, objects=OBJECTS, weights=(1.0, 1.0, 2.0, 4.0)):
    return DrawnAccuracies(
        tuple(
            ObjectAccuracies(objects, np.array(one), np.array(weights[: len(one)])) for one in draws
        )
    )


MEASURED = {
    "fixation": drawn((1.0, 0.5, 0.5, 0.75)),
    "random": drawn((0.0, 0.5, 0.5, 0.5), (1.0, 0.5, 0.0, 0.5)),
    "random_visible": drawn((1.0, 1.0, 0.5, 0.0), weights=(2.0, 1.0, 1.0, 4.0)),
}


def test_each_lead_is_the_weighted_mean_difference_of_its_strategies_over_draws():
    found = compare_by_lead(MEASURED, IntervalParameters())
    means = {name: one["difference"]["mean"] for name, one in found.items()}
    assert means == pytest.approx(
        {
            # Weights 1, 1, 2, 4; random has the means 0.5, 0.5, 0.25, 0.5.
            "seeing": (0.5 + 0 + 2 * 0.25 + 4 * 0.25) / 8,
            # Weights 2, 1, 1, 4, of the first strategy.
            "sight": (2 * 0.5 + 0.5 + 0.25 - 4 * 0.5) / 8,
            "salience": (0 - 0.5 + 0 + 4 * 0.75) / 8,
        }
    )
    assert found["seeing"]["draws"]["count"] == 2
    assert found["seeing"]["draws"]["leads"] == pytest.approx(
        [(1 + 1) / 8, (2 * 0.5 + 4 * 0.25) / 8]
    )
    assert found["salience"]["draws"]["count"] == 1
    assert {one["objects"] for one in found.values()} == {4}


@pytest.mark.parametrize("missing", ["fixation", "random", "random_visible"])
def test_a_lead_is_left_out_where_a_strategy_was_not_measured(missing):
    measured = {name: one for name, one in MEASURED.items() if name != missing}
    expected = {name for name, strategies in LEADS.items() if missing not in strategies}
    assert {*compare_by_lead(measured, IntervalParameters())} == expected


def test_a_lead_without_a_common_object_is_left_out():
    other = drawn((1.0,), objects=(("cup", "e"),))
    found = compare_by_lead({**MEASURED, "random": other}, IntervalParameters())
    assert {*found} == {"salience"}


def test_each_lead_answers_one_question_and_salience_keeps_the_eye():
    answered = [name for names in LEADS_OF.values() for name in names]
    assert sorted(answered) == sorted(LEADS)
    assert all("random" not in LEADS[name] for name in LEADS_OF["salience"])
    assert all(LEADS[name][1] == "random" for name in LEADS_OF["seeing"])
