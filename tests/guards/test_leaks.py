"""Test objects that take part in training are found, and honest splits are not."""

import dataclasses

import numpy as np
import pytest
from recognition.synthetic import features_table

from visuohaptic.guards.leaks import guard_chance, guard_unseen, sample_objects
from visuohaptic.recognition import descriptors, experiment, splits, tuning
from visuohaptic.recognition.parameters import ProtocolParameters, RecognitionParameters

PARAMETERS = RecognitionParameters()
FEATURES = features_table(separation=2.0)
SEQUENCES = experiment.gather_pipeline(FEATURES, PARAMETERS, "paper")


def chance(seed=0, sequences=SEQUENCES, parameters=PARAMETERS):
    return guard_chance(sequences, parameters, np.random.default_rng(seed))


def unseen(pipeline, seed=0, features=FEATURES):
    return guard_unseen(features, pipeline, PARAMETERS, 1, np.random.default_rng(seed))


def leak_test_sequences(monkeypatch):
    honest = splits._split

    def leaky(number, tested):
        split = honest(number, tested)
        return dataclasses.replace(split, train=np.arange(len(tested)))

    monkeypatch.setattr(splits, "_split", leaky)


@pytest.mark.slow
def test_shuffled_labels_give_chance_where_no_test_sequence_trains(monkeypatch):
    assert chance().outcome == "held"
    leak_test_sequences(monkeypatch)
    verdict = chance()
    assert verdict.outcome == "failed"
    assert "100%" in verdict.found


def test_new_views_of_known_objects_are_not_tested():
    protocol = ProtocolParameters(protocol="new_viewpoint")
    parameters = PARAMETERS.model_copy(update={"protocol": protocol})
    assert chance(parameters=parameters).outcome == "not tested"


def test_noise_in_place_of_test_objects_changes_no_other_answer():
    assert unseen("paper").outcome == "held"


@pytest.mark.slow
def test_noise_in_place_of_test_objects_changes_no_other_answer_of_the_best_pipeline():
    assert unseen("best").outcome == "held"


def test_a_scaling_that_is_fitted_on_test_objects_is_found(monkeypatch):
    honest = experiment.fit_sequence_encoder

    def leaky(training, parameters, generator, memory=None):
        return honest(everything["features"], parameters, generator, memory)

    everything = {}
    run = experiment.run_paper_split

    def remember(sequences, *arguments):
        everything["features"] = sequences.features
        return run(sequences, *arguments)

    monkeypatch.setattr(experiment, "fit_sequence_encoder", leaky)
    monkeypatch.setattr("visuohaptic.guards.leaks.run_paper_split", remember)
    verdict = unseen("paper")
    assert verdict.outcome == "failed"
    assert "classified otherwise by" in verdict.found


@pytest.mark.slow
def test_a_projection_that_is_fitted_on_test_objects_is_found(monkeypatch):
    described = []
    describe = descriptors.describe_sequences
    monkeypatch.setattr(
        "visuohaptic.guards.leaks.describe_sequences",
        lambda *values: described.append(describe(*values)) or described[-1],
    )
    honest = tuning.fit_projection
    monkeypatch.setattr(
        tuning, "fit_projection", lambda values, *more: honest(described[-1], *more)
    )
    assert unseen("best").outcome == "failed"


def test_a_sample_has_few_objects_of_few_classes_and_none_that_is_alone():
    table = features_table(objects=(5, 1, 4, 3, 2, 6), viewpoints=10)
    sampled = sample_objects(table, np.random.default_rng(0))
    owners = set(
        zip(*(sampled.column(name).to_pylist() for name in ("class", "object")), strict=True)
    )
    classes = [name for name, _ in owners]
    assert len(set(classes)) == 4
    assert "class1" not in classes
    assert max(map(classes.count, classes)) == 3
    assert set(sampled.column("viewpoint").to_pylist()) == set(range(8))
