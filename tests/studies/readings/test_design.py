"""The design holds what it says: every combination once, main effects clear of interactions."""

import itertools
from collections import Counter

import numpy as np
import pytest

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.conditions import AS_RUN, plan_study, with_changes
from visuohaptic.studies.readings.choices import BY_NAME, CHOICES
from visuohaptic.studies.readings.design import (
    CROSSED,
    FACTORIAL,
    all_readings,
    make_readings_study,
)
from visuohaptic.tables.studies import READING_CHOICES

RUN = ExperimentParameters()
READINGS = all_readings()


def test_no_reading_stands_twice():
    assert len({tuple(reading.options.values()) for reading in READINGS}) == len(READINGS)
    assert len({reading.name for reading in READINGS}) == len(READINGS)
    assert Counter(reading.part for reading in READINGS) == {
        "recognition": 288,
        "upstream": 372,
        "training": 12,
        "protocol": 12,
    }


def test_the_first_reading_is_our_default():
    assert READINGS[0].changes == {}
    assert READINGS[0].options == {choice.name: choice.default for choice in CHOICES}


def test_the_table_has_a_column_for_each_choice():
    assert tuple(BY_NAME) == READING_CHOICES


@pytest.mark.parametrize("choice", CHOICES, ids=lambda choice: choice.name)
def test_every_option_is_a_change_of_parameters_and_is_run(choice):
    used = {reading.options[choice.name] for reading in READINGS}
    assert used == set(choice.options)
    varied = [with_changes(RUN, changes) for changes in choice.options.values()]
    assert varied[0] == RUN
    assert len({parameters.model_dump_json() for parameters in varied}) == len(varied)


def coded(name, values):
    """Code options as contrasts that add up to 0 over them."""
    options = list(BY_NAME[name].options)
    places = np.array([options.index(value) for value in values])
    if len(options) == 4:
        high, low = places // 2, places % 2
        return [1 - 2 * high, 1 - 2 * low]
    return [1 - 2 * places]


def test_main_effects_of_the_fraction_are_clear_of_each_other_and_of_interactions():
    runs = [
        reading.options
        for reading in READINGS
        if reading.part in {"upstream", "recognition"}
        and reading.options["map_output"] == "unit_distances"
        and reading.options["classifier_settings"] == "scikit_learn"
        and (
            reading.part == "upstream"
            or all(
                reading.options[choice.name] == choice.default
                for choice in CHOICES
                if choice.name not in CROSSED
            )
        )
    ]
    assert len(runs) == 32
    varied = [name for name in BY_NAME if len({run[name] for run in runs}) > 1]
    assert not set(varied) & set(FACTORIAL)
    columns = {
        f"{name}{place}": column
        for name in varied
        for place, column in enumerate(coded(name, [run[name] for run in runs]))
    }
    for first, second in itertools.combinations(columns, 2):
        assert columns[first] @ columns[second] == 0
    for main, column in columns.items():
        for first, second in itertools.combinations(set(columns) - {main}, 2):
            assert column @ (columns[first] * columns[second]) == 0, (main, first, second)


def test_touches_are_shared_by_all_readings_of_the_recognition():
    plan = plan_study(make_readings_study(RUN), RUN)
    assert len(plan.remakes) == 31
    keys = {one.condition.name: one.key for one in plan.conditions}
    assert {keys[reading.name] for reading in READINGS if reading.part != "upstream"} == {None}
    assert AS_RUN not in keys


def test_a_run_with_another_reading_has_the_same_readings():
    other = with_changes(RUN, {"viewpoints.elevations_degrees": (45.0,), "seed": 7})
    plan = plan_study(make_readings_study(other), other)
    usual = plan_study(make_readings_study(RUN), RUN)
    for one, same in zip(plan.conditions, usual.conditions, strict=True):
        assert one.parameters == same.parameters.model_copy(update={"seed": 7})
    changes = [one.condition.changes for one in usual.conditions]
    assert "viewpoints.elevations_degrees" not in changes[0]


def test_every_choice_of_the_paper_quotes_it_or_says_that_it_is_silent():
    quoting = [choice for choice in CHOICES if choice.sentence]
    assert {choice.name for choice in CHOICES} - {choice.name for choice in quoting} == {
        "touch_scaling"
    }
    assert all("(section 3" in choice.sentence for choice in quoting)
