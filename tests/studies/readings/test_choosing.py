"""The default is the nearest reading to the former one that is not significantly behind the best."""

import json
from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest

from readings.choices import CHOICES
from readings.choosing import (
    ENOUGH,
    FORMER_DEFAULT,
    choose_default,
    choose_options,
    readings_of_option,
    scored_choices,
)
from readings.design import (
    PARTS_ON_OTHERS,
    STRATEGIES,
    all_readings,
    is_default,
)
from readings.stored import OUTSIDE, kept_readings
from visuohaptic.errors import RecognitionError
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.recognition.published import TABLE_1
from visuohaptic.studies.figures import Cell

READINGS = [reading for reading in all_readings() if reading.part == "recognition"]
OBJECTS = tuple(("cup", f"{place:02d}") for place in range(40))
BASE = {choice.name: choice.base for choice in CHOICES}
INTERVALS = IntervalParameters(bootstrap_samples=200, permutations=2000)


def cells(accuracy, failed=(), readings=READINGS):
    """Give cells in which a reading has the accuracy that `accuracy` gives for its options."""
    found = {}
    for reading in readings:
        for strategy in STRATEGIES:
            for classifier in TABLE_1:
                key = (reading.name, "paper", strategy, classifier)
                values = accuracy(reading.options) + np.linspace(-0.1, 0.1, len(OBJECTS))
                cell = Cell(OBJECTS, values, np.ones(len(OBJECTS)))
                if reading.name in failed:
                    cell = Cell((), np.empty(0), np.empty(0), None, "no such map")
                found[key] = cell
    return found


def test_a_clear_winner_is_chosen():
    chosen = choose_default(
        cells(lambda options: 0.5 + 0.2 * (options["map_output"] == "feature_groups")),
        INTERVALS,
        1,
        BASE,
    )
    assert chosen.chosen.changed == {"map_output": "feature_groups"}
    assert chosen.chosen.score == pytest.approx(0.7)
    assert chosen.former.behind == pytest.approx(0.2)
    assert chosen.candidates == len(READINGS) // 4


def test_a_lead_that_only_scatters_keeps_the_former_default():
    scatter = np.tile([0.1, -0.0999], len(OBJECTS) // 2)
    chosen = choose_default(
        cells(lambda options: 0.5 + scatter * (options["map_output"] == "one_hot")),
        INTERVALS,
        1,
        BASE,
    )
    assert chosen.best.changed["map_output"] == "one_hot"
    assert chosen.chosen.changed == {}


def test_a_missing_reading_is_refused():
    held = cells(lambda options: 0.5)
    held.pop((READINGS[3].name, "paper", "random", "naive_bayes"))
    with pytest.raises(RecognitionError, match="r003 has no result for random naive_bayes"):
        choose_default(held, INTERVALS, 1)


def test_the_package_has_the_default_that_the_rules_chose():
    kept = json.loads(files("readings").joinpath("chosen.json").read_text())
    (chosen,) = [one for one in READINGS if one.name == kept["chosen"]["reading"]]
    of_touches = {one["choice"]: one["chosen"] for one in kept["options"]}
    assert is_default({**chosen.options, **of_touches})
    changed = {
        name: option for name, option in chosen.options.items() if option != FORMER_DEFAULT[name]
    }
    assert changed == kept["chosen"]["changed"]


def test_the_kept_readings_give_the_scores_that_the_rule_saw():
    kept = json.loads(files("readings").joinpath("chosen.json").read_text())
    rows = kept_readings(OUTSIDE).rows
    for name in ("chosen", "best", "former"):
        own = [row for row in rows if row["reading"] == kept[name]["reading"]]
        random = [row["random"] for row in own if row["random_probing"] != "anywhere"]
        fixation = [row["fixation"] for row in own if row["random_probing"] == "reachable"]
        assert (len(fixation), len(random)) == (5, 15)
        assert np.mean(fixation + random) == pytest.approx(kept[name]["score"], abs=1e-3)


ON_OTHERS = [reading for reading in all_readings() if reading.part in PARTS_ON_OTHERS]
ALL_ACQUIRED = {
    (choice.name, option): 1.0 for choice in scored_choices() for option in choice.options
}


def options_of(accuracy, acquired=ALL_ACQUIRED):
    found = choose_options(cells(accuracy, readings=ON_OTHERS), acquired, INTERVALS, 1)
    return {one.choice: one for one in found}


def test_an_option_that_is_surely_better_becomes_the_default():
    gains = {"0.5": 0.2, "none": 0.1}
    found = options_of(lambda options: 0.5 + gains.get(options["reach"], 0.0))
    assert (found["reach"].former, found["reach"].chosen) == ("0.1", "0.5")
    assert found["reach"].scores == pytest.approx({"0.1": 0.5, "0.5": 0.7, "none": 0.6})
    assert {name: one.chosen for name, one in found.items() if name != "reach"} == {
        name: FORMER_DEFAULT[name] for name in found if name != "reach"
    }


def test_an_option_that_is_better_by_chance_does_not():
    scatter = np.tile([0.11, -0.1], len(OBJECTS) // 2)
    found = options_of(lambda options: 0.5 + scatter * (options["reach"] == "0.5"))
    assert found["reach"].scores["0.5"] > found["reach"].scores["0.1"]
    assert found["reach"].chosen == "0.1"


def test_an_option_with_too_few_touches_acquired_is_out_however_good():
    def better_kept(options):
        return 0.5 + 0.2 * (options["unreachable"] == "keep")

    assert options_of(better_kept)["unreachable"].chosen == "keep"
    few = ALL_ACQUIRED | {("unreachable", "keep"): ENOUGH - 0.01}
    assert options_of(better_kept, few)["unreachable"].chosen == "replace"
    lost = few | {("unreachable", "keep"): 1.0, ("unreachable", "replace"): ENOUGH - 0.01}
    assert options_of(lambda _: 0.5, lost)["unreachable"].chosen == "keep"
    none = ALL_ACQUIRED | {("unreachable", option): 0.5 for option in ("replace", "keep")}
    assert options_of(better_kept, none)["unreachable"].chosen == "replace"


def test_no_rule_sees_who_leads_or_touches_out_of_reach():
    """Each strategy's accuracy moved by as much as another's moves back changes no score."""
    held = cells(lambda options: 0.5 + 0.1 * (options["reach"] == "0.5"), readings=ON_OTHERS)
    moved = {"fixation": 0.05, "random": -0.05, "random_anywhere": 0.3}
    shifted = {
        key: replace(cell, accuracy=cell.accuracy + moved.get(key[2], 0.0))
        for key, cell in held.items()
    }
    for rule in (
        lambda found: choose_options(found, ALL_ACQUIRED, INTERVALS, 1),
        lambda found: [choose_default(found, INTERVALS, 1)],
    ):
        before, after = rule(held), rule(shifted)
        for one, other in zip(before, after, strict=True):
            assert getattr(one.chosen, "reading", one.chosen) == getattr(
                other.chosen, "reading", other.chosen
            )


def test_every_option_that_is_scored_has_readings_on_other_objects():
    measured = {one.name for one in ON_OTHERS}
    for choice in scored_choices():
        for option in choice.options:
            names = readings_of_option(choice.name, option)
            assert len(names) == 4
            assert set(names) <= measured
