"""A condition changes what it names, from as late a table as it allows, and breaks alone."""

from unittest.mock import patch

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pytest
import trimesh
from recognition.synthetic import features_table
from studies.surfaces import RUN, small_surfaces, surface_of, write_sources

from visuohaptic import recognition
from visuohaptic.base.errors import ParameterError
from visuohaptic.evaluation.summary import summarise
from visuohaptic.geometry import surface as surfaces_of_files
from visuohaptic.geometry.surface import object_of, read_surface
from visuohaptic.geometry.turning import draw_rotation, turn_surface
from visuohaptic.recognition.sequences import whole_sequences
from visuohaptic.studies import measuring, recomputing
from visuohaptic.studies.conditions import (
    FIXATION_ONLY,
    describe_conditions,
    plan_study,
)
from visuohaptic.studies.figures import cells_of, condition_interval
from visuohaptic.studies.measuring import (
    features_by_key,
    make_study_block,
    measure_conditions,
)
from visuohaptic.studies.recomputing import Sources, make_study_features, recompute_features
from visuohaptic.studies.study import Condition, Study
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table
from visuohaptic.tables.studies import STUDY

PAPER_ONLY = {**FIXATION_ONLY, "recognition.pipelines": ["paper"]}
SYNTHETIC = features_table(objects=(3, 3, 3), viewpoints=4, touches=3, separation=0.3)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return write_sources(tmp_path_factory.mktemp("run"), small_surfaces())


def mine(*conditions):
    return plan_study(Study("mine", "Mine", lambda _: conditions), RUN)


def cells(features, *planned):
    return cells_of(pa.concat_tables(measure_conditions("mine", planned, features, RUN.seed)))


# From features, touches and views on.
CHANGES = (
    {"features.extension": "symmetric"},
    {"sensor.largest_size": 0.2},
    {"rendering.resolution": 32},
)


@pytest.mark.parametrize("changes", CHANGES)
def test_what_comes_before_the_change_is_read_and_not_made(run, monkeypatch, changes):
    (recomputation,) = mine(Condition("c", changes)).recomputations.values()
    meshes, tables = run[0].meshes, run[0].tables
    needed = {
        "features": Sources(tables={"touches": tables["touches"]}),
        "touches": Sources(meshes, {"fixations": tables["fixations"]}),
        "views": Sources(meshes),
    }[recomputation.phase]
    if recomputation.phase == "features":
        monkeypatch.setattr(surfaces_of_files, "read_surface", None)
    found, own = recompute_features(recomputation, needed), read_table(FEATURES, run[1])
    assert found["touch"].equals(own["touch"])
    assert not found["contourlet_03"].equals(own["contourlet_03"])
    assert found["x"].equals(own["x"]) == (recomputation.phase != "views")


def test_turned_objects_are_those_of_a_run_whose_meshes_were_turned(run, tmp_path):
    changes = {"meshes.turns": "any", "meshes.turn_draw": 2}
    (recomputation,) = mine(Condition("c", changes)).recomputations.values()
    turned = {
        object_of(mesh): turn_surface(
            read_surface(mesh), draw_rotation("any", object_of(mesh), RUN.seed, 2)
        )
        for mesh in run[0].meshes
    }
    _, expected = write_sources(tmp_path, turned)
    found, own = (
        recompute_features(recomputation, Sources(run[0].meshes)),
        read_table(FEATURES, run[1]),
    )
    assert found.equals(read_table(FEATURES, expected))
    assert not found["x"].equals(own["x"])


def test_more_touches_begin_with_those_of_the_run(run):
    (recomputation,) = mine(Condition("c", {"recognition.touches": 3})).recomputations.values()
    found = recompute_features(recomputation, Sources(meshes=run[0].meshes))
    assert found.num_rows == len(small_surfaces()) * 4 * 3
    assert found.filter(pc.less(found["touch"], 2)).equals(read_table(FEATURES, run[1]))


@pytest.mark.slow
@pytest.mark.parametrize("pipeline", ["paper", "order_free"])
def test_one_vote_and_all_votes_give_the_figures_of_recognition(pipeline):
    changes = {**FIXATION_ONLY, "recognition.pipelines": [pipeline]}
    one, every = mine(Condition("1", changes, votes=1), Condition("4", changes, votes=4)).conditions
    tables = recognition.run_pipeline(SYNTHETIC, one.parameters.recognition, RUN.seed, pipeline)
    (figures,) = summarise(*tables)["results"][pipeline]["fixation"].values()
    for planned, figure in ((one, "accuracy"), (every, "object_accuracy")):
        (cell,) = cells(SYNTHETIC, planned).values()
        found = condition_interval(cell, one.parameters.recognition.intervals)
        assert vars(found) == pytest.approx(figures[figure], abs=1e-9)


def test_conditions_that_differ_in_the_vote_alone_train_once():
    votes = [Condition(f"{votes}", PAPER_ONLY, votes=votes) for votes in (1, 2, 4)]
    planned = mine(*votes).conditions
    with patch.object(measuring, "predict_splits", wraps=measuring.predict_splits) as predicting:
        found = cells(SYNTHETIC, *planned)
    assert predicting.call_count == 1
    assert [key[0] for key in found] == ["1", "2", "4"]


