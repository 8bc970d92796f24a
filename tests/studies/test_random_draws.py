"""A run measures further draws of random strategies that need no view, by a condition of one study."""

import numpy as np
import pyarrow.compute as pc
import pytest
from studies.surfaces import RUN, small_surfaces, write_sources

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.conditions import plan_study
from visuohaptic.studies.measuring import measure_conditions
from visuohaptic.studies.random_draws import RANDOM_DRAWS, draw_conditions
from visuohaptic.studies.recomputing import recompute_features
from visuohaptic.tables.schema import matrix


def run_with(strategies=("fixation", "random"), draws=3, **recognition):
    probing = {"strategies": strategies, "random_draws": draws}
    return ExperimentParameters.from_mapping(
        {
            **RUN.model_dump(),
            "probing": probing,
            "recognition": {**RUN.recognition.model_dump(), **recognition},
        }
    )


def changes_of(*arguments, name="further draws", **named):
    (condition,) = (
        one for one in draw_conditions(run_with(*arguments, **named)) if one.name == name
    )
    return condition.changes


def test_every_random_strategy_that_needs_no_view_has_so_many_draws():
    strategies = ("fixation", "random", "curvature", "random_walk")
    found = changes_of(strategies)["probing.strategies"]
    assert found == ("random#1", "random#2", "random_walk#1", "random_walk#2")


@pytest.mark.parametrize(
    ("strategies", "draws", "pipelines"),
    [
        (("fixation", "random_visible"), 1, ("paper",)),
        (("fixation",), 5, ("paper",)),
        (("random",), 1, ("paper",)),
        (("fixation", "random", "random_visible"), 5, ("order_free",)),
    ],
)
def test_there_is_no_condition_where_nothing_is_drawn_again(strategies, draws, pipelines):
    assert not [*draw_conditions(run_with(strategies, draws, pipelines=pipelines))]


@pytest.mark.parametrize("strategies", [("fixation", "random"), ("random_walk", "fixation")])
def test_a_run_without_random_places_in_sight_gets_one_draw_of_them_in_its_pipelines(strategies):
    pipelines = ("paper", "order_free", "learned")
    found = changes_of(strategies, 5, name="in sight", pipelines=pipelines)
    assert found["probing.strategies"] == ("random_visible",)
    assert found["recognition.pipelines"] == pipelines
    assert found["recognition.classifiers"] == ("support_vector_machine",)
    assert found["recognition.order_free.classifiers"] == ("linear_discriminant",)


def test_the_papers_headline_classifier_is_measured_or_all_of_a_run_that_lacks_it():
    assert changes_of()["recognition.classifiers"] == ("support_vector_machine",)
    assert changes_of()["recognition.pipelines"] == ("paper",)
    others = ("naive_bayes", "decision_tree")
    assert changes_of(classifiers=others)["recognition.classifiers"] == others


def test_a_change_of_recognition_needs_no_other_touches():
    plans = [plan_study(RANDOM_DRAWS, run_with(**changed)) for changed in ({}, {"touches": 1})]
    keys = [[*plan.recomputations] for plan in plans]
    assert keys[0] == keys[1]
    assert len(keys[0]) == 1
    parameters = [plan.conditions[0].parameters.recognition.touches for plan in plans]
    assert parameters == [2, 1]


def test_draws_touch_other_places_than_each_other_and_each_is_classified(tmp_path):
    run = run_with()
    sources, _ = write_sources(tmp_path, small_surfaces(), run)
    plan = plan_study(RANDOM_DRAWS, run)
    (planned, in_sight), (recomputation,) = plan.conditions, plan.recomputations.values()
    assert in_sight.parameters.probing.strategies == ("random_visible",)
    features = recompute_features(recomputation, sources)
    places = [
        matrix(features.filter(pc.equal(features["strategy"], name)), ("x", "y", "z"))
        for name in planned.parameters.probing.strategies
    ]
    assert len(places) == 2
    assert len(places[0]) == len(places[1]) == 6 * 4 * 2
    assert not np.isclose(places[0], places[1]).all(axis=1).any()
    rows = [*measure_conditions("random_draws", [planned], features, run.seed)]
    assert [table["strategy"][0].as_py() for table in rows] == ["random#1", "random#2"]
    assert {error for table in rows for error in table["error"].to_pylist()} == {None}
