"""Error rates are those of the recognition phase, and what can't be run says why."""

import numpy as np
import pyarrow.compute as pc
import pytest
from recognition.synthetic import features_table
from studies.cost.surfaces import RUN, run_tables, small_surfaces

from visuohaptic.fixations.files import make_fixations
from visuohaptic.geometry.surface import write_surface
from visuohaptic.recognition.experiment import run_pipeline
from visuohaptic.recognition.summary import summarise
from visuohaptic.studies.cost import errors
from visuohaptic.studies.cost.errors import (
    ask,
    clopper_pearson_high,
    error_rate,
    measure_errors,
    setting_features,
    spread_choices,
)
from visuohaptic.studies.cost.settings import condition_of, family_settings
from visuohaptic.tables.phases import FIXATIONS
from visuohaptic.tables.schema import read_table

FEATURES = features_table(objects=(3, 3, 3), viewpoints=4, touches=3, separation=0.3)


@pytest.fixture(scope="module")
def surfaces():
    return small_surfaces()


@pytest.fixture(scope="module")
def tables(surfaces):
    return run_tables(surfaces)


def by_name(family, name):
    return next(setting for setting in family_settings(family, RUN) if setting.name == name)


@pytest.mark.parametrize("pipeline", ["paper", "best"])
def test_one_viewpoint_and_all_of_them_give_the_figures_of_recognition(pipeline):
    setting = by_name("pipelines", f"{pipeline}, support vector machine")
    recognition = setting.parameters(RUN).recognition
    summary = summarise(*run_pipeline(FEATURES, recognition, RUN.seed, pipeline))
    (figures,) = summary["results"][pipeline]["fixation"].values()
    answers = ask(FEATURES, setting, RUN)
    assert 0 < figures["accuracy"]["mean"] < 1
    one = error_rate(answers, setting, RUN)
    assert one.error == pytest.approx(1 - figures["accuracy"]["mean"])
    assert one.objects == figures["objects"] == 9
    assert one.low < one.error < one.high
    every = error_rate(answers, setting.__class__(**{**vars(setting), "viewpoints": 4}), RUN)
    assert every.error == pytest.approx(1 - figures["object_accuracy"]["mean"])


def test_no_error_is_not_taken_for_certainty():
    sure = features_table(objects=(3, 3, 3), viewpoints=4, touches=3, separation=9.0)
    setting = by_name("viewpoints", "4 viewpoints")
    rate = error_rate(ask(sure, setting, RUN), setting, RUN)
    assert (rate.error, rate.low) == (0.0, 0.0)
    # Of nine objects: 1 - 0.025 ** (1 / 9), as any table of binomial limits has it.
    assert rate.high == pytest.approx(0.3363, abs=1e-4)
    assert clopper_pearson_high(100, 0.95) == pytest.approx(0.0362, abs=1e-4)


def test_choices_are_even_and_each_place_is_in_as_many():
    assert spread_choices(16, 4).tolist() == [[k, k + 4, k + 8, k + 12] for k in range(4)]
    assert spread_choices(4, 1).ravel().tolist() == [0, 1, 2, 3]
    assert spread_choices(6, 6).tolist() == [[0, 1, 2, 3, 4, 5]]
    uneven = spread_choices(5, 2)
    assert set(np.bincount(uneven.ravel())) == {2}


def test_features_are_those_of_the_run_where_nothing_changes(surfaces, tables, monkeypatch):
    settings = [by_name("viewpoints", "2 viewpoints"), by_name("features", "skin alone")]
    monkeypatch.setattr(errors, "RayCaster", None)
    found = setting_features(surfaces, settings, tables, RUN)
    assert list(found) == [()]
    assert found[()] is tables.features


def test_a_change_of_the_hand_keeps_the_eye(surfaces, tables, monkeypatch):
    monkeypatch.setattr(errors, "look", None)
    setting = by_name("effects", "fsr400")
    (features,) = setting_features(surfaces, [setting], tables, RUN).values()
    assert features.num_rows == tables.features.num_rows
    assert not features.column("contourlet_01").equals(tables.features.column("contourlet_01"))
    assert features.column("x").to_pylist() == tables.features.column("x").to_pylist()


@pytest.mark.slow
def test_more_touches_begin_with_those_of_the_run(surfaces, tables):
    settings = family_settings("touches", RUN)
    (features,) = setting_features(surfaces, settings, tables, RUN).values()
    assert features.num_rows == len(surfaces) * 4 * 3
    first = features.filter(pc.less(features.column("touch"), 2))
    keys = [(name, "ascending") for name in ("class", "object", "viewpoint", "touch")]
    assert first.sort_by(keys).equals(tables.features.sort_by(keys))


def test_the_eye_rests_where_the_workflow_finds_it(surfaces, tables, tmp_path):
    write_surface(surfaces["ring/ring1"], tmp_path / "ring1.ply")
    made = {name: tmp_path / f"{name}.parquet" for name in ("fixations", "views", "effects")}
    make_fixations(
        key="ring/ring1", mesh=tmp_path / "ring1.ply", **made, block=range(4),
        viewpoints=RUN.viewpoints, rendering=RUN.rendering, attention=RUN.attention,
        probing=RUN.probing, modes=RUN.scene.effects, seed=RUN.seed,
    )  # fmt: skip
    found = tables.fixations.filter(pc.equal(tables.fixations.column("object"), "ring1"))
    expected = read_table(FIXATIONS, [made["fixations"]])
    assert found.select(["viewpoint", "touch", "pixel_row", "pixel_column"]).to_pydict() == (
        expected.select(["viewpoint", "touch", "pixel_row", "pixel_column"]).to_pydict()
    )


def test_a_setting_that_cant_be_run_keeps_its_row_and_its_reason(tables):
    settings = [by_name("viewpoints", "4 viewpoints"), by_name("touches", "3 touches")]
    refused = by_name("imprint", "4 × 4")
    found = {(): tables.features, condition_of(refused): "images are too small."}
    table = measure_errors([*settings, refused], found, RUN).to_pylist()
    assert [row["failed"] is None for row in table] == [True, False, False]
    assert "each of 0 to 2, once, is needed" in table[1]["failed"]
    assert table[2]["failed"] == "images are too small."
    assert table[1]["error"] is None
    assert table[0]["error"] is not None


def test_a_fault_of_the_program_is_not_taken_for_a_refusal(tables, monkeypatch):
    def fault(*_):
        raise ZeroDivisionError

    monkeypatch.setattr(errors, "gather_pipeline", fault)
    with pytest.raises(ZeroDivisionError):
        measure_errors([by_name("viewpoints", "1 viewpoint")], {(): tables.features}, RUN)


def test_settings_that_differ_in_the_vote_alone_train_once(tables, monkeypatch):
    asked = []
    monkeypatch.setattr(errors, "ask", lambda *values: asked.append(values) or ask(*values))
    measure_errors(family_settings("viewpoints", RUN), {(): tables.features}, RUN)
    assert len(asked) == 1
