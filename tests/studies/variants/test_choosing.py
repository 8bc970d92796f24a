"""The default is the nearest variant to the former one that is not significantly behind the best."""

from dataclasses import replace

import numpy as np
import pytest

from variants.choosing import (
    ENOUGH,
    FORMER_DEFAULT,
    choose_default,
    choose_options,
    scored_variants,
)
from variants.design import BASE, PARTS_ON_OTHERS, STRATEGIES, all_variants
from visuohaptic.evaluation.published import TABLE_1
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.studies.figures import Cell

VARIANTS = [variant for variant in all_variants() if variant.part == "recognition"]
ON_OTHERS = [variant for variant in all_variants() if variant.part in PARTS_ON_OTHERS]
OBJECTS = tuple(("cup", f"{place:02d}") for place in range(40))
INTERVALS = IntervalParameters(permutations=2000)
ALL_ACQUIRED = dict.fromkeys(scored_variants(), 1.0)


def cells(accuracy, variants=VARIANTS):
    """Return cells in which a variant has the accuracy that `accuracy` gives for its options."""
    around = np.linspace(-0.1, 0.1, len(OBJECTS))
    return {
        (variant.name, "paper", strategy, classifier): Cell(
            OBJECTS, accuracy(variant.options) + around, np.ones(len(OBJECTS))
        )
        for variant in variants
        for strategy in STRATEGIES
        for classifier in TABLE_1
    }


def options_of(accuracy, acquired=ALL_ACQUIRED):
    found = choose_options(cells(accuracy, ON_OTHERS), acquired, INTERVALS)
    return {one["choice"]: one for one in found}


def default_of(accuracy):
    return choose_default(cells(accuracy), INTERVALS, BASE)


def test_a_clear_winner_is_chosen():
    found = default_of(lambda options: 0.5 + 0.2 * (options["map_output"] == "feature_groups"))
    assert found["chosen"]["changed"] == {"map_output": "feature_groups"}
    assert found["chosen"]["score"] == pytest.approx(0.7)
    assert found["former"]["behind"] == pytest.approx(0.2)
    assert found["candidates"] == len(VARIANTS) // 4


def test_a_lead_that_only_scatters_keeps_the_former_default():
    scatter = np.tile([0.1, -0.0999], len(OBJECTS) // 2)
    found = default_of(lambda options: 0.5 + scatter * (options["map_output"] == "one_hot"))
    assert found["best"]["changed"]["map_output"] == "one_hot"
    assert found["chosen"]["changed"] == {}


def test_an_option_that_is_surely_better_becomes_the_default_and_none_that_is_so_by_chance():
    by_chance = np.tile([0.31, -0.2], len(OBJECTS) // 2)
    gains = {"0.5": 0.2, "none": 0.1}
    found = options_of(
        lambda one: 0.5 + gains.get(one["reach"], 0.0) + by_chance * (one["unreachable"] == "keep")
    )
    reach = found.pop("reach")
    assert (reach["former"], reach["chosen"]) == ("0.1", "0.5")
    assert reach["scores"] == pytest.approx({"0.1": 0.5, "0.5": 0.7, "none": 0.6})
    scores = found["unreachable"]["scores"]
    assert scores["keep"] > scores["replace"]
    assert all(one["chosen"] == FORMER_DEFAULT[name] for name, one in found.items())


@pytest.mark.parametrize(
    ("gain", "acquired", "chosen"),
    [
        (0.2, {}, "keep"),
        (0.2, {"keep": ENOUGH - 0.01}, "replace"),
        (0.0, {"replace": ENOUGH - 0.01}, "keep"),
        (0.2, {"keep": 0.5, "replace": 0.5}, "replace"),
    ],
)
def test_an_option_with_too_few_touches_acquired_is_out_however_good(gain, acquired, chosen):
    shares = ALL_ACQUIRED | {("unreachable", name): share for name, share in acquired.items()}
    found = options_of(lambda one: 0.5 + gain * (one["unreachable"] == "keep"), shares)
    assert found["unreachable"]["chosen"] == chosen


def test_no_rule_sees_who_leads_or_touches_out_of_reach():
    # One strategy's accuracy moves by as much as the other's moves back, so scores stay.
    held = cells(lambda options: 0.5 + 0.1 * (options["reach"] == "0.5"), ON_OTHERS)
    shifts = {"fixation": 0.05, "random": -0.05, "random_anywhere": 0.3}
    shifted = {
        key: replace(cell, accuracy=cell.accuracy + shifts.get(key[2], 0.0))
        for key, cell in held.items()
    }
    before, after = (choose_options(one, ALL_ACQUIRED, INTERVALS) for one in (held, shifted))
    assert [one["chosen"] for one in before] == [one["chosen"] for one in after]
    first, second = (choose_default(one, INTERVALS)["chosen"] for one in (held, shifted))
    assert first["variant"] == second["variant"]
