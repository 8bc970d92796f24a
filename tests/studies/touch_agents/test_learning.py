"""Agents of all cells are tested on whole objects that did not train, and answers follow the rule of the page."""

import json
import sys

import numpy as np
import pytest
from studies.touch_agents.test_learner import LEARNING, synthetic

from touch_agents import learning as module
from visuohaptic.evaluation.intervals import holm
from visuohaptic.recognition.parameters import IntervalParameters

SEEING, BLIND = "seeing", "blind"


def comparison(mean, low, high):
    return {"difference": {"mean": mean, "low": low, "high": high}}


@pytest.mark.parametrize(
    ("found", "corrected", "expected"),
    [
        ((0.05, 0.03, 0.07), 0.01, "yes"),
        ((-0.05, -0.07, -0.03), 0.01, "no"),
        ((0.005, -0.01, 0.019), 0.4, "no"),
        ((0.005, -0.01, 0.021), 0.4, "not settled"),
        ((0.005, -0.021, 0.019), 0.4, "not settled"),
        ((0.05, 0.01, 0.09), 0.06, "not settled"),
    ],
)
def test_answers_follow_the_rule(found, corrected, expected):
    assert module.answer(comparison(*found), corrected) == expected


def test_differences_are_of_the_mean_over_the_shown_touches_in_pairs_over_objects():
    keys = [f"class{index % 4}/{index}" for index in range(20)]
    levels = {(SEEING, True): 0.7, (SEEING, False): 0.5, (BLIND, True): 0.5, (BLIND, False): 0.4}
    noise = np.random.default_rng(0).normal(0, 0.01, size=(20, 1))
    # The share after four touches is not shown.
    rise = np.array([-0.2, 0.0, 0.0, 0.7, 0.2])
    shares = {
        "upright": {cell: np.clip(level + rise + noise, 0, 1) for cell, level in levels.items()}
    }
    figures = module.summarise(shares, keys, IntervalParameters())
    found = {row["name"]: row for row in figures["differences"]}
    means = {name: row["comparison"]["difference"]["mean"] for name, row in found.items()}
    expected = {
        "sight after training": 0.2,
        "sight in training": 0.1,
        "training with sight": 0.2,
        "training without sight": 0.1,
    }
    assert means == pytest.approx(expected, abs=1e-9)
    p_values = [row["comparison"]["p_value"] for row in figures["differences"]]
    assert [row["corrected"] for row in figures["differences"]] == holm(p_values)
    cells = {
        (row["senses"], row["trained"], row["touches"]): row["accuracy"]["objects"]["mean"]
        for row in figures["accuracies"]
    }
    assert cells[SEEING, True, "1"] == pytest.approx(0.5 + noise.mean())
    assert cells[BLIND, False, "mean"] == pytest.approx(0.4 + noise.mean())
    assert len(cells) == 4 * 6


def test_an_object_that_trains_is_not_tested():
    candidates = {SEEING: synthetic(6, 1), BLIND: synthetic(6, 1)}
    keys = candidates[SEEING].keys
    with pytest.raises(ValueError, match=f"{keys[2]} would train and be tested"):
        module.measure(candidates, keys[:3], keys[2:], "full", 1)


@pytest.mark.slow
def test_each_cell_is_measured_on_the_tested_objects_by_agents_of_the_training_objects(monkeypatch):
    candidates = {SEEING: synthetic(12, 2), BLIND: synthetic(12, 2, seed=1)}
    keys = candidates[SEEING].keys
    trained = []
    train = module.train

    def note(own, training, frame, **settings):
        trained.append((own, tuple(training), settings["learns"]))
        return train(own, training, frame, **settings)

    monkeypatch.setattr(module, "train", note)
    shares = module.measure(candidates, keys[::2], keys[1::2], "full", 1, LEARNING)
    assert [(own, learns) for own, _, learns in trained] == [
        (candidates[senses], learns) for senses, learns in module.CELLS
    ]
    assert {training for _, training, _ in trained} == {keys[::2]}
    for senses in (SEEING, BLIND):
        assert shares[senses, True].shape == (6, 5)
        assert shares[senses, True][:, 0].mean() > shares[senses, False][:, 0].mean() + 0.2


def test_validation_holds_every_training_object_out_once(monkeypatch):
    keys = [f"class{index % 3}/{index:02d}" for index in range(12)]
    seen = []

    def fake(candidates, training, tested, *rest):
        seen.append((training, tested))
        return {cell: np.array([[keys.index(key)] for key in tested]) for cell in module.CELLS}

    monkeypatch.setattr(module, "measure", fake)
    order, shares = module.validate({}, keys, "full", 1)
    assert sorted(order) == sorted(keys)
    assert all({*training} | {*tested} == {*keys} for training, tested in seen)
    assert all({*training}.isdisjoint(tested) for training, tested in seen)
    assert [keys.index(key) for key in order] == shares[SEEING, True][:, 0].tolist()


@pytest.mark.parametrize("validates", [True, False])
def test_the_command_tests_the_half_that_did_not_choose_settings(monkeypatch, tmp_path, validates):
    candidates = synthetic(12, 1)
    half = {*candidates.keys[::2]}
    asked = []

    def fake(_, training, tested, *rest):
        asked.append((set(training), set(tested)))
        return {cell: np.full((len(tested), 5), 0.5) for cell in module.CELLS}

    monkeypatch.setattr(module, "choosing_objects", lambda: half)
    monkeypatch.setattr(module, "measure", fake)
    monkeypatch.setattr(module, "collect", lambda *rest: {SEEING: candidates, BLIND: candidates})
    output = tmp_path / "figures.json"
    command = ["learning", "meshes", str(output), *["--validate"] * validates]
    monkeypatch.setattr(sys, "argv", command)
    module.main()
    rest = {*candidates.keys} - half
    for training, tested in asked:
        assert training <= half
        assert tested <= half - training if validates else tested == rest
    figures = json.loads(output.read_text())
    assert {row["answer"] for row in figures["differences"]} == {"not settled"}
    assert len(figures["differences"]) == 8
