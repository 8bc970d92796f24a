"""Each family varies one thing, from the run's own parameters."""

import json

import pytest
from studies.cost.surfaces import RUN

from visuohaptic.errors import ParameterError
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.cost.settings import (
    FAMILIES,
    condition_of,
    family_settings,
    make_settings,
    with_changes,
)


def test_no_setting_has_another_ones_name():
    settings = make_settings(ExperimentParameters())
    assert len({(setting.family, setting.name) for setting in settings}) == len(settings) == 47
    assert {setting.family for setting in settings} == set(FAMILIES)


def test_what_equals_the_run_changes_nothing():
    for family, own in (
        ("imprint", "16 × 16"),
        ("render", "48 × 48"),
        ("channels", "8 channels"),
        ("features", "skin and pose"),
        ("effects", "ideal"),
    ):
        changes = {setting.name: setting.changes for setting in family_settings(family, RUN)}
        assert changes.pop(own) == ()
        assert changes
        assert all(changes.values())


def test_a_setting_differs_from_the_run_in_what_it_names_and_in_nothing_else():
    small = RUN.model_copy(update={"cost": RUN.cost.model_copy(update={"view_resolutions": (64,)})})
    (setting,) = family_settings("render", small)
    changed = setting.parameters(small)
    assert changed.rendering.resolution == 64
    assert changed.rendering.model_copy(update={"resolution": 48}) == small.rendering
    assert changed.sensor == small.sensor
    assert changed.recognition.best.classifiers == ("support_vector_machine",)
    assert json.loads(setting.written_changes) == {"rendering.resolution": 64}


def test_three_channels_are_the_classic_ones():
    three = family_settings("channels", RUN)[0].parameters(RUN).attention.weights.model_dump()
    assert {name for name, weight in three.items() if weight} == {
        "colour", "intensity", "orientation",
    }  # fmt: skip


def test_settings_that_differ_in_recognition_alone_share_their_features():
    assert {condition_of(setting) for setting in family_settings("features", RUN)} == {()}
    assert {condition_of(setting) for setting in family_settings("pipelines", RUN)} == {()}
    assert len({condition_of(setting) for setting in family_settings("effects", RUN)}) == 3


def test_a_change_to_what_is_not_allowed_is_refused():
    with pytest.raises(ParameterError, match=r"sensor\.resolution"):
        with_changes(RUN, (("sensor.resolution", -1),))
