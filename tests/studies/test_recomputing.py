"""A policy that fails is refused by itself: other strategies have the features that they have without it."""

import numpy as np
import pyarrow as pa
import pytest
from studies.surfaces import RUN, small_surfaces, write_meshes

from visuohaptic.active.policies import Policy
from visuohaptic.active.registry import STRATEGIES
from visuohaptic.studies.conditions import FIXATION_ONLY, plan_study
from visuohaptic.studies.measuring import features_by_key, measure_conditions
from visuohaptic.studies.recomputing import Sources, make_study_features
from visuohaptic.studies.study import Condition, Study
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table


def walk(view, touches):
    return view.places.points[len(touches)]


def rogue(view, touches):
    """Fail on rings only, which follow the boxes."""
    is_ring = len(view.caster.surface.vertices) > 100
    return [np.nan, 0, 0] if is_ring and touches else walk(view, touches)


@pytest.fixture
def recomputed(monkeypatch, tmp_path):
    """Return a function that measures strategies on recomputed features."""
    for name, next_location in (("walk", walk), ("rogue", rogue), ("villain", rogue)):
        monkeypatch.setitem(STRATEGIES._entries, name, Policy(name, name, next_location))
    sources = Sources(write_meshes(tmp_path, small_surfaces()))

    def measure(*strategies):
        changes = {**FIXATION_ONLY, "recognition.pipelines": ["paper"], "sensor.resolution": 8}
        condition = Condition("c", {**changes, "probing.strategies": strategies})
        plan = plan_study(Study("mine", "Mine", lambda _: [condition]), RUN)
        ((key, recomputation),) = plan.recomputations.items()
        file = tmp_path / "features.parquet"
        make_study_features(recomputation, sources, file)
        features = features_by_key([], {key: file}, None)(key)
        rows = pa.concat_tables(measure_conditions("mine", plan.conditions, features, RUN.seed))
        errors = {row["strategy"]: row["error"] for row in rows.to_pylist()}
        return read_table(FEATURES, file), errors

    return measure


@pytest.mark.slow
def test_a_policy_that_fails_on_some_object_is_refused_and_no_other_strategy(recomputed, caplog):
    found, errors = recomputed("random", "rogue", "walk")
    sentence = (
        "policy rogue, ring/ring0, viewpoint 0, try 1: it chose (nan, 0, 0); finite numbers below 1e+06 object radii "
        "are needed."
    )
    assert errors == {"random": None, "rogue": sentence, "walk": None}
    assert caplog.messages == [sentence]
    alone, _ = recomputed("random", "walk")
    assert found.equals(alone)


@pytest.mark.slow
def test_policies_that_all_fail_are_an_error_that_names_each(recomputed):
    found, errors = recomputed("rogue", "villain")
    assert not found.num_rows
    assert all(
        "policy rogue, " in error and " policy villain, " in error for error in errors.values()
    )
