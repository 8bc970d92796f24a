"""Test objects that take part in training are found, and honest splits are not."""

from dataclasses import replace

import numpy as np
import pytest
from recognition.synthetic import features_table

from visuohaptic.guards.leaks import guard_chance, guard_unseen, sample_objects
from visuohaptic.recognition import descriptors, experiment, splits, tuning
from visuohaptic.recognition.parameters import ProtocolParameters, RecognitionParameters

PARAMETERS = RecognitionParameters()
FEATURES = features_table(separation=2.0)
SEQUENCES = experiment.gather_pipeline(FEATURES, PARAMETERS, "paper")


def chance(parameters=PARAMETERS):
    return guard_chance(SEQUENCES, parameters, np.random.default_rng(0))


def unseen(pipeline):
    return guard_unseen(FEATURES, pipeline, PARAMETERS, 1, np.random.default_rng(0))


@pytest.mark.slow
def test_shuffled_labels_give_chance_where_no_test_sequence_trains(monkeypatch):
    assert chance().outcome == "held"
    honest = splits._split
    monkeypatch.setattr(
        splits,
        "_split",
        lambda number, tested: replace(honest(number, tested), train=np.arange(len(tested))),
    )
    verdict = chance()
    assert verdict.outcome == "failed"
    assert "100%" in verdict.found


def test_new_views_of_known_objects_are_not_tested():
    protocol = ProtocolParameters(protocol="new_viewpoint")
    parameters = PARAMETERS.model_copy(update={"protocol": protocol})
    assert chance(parameters=parameters).outcome == "not tested"


@pytest.mark.parametrize("pipeline", ["paper", pytest.param("best", marks=pytest.mark.slow)])
def test_noise_in_place_of_test_objects_changes_no_other_answer(pipeline):
    assert unseen(pipeline).outcome == "held"


def test_a_scaling_that_is_fitted_on_test_objects_is_found(monkeypatch):
    seen, run, honest = [], experiment.run_paper_split, experiment.fit_sequence_encoder

    def remember(sequences, *more, **options):
        seen.append(sequences.features)
        return run(sequences, *more, **options)

    monkeypatch.setattr(experiment, "run_paper_split", remember)
    monkeypatch.setattr(
        experiment, "fit_sequence_encoder", lambda _, *more: honest(seen[-1], *more)
    )
    verdict = unseen("paper")
    assert verdict.outcome == "failed"
    assert "classified otherwise by" in verdict.found


@pytest.mark.slow
def test_a_projection_that_is_fitted_on_test_objects_is_found(monkeypatch):
    described, describe, honest = [], descriptors.describe_sequences, tuning.fit_projection

    def remember(*values):
        described.append(describe(*values))
        return described[-1]

    monkeypatch.setattr(descriptors, "describe_sequences", remember)
    monkeypatch.setattr(tuning, "fit_projection", lambda _, *more: honest(described[-1], *more))
    assert unseen("best").outcome == "failed"


def test_a_sample_has_few_objects_of_few_classes_and_none_that_is_alone():
    table = features_table(objects=(5, 1, 4, 3, 2, 6), viewpoints=10)
    sampled = sample_objects(table, np.random.default_rng(0))
    owners = sampled.group_by(["class", "object"]).aggregate([])
    classes = owners.column("class").to_pylist()
    assert len(set(classes)) == 4
    assert "class1" not in classes
    assert max(map(classes.count, classes)) == 3
    assert set(sampled.column("viewpoint").to_pylist()) == set(range(8))
