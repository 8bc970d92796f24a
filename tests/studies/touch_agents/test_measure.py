"""Baselines are scored per object on objects that did not train, and all differences are corrected together."""

import json
import sys
from dataclasses import replace
from functools import partial

import numpy as np
import pyarrow as pa
import pytest
from recognition.synthetic import features_table
from studies.surfaces import small_surfaces, write_sources

from touch_agents import measure as module
from touch_agents.measure import Cell, SetOfObjects, choose, measure, score
from touch_curves import learning
from touch_curves.adaptive import predict_chosen
from touch_curves.learning import choose_in_split
from visuohaptic.base.errors import RecognitionError
from visuohaptic.evaluation.intervals import holm
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table

FEW = {"recognition.order_free.waves": 20, "recognition.learned.passes": 5}
FOLDS = {"recognition.protocol.maximum_splits": 1, "recognition.protocol.fold_rounds": 2}


@pytest.fixture(autouse=True)
def in_this_process(monkeypatch):
    """Start no process; `touch_curves` tests what it finds."""
    monkeypatch.setattr(learning, "choose_afresh", choose_in_split)


def touched(strategy="fixation", objects=(3, 3), separation=1.0, training=None, viewpoints=3):
    """Return the touches of a chooser at synthetic objects, and the set's parameters."""
    own = SetOfObjects(training, {**FEW, **({} if training else FOLDS)})
    table = features_table(strategy, objects, viewpoints, max(module.SHOWN), separation)
    return choose(strategy, table, own.parameters(), own.splits), own.parameters()


def scored(touches=2, predictor="order_free", **given):
    chosen, run = touched(**given)
    return score(predict_chosen(chosen, module._with(run, "full", touches), predictor))


def test_a_blind_guess_loses_one_and_correct_answers_are_counted_per_object():
    chosen, run = touched(objects=(2, 3))
    predictions = predict_chosen(chosen, run, "order_free")
    classes = 2
    blind = [
        replace(
            one,
            predicted=np.zeros(len(one.split.test), dtype=int),
            log_probabilities=np.full((len(one.split.test), classes), -np.log(classes)),
        )
        for one in predictions.splits
    ]
    keys, values = score(replace(predictions, splits=blind))
    assert values["loss"] == pytest.approx(np.ones(5))
    assert [key.partition("/")[0] for key in keys] == ["class0"] * 2 + ["class1"] * 3
    assert values["accuracy"].tolist() == [1, 1, 0, 0, 0]


@pytest.mark.parametrize("predictor", module.PREDICTORS)
def test_classes_that_are_apart_have_less_loss(predictor):
    (_, apart), (_, near) = (
        scored(predictor=predictor, separation=separation) for separation in (4.0, 0.0)
    )
    assert apart["accuracy"].mean() > 0.95 > near["accuracy"].mean()
    assert apart["loss"].mean() < 0.3 < near["loss"].mean()


def test_every_object_of_the_twelve_is_tested_as_often_and_never_trains_for_itself():
    chosen, _ = touched(objects=(3, 3, 3, 3))
    tested = np.zeros(12, dtype=int)
    owners = chosen.sequences.object_index
    for split in chosen.splits:
        assert {*owners[split.train]}.isdisjoint(owners[split.test])
        tested[np.unique(owners[split.test])] += 1
    assert tested.tolist() == [2] * 12


def test_of_the_benchmark_the_objects_that_chose_settings_train_and_the_others_are_tested():
    training = {f"class{place}/object{number}" for place in range(2) for number in (0, 2)}
    keys, values = scored(objects=(4, 4), training=training)
    assert keys == [f"class{place}/object{number}" for place in range(2) for number in (1, 3)]
    assert {len(found) for found in values.values()} == {4}
    named = module.set_of_objects("benchmark")
    assert len(named.training) == 67
    assert named.parameters().viewpoints.total == 8
    assert module.set_of_objects("paper").parameters().viewpoints.total == 16


def test_a_tested_object_has_no_influence_on_the_values_of_another():
    training = {f"class{place}/object{number}" for place in range(2) for number in (0, 1)}
    chosen, run = touched("adaptive", objects=(4, 4), training=training, viewpoints=2)
    [split], [features] = chosen.splits, chosen.features
    changed, own = features.copy(), chosen.sequences.object_index == 2
    assert own[split.test].any()
    changed[own] = np.random.default_rng(1).normal(size=changed[own].shape)
    before, after = (
        score(predict_chosen(replace(chosen, features=[of]), run, "order_free"))[1]["loss"]
        for of in (features, changed)
    )
    assert (before == after).tolist() == [False, True, True, True]


