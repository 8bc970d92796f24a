"""Each family varies one thing, from the run's own parameters."""

import pytest
from studies.surfaces import RUN

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.conditions import with_changes
from visuohaptic.studies.cost.settings import ORDER, make_settings


def family_settings(family, study="cost", run=RUN):
    return [one for one in make_settings(run, study) if one.family == family]


@pytest.mark.parametrize(("study", "count"), [("frontier", 11), ("cost", 47)])
def test_no_setting_has_another_ones_name_and_families_have_an_order(study, count):
    settings = make_settings(ExperimentParameters(), study)
    assert len({(setting.family, setting.name) for setting in settings}) == len(settings) == count
    families = list(dict.fromkeys(setting.family for setting in settings))
    assert families == [name for name in ORDER if name in families]


def test_what_equals_the_run_changes_nothing():
    families = ("imprint", "render", "channels", "features", "effects")
    settings = [one for family in families for one in family_settings(family)]
    own = [one.name for one in settings if not one.changes]
    assert own == ["16 × 16", "48 × 48", "5 channels", "skin and pose", "ideal"]


def test_a_setting_differs_from_the_run_in_what_it_names_and_in_nothing_else():
    setting = family_settings("render")[0]
    changed = with_changes(RUN, setting.condition.changes)
    assert changed.rendering == RUN.rendering.model_copy(update={"resolution": 24})
    assert changed.sensor == RUN.sensor
    assert changed.recognition.best.classifiers == ("support_vector_machine",)
    assert setting.written_changes == '{"rendering.resolution": 24}'


def test_three_channels_are_the_classic_ones_and_lean_views_have_them_too():
    classic = family_settings("channels")[0].changes
    weights = classic["attention.weights"]
    assert {name for name in weights if weights[name]} == {"colour", "intensity", "orientation"}
    lean = family_settings("lean_viewpoints")[1]
    assert lean.changes == {"rendering.resolution": 32, **classic}
    assert lean.viewpoints == 2


@pytest.mark.parametrize("strategy", ["fixation", "random"])
def test_the_frontier_goes_from_one_touch_to_those_of_the_run_from_one_view(strategy):
    run = ExperimentParameters()
    settings = family_settings(strategy, "frontier", run)
    assert [(one.touches, one.viewpoints) for one in settings] == [(1, 1), (2, 1), (5, 1)]
    names = [one.name.removesuffix(", 1 viewpoint") for one in settings]
    assert names == ["1 touch", "2 touches", "5 touches"]
    assert with_changes(run, settings[1].condition.changes).recognition.touches == 2


def test_the_frontier_has_what_the_run_has():
    blind = ExperimentParameters.from_mapping(
        {"probing": {"strategies": ["random"]}, "viewpoints": {"count": 3}, "attention": {"fixations": 2},
         "recognition": {"touches": 2}, "cost": {"frontier_viewpoints": [1, 4]}}
    )  # fmt: skip
    found = [(one.family, one.touches, one.viewpoints) for one in make_settings(blind, "frontier")]
    assert found == [("random", 1, 1), ("random", 2, 1), ("random", 1, 3), ("random", 2, 3)]
