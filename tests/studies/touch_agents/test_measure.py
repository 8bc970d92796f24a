"""Baselines are scored per object, a blind guess loses 1, and leads are over random places."""

from dataclasses import replace

import numpy as np
import pyarrow as pa
import pytest
from recognition.synthetic import features_table

from touch_agents import measure as module
from visuohaptic.parameters import as_parameters
from visuohaptic.recognition.experiment import predict_splits
from visuohaptic.studies.conditions import FIXATION_ONLY

RUN = as_parameters({**FIXATION_ONLY, "recognition.touches": 2})


def test_a_blind_guess_loses_one_and_correct_answers_are_counted_per_object(monkeypatch):
    def guess(sequences, *rest):
        classes = len(sequences.classes)
        for one in predict_splits(sequences, *rest):
            blind = np.full((len(one.split.test), classes), -np.log(classes))
            first = np.zeros(len(one.split.test), dtype=int)
            yield replace(one, predicted=first, log_probabilities=blind)

    monkeypatch.setattr(module, "predict_splits", guess)
    keys, correct, losses = module.score(features_table(objects=(2, 3), viewpoints=3), RUN)
    assert losses == pytest.approx(np.ones(5))
    assert [key.partition("/")[0] for key in keys] == ["class0"] * 2 + ["class1"] * 3
    assert correct.tolist() == [1, 1, 0, 0, 0]


def test_classes_that_are_apart_have_less_loss():
    scores = [
        module.score(features_table(objects=(3, 3), viewpoints=3, separation=apart), RUN)
        for apart in (4.0, 0.0)
    ]
    assert scores[0][1].mean() > 0.95 > scores[1][1].mean()
    assert scores[0][2].mean() < 0.2 < scores[1][2].mean()


def test_rows_have_a_lead_over_random_places_of_the_same_frame_and_touches(monkeypatch):
    tables = {
        name: features_table(name, objects=(3, 3), viewpoints=3, separation=apart)
        for name, apart in (("random", 0.1), ("fixation", 4.0))
    }
    monkeypatch.setattr(module, "_features", lambda objects, name, parameters: tables[name])
    rows = list(module.measure([], ("random", "fixation"), ("full", "none"), (1, 2)))
    assert [(row["frame"], row["chooser"], row["touches"]) for row in rows] == [
        (frame, name, count)
        for frame in ("full", "none")
        for name in ("random", "fixation")
        for count in (1, 2)
    ]
    for row in rows:
        assert ("accuracy lead" in row) == (row["chooser"] == "fixation")
    means = {
        (row["frame"], row["chooser"], row["touches"]): (
            row["accuracy"]["objects"]["mean"],
            row["loss"]["classes"]["mean"],
        )
        for row in rows
    }
    for row in rows[2:4]:
        fixed = means["full", "fixation", row["touches"]]
        drawn = means["full", "random", row["touches"]]
        assert row["accuracy lead"]["difference"]["mean"] == pytest.approx(fixed[0] - drawn[0])
        assert row["loss lead"]["difference"]["mean"] == pytest.approx(fixed[1] - drawn[1])


def test_touches_of_a_chooser_come_from_every_object():
    class Thing:
        def touch(self, strategy, parameters):
            return type("Felt", (), {"features": pa.table({"strategy": [strategy]})})

    found = module._features([Thing(), Thing()], "seek_relief", RUN)
    assert found["strategy"].to_pylist() == ["seek_relief"] * 2