def test_without_an_object_that_trains_the_set_is_refused():
    with pytest.raises(RecognitionError, match="0 of 6 objects train"):
        touched(training={"class0/other"})


RISES = {1: -0.2, 2: 0.0, 3: 0.05, 5: 0.15}
"""What touches add to the level of a cell; the mean is 0."""


def cells_of(levels, objects=20):
    """Return values of all cells of the rule at given levels, with the same noise per object."""
    noise = np.random.default_rng(0).normal(0, 0.01, size=objects)
    return {
        Cell(chooser, predictor, frame, count): {
            "accuracy": np.clip(level + noise, 0, 1),
            "loss": 1 - level + np.abs(noise),
        }
        for frame in module.FRAMES
        for (chooser, predictor), level in levels.items()
        for count, level in ((count, level + rise) for count, rise in RISES.items())
    }


@pytest.mark.slow
def test_differences_are_those_of_the_rule_and_all_are_corrected_together():
    levels = {(name, by): 0.5 for name in module.CHOOSERS for by in module.PREDICTORS}
    levels["adaptive", "learned"] = 0.8
    keys = [f"class{index % 4}/{index}" for index in range(20)]
    figures = module.summarise(keys, cells_of(levels), IntervalParameters())
    rows = figures["differences"]
    assert len(rows) == 104
    means = {
        (row["measure"], row["frame"], row["predictor"], row["chooser"]): row["comparison"][
            "difference"
        ]["mean"]
        for row in rows
    }
    assert len(means) == 104
    assert means["accuracy", "full", "learned", "adaptive"] == pytest.approx(0.3)
    assert means["accuracy", "none", "learned - order_free", "adaptive"] == pytest.approx(0.3)
    assert means["loss", "centre", "learned", "adaptive"] == pytest.approx(-0.3)
    assert sum(abs(mean) > 1e-9 for mean in means.values()) == 16
    p_values = [row["comparison"]["p_value"] for row in rows]
    assert [row["corrected"] for row in rows] == holm(p_values)
    shown = [row for row in rows if row["corrected"] < 0.05]
    assert {(row["predictor"], row["chooser"]) for row in shown} == {
        ("learned", "adaptive"),
        ("learned - order_free", "adaptive"),
    }
    assert len(figures["cells"]) == 4 * 2 * 4 * 5
    assert {*figures["cells"][0]["loss"]} == {"objects", "classes"}


def test_choosers_that_tested_different_objects_are_not_compared():
    chosen, run = touched(objects=(3, 3))
    fewer, _ = touched(objects=(3, 2))
    with pytest.raises(RecognitionError, match="b tested 5 objects; the same 6"):
        measure({"a": chosen, "b": fewer}, run, ("order_free",), ("full",), (1,))


@pytest.mark.slow
@pytest.mark.long
def test_the_command_measures_all_choosers_and_keeps_their_touches(tmp_path, monkeypatch):
    changes = {**FEW, **FOLDS, "viewpoints.count": 2, "rendering.resolution": 48}
    changes |= {"sensor.resolution": 16, "recognition.protocol.fold_rounds": 1}
    monkeypatch.setattr(module, "set_of_objects", lambda name: SetOfObjects(None, changes))
    monkeypatch.setattr(module, "measure", partial(measure, frames=("full", "none")))
    write_sources(tmp_path / "meshes", small_surfaces())
    output, folder = tmp_path / "figures.json", tmp_path / "touches"
    command = ["measure", str(tmp_path / "meshes"), "paper", str(output), "--touches", str(folder)]
    monkeypatch.setattr(sys, "argv", command)
    module.main()
    figures = json.loads(output.read_text())
    cells = {
        (row["chooser"], row["predictor"], row["frame"], row["touches"]) for row in figures["cells"]
    }
    assert len(cells) == len(figures["cells"]) == 2 * 2 * 4 * 5
    kept = read_table(FEATURES, folder / "touches.parquet")
    assert {*kept.column("strategy").to_pylist()} == {*module.CHOOSERS}
    counts = pa.TableGroupBy(kept, "strategy").aggregate([("touch", "max")]).to_pylist()
    assert {row["touch_max"] for row in counts if row["strategy"] != "adaptive"} == {4}
    monkeypatch.setattr(module, "touch_candidates", None)
    module.main()
    again = json.loads(output.read_text())
    assert [again[name] for name in ("cells", "differences")] == [
        figures[name] for name in ("cells", "differences")
    ]