def test_a_broken_condition_is_named_and_stops_nothing(run, tmp_path, monkeypatch):
    def refuse(*_):
        raise ParameterError("sensor.resolution is 8: this sensor can't be described.")

    monkeypatch.setattr(recomputing, "run", refuse)
    sources, features = run
    plan = mine(
        Condition("as run", {**FIXATION_ONLY}),
        Condition("too small", {**FIXATION_ONLY, "sensor.resolution": 8}),
        Condition(
            "too many", {**FIXATION_ONLY, "recognition.protocol.protocol": "grouped_folds"}, votes=9
        ),
        Condition("fine", {**FIXATION_ONLY, "recognition.classifier.svm_penalty": 2.0}),
    )
    ((key, recomputation),) = plan.recomputations.items()
    made = {key: tmp_path / "features.parquet"}
    make_study_features(recomputation, sources, made[key])
    assert isinstance(features_by_key([], made, None)(key), str)
    block = tmp_path / "block.parquet"
    make_study_block(
        "mine", describe_conditions(plan.conditions), [features], made, block, RUN.seed
    )
    rows = read_table(STUDY, block).to_pylist()
    errors = {row["condition"]: row["error"] for row in rows if row["pipeline"] == "paper"}
    assert {name for name, error in errors.items() if error} == {"too small", "too many"}
    assert "9 viewpoints can't vote" in errors["too many"]
    assert "this sensor can't be described" in errors["too small"]


def test_a_fault_of_the_program_is_not_taken_for_a_refusal(monkeypatch):
    def fault(*_):
        raise ZeroDivisionError

    monkeypatch.setattr(measuring, "predict_splits", fault)
    with pytest.raises(ZeroDivisionError):
        cells(SYNTHETIC, *mine(Condition("c", FIXATION_ONLY)).conditions)


@pytest.mark.slow
def test_a_block_gives_the_same_rows_however_conditions_are_cut(run, tmp_path):
    penalties = [
        {**FIXATION_ONLY, "recognition.classifier.svm_penalty": one} for one in (1.0, 2.0, 4.0)
    ]
    plan = mine(*(Condition(f"{place}", changes) for place, changes in enumerate(penalties)))

    def rows(*blocks):
        files = [tmp_path / f"{len(blocks)}-{place}" for place in range(len(blocks))]
        for file, chosen in zip(files, blocks, strict=True):
            make_study_block("mine", describe_conditions(chosen), [run[1]], {}, file, RUN.seed)
        return read_table(STUDY, files).drop_columns(["seconds"])

    assert rows(plan.conditions).equals(rows(*([one] for one in plan.conditions)))


SHORT = SYNTHETIC.column("object")[0].as_py()
# What a slender object lacks: the last touch of one viewpoint.
WITHOUT_LAST = SYNTHETIC.filter(
    (pc.field("object") != SHORT) | (pc.field("viewpoint") != 1) | (pc.field("touch") != 2)
)


@pytest.mark.parametrize("votes", [None, 1, 2, 4])
@pytest.mark.parametrize("protocol", ["leave_one_object_a_class_out", "grouped_folds"])
def test_a_view_with_too_few_places_is_left_out_and_stops_nothing(votes, protocol):
    changes = {**PAPER_ONLY, "recognition.touches": 3, "recognition.protocol.protocol": protocol}
    (planned,) = mine(Condition("c", changes, votes=votes)).conditions
    (found,) = cells(WITHOUT_LAST, planned).values()
    assert found.error is None
    assert len(found.objects) == 9
    (same,) = cells(whole_sequences(WITHOUT_LAST, 3)[0], planned).values()
    np.testing.assert_array_equal(found.accuracy, same.accuracy)
    assert (found.accuracy <= 1).all()


# A viewpoint with one of three touches, and with none.
@pytest.mark.parametrize("missing", [2, 3])
def test_where_random_touches_run_out_of_places_changes_nothing_for_fixation(missing):
    whole = SYNTHETIC.filter(pc.equal(SYNTHETIC["strategy"], "fixation"))
    short = features_table("random", (3, 3, 3), viewpoints=4, touches=3, separation=0.3)
    changes = {**PAPER_ONLY, "recognition.touches": 3}
    both = {**changes, "probing.strategies": ["fixation", "random"]}
    alone, beside = mine(Condition("alone", changes), Condition("beside", both)).conditions
    key = ("fixation", "support_vector_machine")
    first = cells(whole, alone)["alone", "paper", *key]
    second = cells(pa.concat_tables([whole, short.slice(missing)]), beside)["beside", "paper", *key]
    np.testing.assert_array_equal(first.accuracy, second.accuracy)
    np.testing.assert_array_equal(first.weights, second.weights)


def test_a_condition_that_makes_fewer_touches_takes_no_more():
    changes = {**FIXATION_ONLY, "attention.fixations": 2, "recognition.touches": None}
    (planned,) = mine(Condition("c", changes)).conditions
    taken = measuring.condition_features(planned, SYNTHETIC, "fixation")
    assert set(taken["touch"].to_pylist()) == {0, 1}


@pytest.mark.slow
@pytest.mark.parametrize("changes", CHANGES)
def test_an_object_that_no_view_shows_a_place_of_stops_no_study(tmp_path, changes):
    hair = surface_of(trimesh.creation.cylinder(1e-5, 2))
    sources, _ = write_sources(tmp_path, small_surfaces() | {"ring/hair": hair})
    plan = mine(Condition("c", changes | PAPER_ONLY))
    (recomputation,) = plan.recomputations.values()
    (found,) = cells(recompute_features(recomputation, sources), *plan.conditions).values()
    assert len(found.objects) == len(small_surfaces())
