"""Each family varies one thing, from the run's own parameters."""

import json

from studies.surfaces import RUN

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.conditions import plan_study, with_changes
from visuohaptic.studies.cost.settings import FAMILIES, cost_study, family_settings, make_settings


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
        assert changes.pop(own) == {}
        assert changes
        assert all(changes.values())


def test_a_setting_differs_from_the_run_in_what_it_names_and_in_nothing_else():
    small = RUN.model_copy(update={"cost": RUN.cost.model_copy(update={"view_resolutions": (64,)})})
    (setting,) = family_settings("render", small)
    changed = with_changes(small, setting.condition.changes)
    assert changed.rendering.resolution == 64
    assert changed.rendering.model_copy(update={"resolution": 48}) == small.rendering
    assert changed.sensor == small.sensor
    assert changed.recognition.best.classifiers == ("support_vector_machine",)
    assert json.loads(setting.written_changes) == {"rendering.resolution": 64}


def test_three_channels_are_the_classic_ones():
    setting = family_settings("channels", RUN)[0]
    three = with_changes(RUN, setting.condition.changes).attention.weights.model_dump()
    assert {name for name, weight in three.items() if weight} == {
        "colour", "intensity", "orientation",
    }  # fmt: skip


def test_what_settings_share_is_made_once():
    plan = plan_study(cost_study(RUN), RUN)
    keys = {}
    for setting, one in zip(make_settings(RUN), plan.conditions, strict=True):
        keys.setdefault(setting.family, set()).add(one.key)
    assert keys["features"] == keys["pipelines"] == keys["viewpoints"] == {None}
    assert len(keys["lean_viewpoints"]) == 1
    assert len(keys["effects"]) == 3
    # One and two touches are the run's own, three need more.
    assert len(keys["touches"]) == 2
