"""Study `cues` measures what its page asks, and its table has one row per object."""

import numpy as np
import pandas as pd
import pytest
from recognition.synthetic import features_table

from cues.accuracies import accuracies_of, make_cues
from cues.kept import kept_cues
from cues.study import CUES, KNOWN_OF_TOUCH, STUDY, TOUCHES, WAYS
from cues.tables import ACCURACIES
from visuohaptic.base.errors import ReportError
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.descriptors import describe_all
from visuohaptic.recognition.sequences import gather_pipeline
from visuohaptic.studies.conditions import plan_study, with_changes
from visuohaptic.studies.figures import Cell
from visuohaptic.studies.keeping import keep
from visuohaptic.studies.study import StepInputs

OBJECTS = (("box", "a"), ("box", "b"))
RUN = ExperimentParameters()
THREE = with_changes(RUN, {"probing.strategies": ["fixation", "random", "random_visible"]})
PLAN = plan_study(STUDY, THREE)


def cell(*accuracy, objects=OBJECTS, **named):
    return Cell(objects, np.array(accuracy), np.arange(1.0, len(accuracy) + 1), **named)


def test_upright_objects_need_no_touch_again_and_turned_ones_are_touched_once():
    for planned in PLAN.conditions:
        assert (planned.key is None) == (planned.condition.name.split()[1] == "none")
    assert len(PLAN.recomputations) == 2


def test_every_way_has_all_cues_unless_nothing_is_known_of_a_single_touch():
    names = {planned.condition.name for planned in PLAN.conditions}
    assert len(names) == len(PLAN.conditions)
    for way in WAYS:
        for touches in TOUCHES:
            start, end = f"{way.tested} {way.turns} {way.frame} ", f" {touches}"
            cues = {
                name.removeprefix(start).removesuffix(end)
                for name in names
                if name.startswith(start) and name.endswith(end)
            }
            is_bare = way.frame == "none" and touches == 1
            assert cues == ({"imprint", "all"} if is_bare else set(CUES))


def test_a_condition_has_the_parameters_of_its_name():
    for planned in PLAN.conditions:
        tested, turns, frame, _, touches = planned.condition.name.split()
        found, recognition = planned.parameters, planned.parameters.recognition
        assert (found.meshes.turns, found.meshes.turn_draw) == (turns, 0)
        assert (recognition.frame, recognition.touches) == (frame, int(touches))
        assert recognition.protocol.protocol == {"new": "auto", "known": "new_viewpoint"}[tested]


POINT, NORMAL = ["x", "y", "z"], ["normal_x", "normal_y", "normal_z"]
READ_BY = {
    "position": {"point"}, "normal": {"normal"}, "pose": {"point", "normal"},
    "imprint": {"skin"}, "all": {"point", "normal", "skin"},
}  # fmt: skip


@pytest.mark.parametrize("pipeline", ["paper", "order_free"])
@pytest.mark.parametrize("cues", CUES)
def test_a_cue_reads_exactly_its_columns(pipeline, cues):
    table = features_table(objects=(2, 2))
    parameters = with_changes(RUN, KNOWN_OF_TOUCH[cues]).recognition

    def rows(part=None):
        changed = table.to_pandas()
        for name in {"point": POINT, "normal": NORMAL, "skin": ["contourlet_03"]}.get(part, ()):
            changed[name] = changed[name].to_numpy()[::-1]
        made = type(table).from_pandas(changed, schema=table.schema)
        sequences = gather_pipeline(made, parameters, pipeline)
        return sequences.features if pipeline == "paper" else describe_all(sequences, parameters, 1)

    read = {part for part in ("point", "normal", "skin") if not np.array_equal(rows(part), rows())}
    assert read == READ_BY[cues]


CELLS = {
    ("new any none pose 5", "order_free", "random", "svm"): cell(1.0, 0.5),
    ("new any none pose 1", "order_free", "random", "svm"): cell(0.5, objects=OBJECTS[1:]),
    ("known none full all 5", "paper", "fixation", "svm"): cell(0.25, 0.75),
}


def test_each_object_has_a_row_with_the_words_of_its_condition():
    found = accuracies_of(CELLS).to_pandas()
    assert found.to_dict("split")["data"] == [
        ["new", "any", "none", 5, "pose", "order_free", "random", "svm", "box", "a", 1.0, 1.0],
        ["new", "any", "none", 5, "pose", "order_free", "random", "svm", "box", "b", 0.5, 2.0],
        ["new", "any", "none", 1, "pose", "order_free", "random", "svm", "box", "b", 0.5, 1.0],
        ["known", "none", "full", 5, "all", "paper", "fixation", "svm", "box", "a", 0.25, 1.0],
        ["known", "none", "full", 5, "all", "paper", "fixation", "svm", "box", "b", 0.75, 2.0],
    ]


def test_a_condition_that_failed_is_named():
    failed = {("new any none all 5", "paper", "random", "svm"): cell(objects=(), error="No.")}
    with pytest.raises(ReportError, match="be measured, new any none all 5: No"):
        accuracies_of(CELLS | failed)


def test_what_is_kept_is_what_was_measured(tmp_path, monkeypatch):
    monkeypatch.setattr("cues.accuracies.read_cells", lambda blocks: CELLS)
    make_cues(StepInputs("cues", {"blocks": []}, [tmp_path / "measured.parquet"], RUN))
    keep(tmp_path / "measured.parquet", RUN.meshes.set, tmp_path)
    kept = kept_cues(tmp_path)[RUN.meshes.set]
    first, second = (
        one.to_pandas().sort_values(list(ACCURACIES.keys)).reset_index(drop=True)
        for one in (kept.table, accuracies_of(CELLS))
    )
    pd.testing.assert_frame_equal(first, second)
