"""Draws of the turns become one accuracy per object, pose, pipeline and strategy."""

import numpy as np
import pytest
from studies.surfaces import RUN

from turned import keeping
from turned.keeping import keep, means_over_draws
from turned.study import DRAWS, STUDY, name_of
from visuohaptic.base.errors import ReportError
from visuohaptic.report.turned import POSES, read_turned
from visuohaptic.studies.conditions import plan_study, with_changes
from visuohaptic.studies.figures import Cell, write_json

BOXES = (("box", "a"), ("box", "b"))
SVM = ("paper", "fixation", "support_vector_machine")


def cell(*accuracy, objects=BOXES, **named):
    return Cell(objects, np.array(accuracy), np.arange(1.0, 1 + len(accuracy)), **named)


CELLS = {
    ("any 0 full 5", *SVM): cell(1.0, 0.5),
    ("any 1 full 5", *SVM): cell(0.0, objects=BOXES[1:]),
    ("any 0 full 20", *SVM): cell(0.25, 0.25),
    ("any 0 none 5", *SVM): cell(0.75, 0.75),
    ("none 0 full 5", *SVM): cell(1.0, 1.0),
}


def test_each_turned_pose_is_drawn_five_times_and_touched_once_for_all_frames_and_lengths():
    plan = plan_study(STUDY, with_changes(RUN, {"probing.strategies": ["fixation", "random"]}))
    keys = {
        one.condition.name: one.key
        for one in plan.conditions
        if "literal" not in one.condition.name
    }
    assert len({keys[name_of("any", 3, known, 20)] for known in ("none", "centre", "full")}) == 1
    assert keys[name_of("any", 3, "none", 1)] == keys[name_of("any", 3, "full", 20)]
    assert len(set(keys.values())) == 1 + 2 * DRAWS == 11
    literal = {one.key for one in plan.conditions if "literal" in one.condition.name}
    assert len(literal) == 11
    asked = {
        (one.parameters.meshes.turns, one.parameters.meshes.turn_draw)
        for one in plan.recomputations.values()
    }
    turned = {(turns, draw) for turns in POSES if turns != "none" for draw in range(DRAWS)}
    assert asked == turned | {("none", 0)}
    touches = {key: one.parameters.attention.fixations for key, one in plan.recomputations.items()}
    assert {touches[key] for key in keys.values()} == {20}
    assert {touches[key] for key in literal} == {RUN.attention.fixations}


def test_no_condition_takes_a_vertical_as_known_that_the_pose_does_not_have():
    conditions = [one for one in STUDY.conditions(RUN) if "literal" not in one.name]
    frames = {(one.changes["meshes.turns"], one.changes["recognition.frame"]) for one in conditions}
    assert ("any", "vertical") not in frames
    assert len(frames) == 3 * 4 - 1
    # The paper's pipeline has one frame.
    by_paper = {one.name for one in conditions if "paper" in one.changes["recognition.pipelines"]}
    assert all(name.endswith(f"full {RUN.attention.fixations}") for name in by_paper)
    assert len(by_paper) == 11


def test_the_literal_variant_is_kept_as_a_pipeline_of_its_own():
    found = means_over_draws({("any 0 literal 5", *SVM): cell(1.0, 0.5)})
    (kept,) = found["cells"]
    assert (kept["pipeline"], kept["known"], kept["turns"]) == ("literal", "full", "any")


def test_an_object_has_the_mean_over_the_draws_that_tested_it():
    found = means_over_draws(CELLS)
    assert found["objects"] == ["box/a", "box/b"]
    turned, longer, unknown, upright = found["cells"]
    assert (turned["turns"], turned["draws"], turned["accuracy"]) == ("any", 2, (1.0, 0.25))
    assert [one["known"] for one in found["cells"]] == ["full", "full", "none", "full"]
    assert [one["touches"] for one in found["cells"]] == [5, 20, 5, 5]
    assert (longer["draws"], unknown["draws"]) == (1, 1)
    assert turned["weights"] == (1.0, 1.5)
    assert (upright["turns"], upright["draws"], upright["accuracy"]) == ("none", 1, (1.0, 1.0))


def test_what_could_not_be_measured_is_left_out_with_its_reason_and_never_kept(tmp_path):
    found = means_over_draws(
        {("any 0 none 20", *SVM): cell(objects=(), error="too small."), **CELLS}
    )
    assert found["failed"] == ["any 0 none 20: too small."]
    assert found["cells"] == means_over_draws(CELLS)["cells"]
    measured = tmp_path / "measured.json"
    write_json({"set": "paper", **found}, measured)
    with pytest.raises(ReportError, match="could not be measured, any 0 none 20: too small"):
        keep("paper", measured, tmp_path / "turned.json")


def test_accuracies_are_kept_by_set_beside_those_of_others(tmp_path, monkeypatch):
    chosen = tmp_path / "chosen.json"
    write_json({"half": ["box/a", "cup/c"]}, chosen)
    monkeypatch.setattr(keeping, "CHOSEN", chosen)
    measured, place = tmp_path / "measured.json", tmp_path / "turned.json"
    for name in ("paper", "benchmark"):
        write_json({"set": name, **means_over_draws(CELLS)}, measured)
        keep(name, measured, place)
    assert set(read_turned(place)) == {"paper", "benchmark"}
    assert read_turned(place)["paper"].reports.tolist() == [False, True]
    with pytest.raises(ReportError, match="has set benchmark; set paper is needed"):
        keep("paper", measured, place)
