"""The conditions of the study, the table that it keeps, and leads from this table by hand."""

import runpy
from collections import defaultdict
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from studies.surfaces import RUN

from first_touch.accuracies import arrange
from first_touch.study import FRAMES, PARTS, RULES, TOUCHES, conditions
from first_touch.summary import LABELS, Place, accuracies, lead
from first_touch_turned.study import STRATEGIES
from first_touch_turned.study import conditions as turned_conditions
from visuohaptic.attention.registry import CHANNELS
from visuohaptic.base.draw_names import draw_of
from visuohaptic.base.errors import ReportError
from visuohaptic.fixations.probing import PLANNED
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.studies.figures import Cell

PLUG_IN = Path(__file__).parents[3] / "studies/first_touch/plug_in/looking.py"
BOXES = (("box", "a"), ("cup", "b"))


@pytest.fixture(scope="module")
def changes():
    """The changes of each condition by name, with the strategies of the plug-in."""
    with pytest.MonkeyPatch.context() as patch:
        for held in ("_entries", "_sources"):
            patch.setattr(PLANNED, held, dict(getattr(PLANNED, held)))
        runpy.run_path(str(PLUG_IN))
        yield {one.name: one.changes for one in (*conditions(RUN), *turned_conditions(RUN))}


def test_without_the_plug_in_the_strategies_of_the_package_are_left():
    for condition in (*conditions(RUN), *turned_conditions(RUN)):
        named = {draw_of(name)[0] for name in condition.changes["probing.strategies"]}
        assert named <= {*PLANNED.names}
        assert "fixation" in named


def test_channels_and_an_unknown_front_are_measured_with_one_touch_all_else_with_each_number(
    changes,
):
    by_setting = defaultdict(set)
    for name in changes:
        setting, _, touches = name.rpartition(" ")
        by_setting[setting].add(int(touches))
    assert TOUCHES == (1, 2, 3, 5)
    with_one = {f"{channel} none 0 full" for channel in CHANNELS} | {"default none 0 vertical"}
    assert {setting for setting, touches in by_setting.items() if touches == {1}} == with_one
    others = {frozenset(by_setting[setting]) for setting in {*by_setting} - with_one}
    assert others == {frozenset(TOUCHES)}


def test_parts_of_the_gaze_model_choose_the_first_touch_only(changes):
    for name, own in changes.items():
        if name.startswith("default none"):
            has_parts = bool({*PARTS} & {*own["probing.strategies"]})
            assert has_parts == (name == "default none 0 full 1")


@pytest.mark.parametrize("name", ["paper", "benchmark"])
def test_the_kept_tables_have_conditions_of_the_study_only(name, changes):
    kept = pd.read_parquet(PLUG_IN.parents[1] / f"kept_{name}.parquet")
    names = ["looking", "turns", "draw", "known", "touches", "strategy"]
    for *words, strategy in kept[names].drop_duplicates().to_numpy():
        strategies = changes[" ".join(map(str, words))]["probing.strategies"]
        assert strategy in {draw_of(one)[0] for one in strategies}


def test_upright_objects_have_five_draws_of_places_and_turned_objects_three_draws_of_turns(changes):
    upright = changes["default none 0 full 1"]["probing.strategies"]
    assert sum(name.startswith("random_visible") for name in upright) == 5
    assert {*RULES, *PARTS, "human", "fixation"} <= {*upright}
    for turns in ("vertical", "any"):
        draws = {changes[name]["meshes.turn_draw"] for name in changes if name.split()[1] == turns}
        assert draws == {0, 1, 2}
        assert changes[f"default {turns} 0 full 1"]["probing.strategies"] == STRATEGIES


def test_larger_sets_have_one_draw_of_turns():
    meshes = RUN.meshes.model_copy(update={"set": "benchmark"})
    large = turned_conditions(RUN.model_copy(update={"meshes": meshes}))
    assert {one.changes["meshes.turn_draw"] for one in large} == {0}


def test_each_channel_looks_alone_once(changes):
    for channel in CHANNELS:
        own = changes[f"{channel} none 0 full 1"]
        weights = {name: own[f"attention.weights.{name}"] for name in CHANNELS}
        assert weights == {name: float(name == channel) for name in CHANNELS}
        assert own["probing.strategies"] == ("fixation",)


def test_only_our_pipeline_is_measured_where_a_part_of_the_pose_is_unknown(changes):
    for own in changes.values():
        both = own["recognition.frame"] == "full"
        assert len(own["recognition.pipelines"]) == (2 if both else 1)
    assert "vertical" not in FRAMES["any"]


def test_all_strategies_of_the_study_have_words(changes):
    named = {
        strategy.partition("#")[0]
        for own in changes.values()
        for strategy in own["probing.strategies"]
    }
    assert named == {*LABELS}


def cell(*accuracy, **named):
    return Cell(BOXES, np.array(accuracy), np.array([1.0, 3.0]), **named)


SVM = "support_vector_machine"
CELLS = {
    ("default none 0 full 1", "paper", "human", SVM): cell(1.0, 0.5),
    ("default none 0 full 1", "paper", "random_visible", SVM): cell(0.0, 0.5),
    ("default none 0 full 1", "paper", "random_visible#1", SVM): cell(1.0, 0.25),
    ("default none 0 full 2", "paper", "human", SVM): cell(0.0, 0.0),
    ("colour none 0 full 1", "paper", "human", SVM): cell(0.0, 0.0),
    ("default any 0 full 1", "paper", "human", SVM): cell(0.5, 0.0),
    ("default any 1 full 1", "paper", "human", SVM): cell(0.0, 1.0),
}
PAPER = Place("paper", 1)


@pytest.fixture
def rows():
    return arrange(CELLS).to_pandas()


def test_accuracies_are_means_over_draws_of_places_and_of_turns(rows):
    assert accuracies(rows, "human", PAPER).accuracy.tolist() == [1.0, 0.5]
    assert accuracies(rows, "random_visible", PAPER).accuracy.tolist() == [0.5, 0.375]
    turned = accuracies(rows, "human", Place("paper", 1, "any"))
    assert turned.accuracy.tolist() == [0.25, 0.5]
    assert turned.objects == BOXES


def test_a_lead_is_weighted_by_the_objects(rows):
    found = lead(rows, "human", "random_visible", PAPER, IntervalParameters())
    assert found.difference.mean == pytest.approx((0.5 + 3 * 0.125) / 4)
    assert found.objects == 2


def test_what_was_not_measured_is_named(rows):
    with pytest.raises(LookupError, match="highest was not measured in"):
        accuracies(rows, "highest", PAPER)


def test_a_failed_condition_is_refused():
    failed = {("default none 0 full 5", "paper", "human", SVM): cell(error="no view has 5 touches")}
    with pytest.raises(ReportError, match="default none 0 full 5 could not be measured: no view"):
        arrange(failed)
