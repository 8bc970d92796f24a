"""Draws of the turns become one accuracy per object, pose, pipeline and strategy."""

import numpy as np
import pytest
from studies.surfaces import RUN

from turned.keeping import keep, means_over_draws
from turned.study import DRAWS, STUDY
from visuohaptic.base.errors import ReportError
from visuohaptic.report.turned import POSES, read_turned
from visuohaptic.studies.conditions import plan_study, with_changes
from visuohaptic.studies.figures import Cell, write_json

BOXES = (("box", "a"), ("box", "b"))
SVM = ("paper", "fixation", "support_vector_machine")


def cell(*accuracy, objects=BOXES, **named):
    return Cell(objects, np.array(accuracy), np.arange(1.0, 1 + len(accuracy)), **named)


CELLS = {
    ("any 0", *SVM): cell(1.0, 0.5),
    ("any 1", *SVM): cell(0.0, objects=BOXES[1:]),
    ("none 0", *SVM): cell(1.0, 1.0),
}


def test_each_turned_pose_is_drawn_five_times_and_touched_once_for_all():
    plan = plan_study(STUDY, with_changes(RUN, {"probing.strategies": ["fixation", "random"]}))
    keys = {one.condition.name: one.key for one in plan.conditions}
    assert len(keys) == 1 + 2 * DRAWS == 11
    assert keys.pop("none 0") is None
    assert len(set(keys.values())) == 10
    asked = {
        (one.parameters.meshes.turns, one.parameters.meshes.turn_draw)
        for one in plan.recomputations.values()
    }
    assert asked == {(turns, draw) for turns in POSES if turns != "none" for draw in range(DRAWS)}


def test_an_object_has_the_mean_over_the_draws_that_tested_it():
    found = means_over_draws(CELLS)
    assert found["objects"] == ["box/a", "box/b"]
    turned, upright = found["cells"]
    assert (turned["turns"], turned["draws"], turned["accuracy"]) == ("any", 2, (1.0, 0.25))
    assert turned["weights"] == (1.0, 1.5)
    assert (upright["turns"], upright["draws"], upright["accuracy"]) == ("none", 1, (1.0, 1.0))
    failing = {("any 2", *SVM): cell(objects=(), error="too small."), **CELLS}
    with pytest.raises(ReportError, match="could not be measured, any 2: too small"):
        means_over_draws(failing)


def test_accuracies_are_kept_by_set_beside_those_of_others(tmp_path):
    measured, place = tmp_path / "measured.json", tmp_path / "turned.json"
    for name in ("paper", "benchmark"):
        write_json({"set": name, **means_over_draws(CELLS)}, measured)
        keep(name, measured, place)
    assert set(read_turned(place)) == {"paper", "benchmark"}
    with pytest.raises(ReportError, match="has set benchmark; set paper is needed"):
        keep("paper", measured, place)
