"""Draws of the turns become one accuracy per object, pose, pipeline and strategy."""

import numpy as np
import pytest
from studies.surfaces import RUN

from turned import accuracies
from turned.accuracies import make_turned, means_over_draws
from turned.kept import read_turned
from turned.study import DRAWS, POSES, STUDY, name_of
from visuohaptic.base.errors import ReportError
from visuohaptic.studies.conditions import plan_study, with_changes
from visuohaptic.studies.figures import Cell, CellKey
from visuohaptic.studies.keeping import keep
from visuohaptic.studies.study import StepInputs

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


def rows_of(cells, choosing=()):
    """Return the rows of the measured table in the order of the cells."""
    return means_over_draws(cells, frozenset(choosing)).to_pylist()


def test_the_literal_variant_is_kept_as_a_pipeline_of_its_own():
    rows = rows_of({("any 0 literal 5", *SVM): cell(1.0, 0.5)})
    named = {(row["pipeline"], row["known"], row["turns"]) for row in rows}
    assert named == {("literal", "full", "any")}


def test_an_object_has_the_mean_over_the_draws_that_tested_it():
    by_cell = {}
    for row in rows_of(CELLS):
        key = row["turns"], row["known"], row["touches"]
        by_cell.setdefault(key, {})[row["object"]] = (
            row["draws"],
            row["accuracy"],
            row["weight"],
        )
    assert by_cell == {
        ("any", "full", 5): {"a": (2, 1.0, 1.0), "b": (2, 0.25, 1.5)},
        ("any", "full", 20): {"a": (1, 0.25, 1.0), "b": (1, 0.25, 2.0)},
        ("any", "none", 5): {"a": (1, 0.75, 1.0), "b": (1, 0.75, 2.0)},
        ("none", "full", 5): {"a": (1, 1.0, 1.0), "b": (1, 1.0, 2.0)},
    }


def test_a_condition_that_failed_is_left_out_and_the_table_is_not_kept(tmp_path, monkeypatch):
    failed = {CellKey("any 0 none 20", *SVM): cell(objects=(), error="too small.")}
    cells = {CellKey(*key): one for key, one in CELLS.items()} | failed
    assert rows_of(cells) == rows_of(CELLS)
    monkeypatch.setattr(accuracies, "read_cells", lambda _: cells)
    measured = tmp_path / "turned.parquet"
    make_turned(StepInputs("turned", {"blocks": ()}, (str(measured),), RUN))
    with pytest.raises(ReportError, match="could not be measured, any 0 none 20: too small"):
        keep(measured, RUN.meshes.set, tmp_path)


def test_objects_that_took_part_in_choosing_are_not_held_out(tmp_path, monkeypatch):
    monkeypatch.setattr("turned.accuracies.read_cells", lambda blocks: CELLS)
    monkeypatch.setattr("turned.accuracies.choosing_objects", lambda: frozenset({"box/a", "cup/c"}))
    make_turned(StepInputs("turned", {"blocks": []}, [tmp_path / "measured.parquet"], RUN))
    keep(tmp_path / "measured.parquet", RUN.meshes.set, tmp_path)
    kept = read_turned(tmp_path)[RUN.meshes.set]
    assert kept.objects == BOXES
    assert kept.held_out.tolist() == [False, True]
