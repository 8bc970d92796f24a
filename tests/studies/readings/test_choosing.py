"""The default is the nearest reading to the former one that is not significantly behind the best."""

import json
from importlib.resources import files

import numpy as np
import pytest

from visuohaptic.errors import RecognitionError
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.recognition.published import TABLE_1
from visuohaptic.studies.figures import Cell
from visuohaptic.studies.readings.choosing import FORMER_DEFAULT, choose_default
from visuohaptic.studies.readings.design import STRATEGIES, all_readings, is_default
from visuohaptic.studies.readings.stored import OUTSIDE, kept_readings

READINGS = [reading for reading in all_readings() if reading.part == "recognition"]
OBJECTS = tuple(("cup", f"{place:02d}") for place in range(40))
INTERVALS = IntervalParameters(bootstrap_samples=200, permutations=2000)


def cells(accuracy, failed=()):
    """Give cells in which a reading has the accuracy that `accuracy` gives for its options."""
    found = {}
    for reading in READINGS:
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
        cells(lambda options: 0.5 + 0.2 * (options["map_output"] == "feature_groups")), INTERVALS, 1
    )
    assert chosen.chosen.changed == {"map_output": "feature_groups"}
    assert chosen.chosen.score == pytest.approx(0.7)
    assert chosen.former.behind == pytest.approx(0.2)
    assert chosen.candidates == len(READINGS) // 4


def test_equal_readings_keep_the_former_default():
    chosen = choose_default(cells(lambda options: 0.5), INTERVALS, 1)
    assert chosen.chosen == chosen.former
    assert chosen.candidates == chosen.readings == len(READINGS)


def test_a_lead_that_only_scatters_keeps_the_former_default():
    scatter = np.tile([0.1, -0.0999], len(OBJECTS) // 2)
    chosen = choose_default(
        cells(lambda options: 0.5 + scatter * (options["map_output"] == "one_hot")), INTERVALS, 1
    )
    assert chosen.best.changed["map_output"] == "one_hot"
    assert chosen.chosen.changed == {}


def test_of_readings_equally_near_the_better_is_chosen():
    gains = {"feature_groups": 0.3, "lattice": 0.2999}
    chosen = choose_default(
        cells(lambda options: 0.5 + gains.get(options["map_output"], 0.0)), INTERVALS, 1
    )
    assert chosen.chosen.changed == {"map_output": "feature_groups"}


def test_a_reading_with_a_cell_that_could_not_be_run_has_no_score():
    best = next(one.name for one in READINGS if one.options["map_output"] == "lattice")
    chosen = choose_default(cells(lambda options: 0.5, failed={best}), INTERVALS, 1)
    assert chosen.readings == len(READINGS) - 1


def test_a_missing_reading_is_refused():
    held = cells(lambda options: 0.5)
    held.pop((READINGS[3].name, "paper", "random", "naive_bayes"))
    with pytest.raises(RecognitionError, match="r003 has no result for random naive_bayes"):
        choose_default(held, INTERVALS, 1)


def test_the_package_has_the_default_that_the_rule_chose():
    kept = json.loads(files("visuohaptic.studies.readings").joinpath("chosen.json").read_text())
    (chosen,) = [one for one in READINGS if one.name == kept["chosen"]["reading"]]
    assert is_default(chosen.options)
    changed = {
        name: option for name, option in chosen.options.items() if option != FORMER_DEFAULT[name]
    }
    assert changed == kept["chosen"]["changed"]


def test_the_kept_readings_give_the_scores_that_the_rule_saw():
    kept = json.loads(files("visuohaptic.studies.readings").joinpath("chosen.json").read_text())
    rows = kept_readings(OUTSIDE).rows
    for name in ("chosen", "best", "former"):
        own = [row for row in rows if row["reading"] == kept[name]["reading"]]
        figures = [row[strategy] for row in own for strategy in STRATEGIES]
        assert len(figures) == 10
        assert np.mean(figures) == pytest.approx(kept[name]["score"], abs=1e-3)


def test_the_former_default_is_a_reading():
    assert any(reading.options == FORMER_DEFAULT for reading in READINGS)
