"""From meshes to the study's table and figures, and what is looked at and touched on the way."""

import json

import numpy as np
import pytest
from studies.surfaces import RUN as SMALL
from studies.surfaces import small_surfaces, write_meshes

from eye_and_touch.seeing import SIGHTS
from eye_and_touch.sensing import (
    ADAPTIVE,
    STRATEGIES,
    most_touches,
    sense_all,
    sense_object,
)
from eye_and_touch.study import CUES
from eye_and_touch.tables import EYE_AND_TOUCH
from eye_and_touch.trials import make_eye_and_touch
from touch_curves.adaptive import make_candidates
from visuohaptic.base.errors import ParameterError
from visuohaptic.studies.conditions import with_changes
from visuohaptic.studies.study import StepInputs
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table

FEW = {"protocol": "leave_one_object_a_class_out", "maximum_splits": 3}
FAST = with_changes(SMALL, {f"recognition.protocol.{name}": few for name, few in FEW.items()})


def with_costs(**values):
    costs = {"budgets": (6.0, 16.0), **values}
    return FAST.model_copy(update={"cost": FAST.cost.model_copy(update=costs)})


RUN, WITHOUT = with_costs(), with_costs(adaptive=False)


@pytest.fixture(scope="module")
def meshes(tmp_path_factory):
    return write_meshes(tmp_path_factory.mktemp("looking"), small_surfaces())


@pytest.fixture(scope="module")
def candidates(meshes, tmp_path_factory):
    path = tmp_path_factory.mktemp("candidates") / "candidates.parquet"
    make_candidates(StepInputs("touch_curves", {"meshes": meshes}, [path], RUN))
    return path


def test_the_longest_budget_gives_the_touches_and_the_run_the_fewest():
    assert most_touches(RUN) == 3
    assert most_touches(with_costs(budgets=(1.0,))) == RUN.recognition.touches


def test_an_object_is_touched_by_every_strategy_and_seen_in_every_sight(meshes):
    rows, views = sense_object(meshes[0], RUN)
    counts = rows.group_by(["strategy", "viewpoint"]).aggregate([("touch", "count")]).to_pylist()
    found = {(row["strategy"], row["touch_count"]) for row in counts}
    assert found == {(strategy, most_touches(RUN)) for strategy in STRATEGIES}
    assert {part.shape[:2] for part in views.values()} == {(RUN.viewpoints.count, len(SIGHTS))}


def test_views_belong_to_the_viewpoint_and_object_that_is_touched(meshes):
    sensed = sense_all(meshes, None, WITHOUT, 1)
    _, views = sense_object(meshes[1], WITHOUT)
    own = sensed.sequences.object_index == sensed.sequences.objects.index(("box", meshes[1].stem))
    for cue in CUES:
        assert np.array_equal(sensed.seen[cue][own], views[cue])


@pytest.mark.slow
def test_a_viewpoint_without_a_place_for_one_strategy_is_left_out_for_all(meshes, candidates):
    whole = read_table(FEATURES, candidates)
    few = whole.filter(np.array(whole.column("viewpoint").to_pylist()) != 1)
    sensed = sense_all(meshes, few, RUN, 1)
    for sequences in (sensed.sequences, sensed.candidates.sequences):
        assert set(sequences.viewpoint) == {0, 2, 3}


@pytest.mark.slow
def test_table_and_figures_are_written_with_and_without_adaptive_touches(
    meshes, candidates, tmp_path
):
    files = tmp_path / "table.parquet", tmp_path / "figures.json"
    for run, tables in ((RUN, {"tables": [candidates]}), (WITHOUT, {})):
        make_eye_and_touch(StepInputs("eye_and_touch", {"meshes": meshes, **tables}, files, run))
        strategies = set(read_table(EYE_AND_TOUCH, files[0]).column("strategy").to_pylist())
        assert (ADAPTIVE in strategies) == run.cost.adaptive
        found = json.loads(files[1].read_text())
        assert found["objects"] == len(meshes)
        assert [row["sight"] for row in found["sights"]] == list(SIGHTS)


def test_a_free_touch_is_refused():
    given = StepInputs(
        "eye_and_touch", {"meshes": []}, ["table", "figures"], with_costs(touch_seconds=0.0)
    )
    with pytest.raises(ParameterError, match="touch_seconds is 0"):
        make_eye_and_touch(given)
