"""Each family varies one thing, from the run's own parameters."""

from studies.surfaces import RUN

from settings_cost.study import settings_of
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.conditions import with_changes


def family_settings(family):
    return [one for one in settings_of(RUN) if one.family == family]


def test_no_setting_has_another_ones_name():
    settings = settings_of(ExperimentParameters())
    assert len({(setting.family, setting.name) for setting in settings}) == len(settings) == 47


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
    assert changed.recognition.order_free.classifiers == ("linear_discriminant",)
    assert setting.written_changes == '{"rendering.resolution": 24}'


def test_three_channels_are_the_classic_ones_and_lean_views_have_them_too():
    classic = family_settings("channels")[0].changes
    weights = classic["attention.weights"]
    assert {name for name in weights if weights[name]} == {"colour", "intensity", "orientation"}
    lean = family_settings("lean_viewpoints")[1]
    assert lean.changes == {"rendering.resolution": 32, **classic}
    assert lean.viewpoints == 2
