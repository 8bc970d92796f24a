"""The design holds what it says: every combination once, main effects clear of interactions."""

import itertools
from collections import Counter

import numpy as np
import pytest

from variants.choices import BY_NAME, CHOICES
from variants.design import (
    CROSSED_SINGLY,
    FACTORIAL,
    PARTS_ON_OTHERS,
    all_variants,
    is_base_but_for,
    is_default,
)
from variants.study import STUDY as STUDY_OF_VARIANTS
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.conditions import plan_study, with_changes

RUN = ExperimentParameters()


VARIANTS = all_variants()


def test_no_variant_stands_twice():
    assert len({tuple(variant.options.values()) for variant in VARIANTS}) == len(VARIANTS)
    assert len({variant.name for variant in VARIANTS}) == len(VARIANTS)
    assert Counter(variant.part for variant in VARIANTS) == {
        "recognition": 288,
        "upstream": 124,
        "training": 12,
        "protocol": 12,
        "further": 8,
        "literal": 1,
        "single": 64,
        "default": 1,
    }


def test_one_variant_is_that_of_the_packages_own_parameters():
    (default,) = [variant for variant in VARIANTS if is_default(variant.options)]
    assert default.part == "default"
    assert with_changes(RUN, default.values) == RUN


def test_a_run_on_other_objects_has_each_other_choice_by_itself_and_folds_of_whole_objects():
    meshes = RUN.meshes.model_copy(update={"set": "outside"})
    plan = plan_study(STUDY_OF_VARIANTS, RUN.model_copy(update={"meshes": meshes}))
    names = {one.condition.name for one in plan.conditions}
    assert names == {one.name for one in VARIANTS if one.part in PARTS_ON_OTHERS}
    assert len(plan.recomputations) == 18
    protocols = {one.parameters.recognition.protocol.protocol for one in plan.conditions}
    assert protocols == {"grouped_folds"}


@pytest.mark.parametrize("choice", CHOICES, ids=lambda choice: choice.name)
def test_every_option_is_a_change_of_parameters_and_is_run(choice):
    used = {variant.options[choice.name] for variant in VARIANTS}
    if choice.where == "opponent":  # in every variant
        used |= set(choice.options)
    assert used == set(choice.options)
    varied = [with_changes(RUN, changes) for changes in choice.options.values()]
    assert varied[list(choice.options).index(choice.default)] == RUN
    assert len({parameters.model_dump_json() for parameters in varied}) == len(varied)


def coded(name, values):
    """Code options as contrasts that add up to 0 over them."""
    options = list(BY_NAME[name].options)
    places = np.array([options.index(value) for value in values])
    return [1 - 2 * (places // 2), 1 - 2 * (places % 2)] if len(options) == 4 else [1 - 2 * places]


def test_main_effects_of_the_fraction_are_clear_of_each_other_and_of_interactions():
    runs = [
        one.options
        for one in VARIANTS
        if one.options["map_output"] == "unit_distances"
        if one.part == "upstream"
        or (one.part == "recognition" and is_base_but_for(one.options, CROSSED_SINGLY))
    ]
    assert len(runs) == 32
    varied = [name for name in BY_NAME if len({run[name] for run in runs}) > 1]
    assert not set(varied) & set(FACTORIAL)
    columns = np.array([one for name in varied for one in coded(name, [run[name] for run in runs])])
    assert (columns @ columns.T == 32 * np.eye(len(columns))).all()
    places = range(len(columns))
    for main, first, second in itertools.product(places, places, places):
        if len({main, first, second}) == 3:
            assert columns[main] @ (columns[first] * columns[second]) == 0, (main, first, second)
