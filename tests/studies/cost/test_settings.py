"""Each family varies one thing, from the run's own parameters."""

import pytest

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.conditions import with_changes
from visuohaptic.studies.cost.settings import ORDER, frontier_settings


def test_no_setting_has_another_ones_name_and_families_have_an_order():
    settings = frontier_settings(ExperimentParameters())
    assert len({(setting.family, setting.name) for setting in settings}) == len(settings) == 11
    families = list(dict.fromkeys(setting.family for setting in settings))
    assert families == [name for name in ORDER if name in families]


@pytest.mark.parametrize("strategy", ["fixation", "random"])
def test_the_frontier_goes_from_one_touch_to_those_of_the_run_from_one_view(strategy):
    run = ExperimentParameters()
    settings = [one for one in frontier_settings(run) if one.family == strategy]
    assert [(one.touches, one.viewpoints) for one in settings] == [(1, 1), (2, 1), (5, 1)]
    names = [one.name.removesuffix(", 1 viewpoint") for one in settings]
    assert names == ["1 touch", "2 touches", "5 touches"]
    assert with_changes(run, settings[1].condition.changes).recognition.touches == 2


def test_the_frontier_has_what_the_run_has():
    blind = ExperimentParameters.from_mapping(
        {"probing": {"strategies": ["random"]}, "viewpoints": {"count": 3}, "attention": {"fixations": 2},
         "recognition": {"touches": 2}, "cost": {"frontier_viewpoints": [1, 4]}}
    )  # fmt: skip
    found = [(one.family, one.touches, one.viewpoints) for one in frontier_settings(blind)]
    assert found == [("random", 1, 1), ("random", 2, 1), ("random", 1, 3), ("random", 2, 3)]
