"""Parts of the pipelines, and probabilities."""

import numpy as np
import pytest
from recognition.synthetic import clusters, features_table
from sklearn.base import clone
from sklearn.model_selection import StratifiedGroupKFold, cross_val_score

from visuohaptic import recognition
from visuohaptic.base.errors import RecognitionError
from visuohaptic.recognition import pipelines
from visuohaptic.recognition.classifiers import CLASSIFIERS
from visuohaptic.recognition.parameters import OrderFreeParameters, RecognitionParameters
from visuohaptic.recognition.pipelines import (
    LEAST_LOG_PROBABILITY,
    fit_calibrated,
    log_probabilities,
    make_order_free,
    pooled_log_probabilities,
)


def test_order_free_is_a_pipeline_for_cross_validation_by_objects():
    rows, classes, objects = recognition.touch_descriptors(
        features_table(objects=(4, 4), separation=2.0)
    )
    scores = cross_val_score(
        clone(make_order_free()), rows, classes, groups=objects, cv=StratifiedGroupKFold(4)
    )
    assert scores.mean() > 0.8


@pytest.mark.parametrize(
    "cues", [("relations", "embedding"), ("position",), ("normal",), ("position", "normal")]
)
def test_descriptors_that_do_not_vary_are_refused(cues):
    parameters = RecognitionParameters(
        frame="none", touches=1, order_free=OrderFreeParameters(cues=cues)
    )
    said = rf"cues {', '.join(cues)} has the same value in all sequences \(frame none, touches per sequence: 1\)"
    with pytest.raises(RecognitionError, match=said):
        recognition.run_pipeline(features_table(), parameters, 1, "order_free")


@pytest.mark.parametrize("name", CLASSIFIERS.names)
def test_every_classifier_has_probabilities_also_of_a_class_without_training(name):
    rows, labels, owners = clusters(objects=(2, 2))
    fitted = fit_calibrated(make_order_free(name)[-1], rows, labels * 2, owners)
    logs = log_probabilities(fitted, rows, 3)
    assert (logs[:, 1] == LEAST_LOG_PROBABILITY).all()
    np.testing.assert_allclose(np.exp(logs).sum(axis=1), 1)
    assert (logs.argmax(axis=1) == labels * 2).mean() > 0.9


@pytest.mark.parametrize("objects", [(1, 1), (1, 3)])
@pytest.mark.parametrize("name", ["support_vector_machine", "linear_discriminant"])
def test_a_class_of_one_object_leaves_the_classifier_without_a_temperature(name, objects):
    rows, labels, owners = clusters(objects=objects)
    fitted = fit_calibrated(make_order_free(name)[-1], rows, labels, owners)
    np.testing.assert_allclose(np.exp(log_probabilities(fitted, rows, 2)).sum(axis=1), 1)


def test_the_temperature_is_fitted_on_objects_that_were_not_learnt(monkeypatch):
    rows, labels, owners = clusters()
    folds = []

    def catching(*arguments):
        folds.extend(held_out_folds(*arguments))
        return folds

    held_out_folds = pipelines.held_out_folds
    monkeypatch.setattr(pipelines, "held_out_folds", catching)
    fit_calibrated(make_order_free()[-1], rows, labels, owners)
    assert len(folds) == pipelines.CALIBRATION_FOLDS
    for train, held_out in folds:
        assert not {*owners[train]} & {*owners[held_out]}


def test_doubtful_classes_have_probabilities_about_as_often_right_as_they_say():
    rows, labels, owners = clusters(objects=(40, 40), separation=0.15, sequences=4)
    trained = owners % 2 == 0
    fitted = fit_calibrated(
        make_order_free("support_vector_machine")[-1],
        rows[trained], labels[trained], owners[trained],
    )  # fmt: skip
    logs = log_probabilities(fitted, rows[~trained], 2)
    correct = logs.argmax(axis=1) == labels[~trained]
    assert np.exp(logs.max(axis=1)).mean() == pytest.approx(correct.mean(), abs=0.08)


def test_a_group_of_sequences_has_the_normalised_mean_of_log_probabilities():
    logs = np.log([[0.8, 0.2], [0.5, 0.5], [0.1, 0.9]])
    members = np.array([[True, True, False], [False, False, True]])
    pooled = np.exp(pooled_log_probabilities(logs, members))
    expected = np.sqrt([0.8 * 0.5, 0.2 * 0.5])
    np.testing.assert_allclose(pooled, [expected / expected.sum(), [0.1, 0.9]])


@pytest.mark.parametrize("pipeline", ["paper", "order_free"])
def test_each_classifier_draws_a_seed_of_its_own(pipeline):
    parts = pipelines.pipeline_of(pipeline, recognition.RecognitionParameters(), 0)
    seeds = parts.seeds(np.random.default_rng(0))
    assert seeds.keys() == parts.classifiers.keys()
    assert len({*seeds.values()}) == len(seeds)


def test_a_tree_is_the_same_with_one_seed_and_another_with_another():
    parameters = recognition.RecognitionParameters(classifiers=("decision_tree",))
    table = features_table(objects=(3, 3), separation=0.3)
    first, again, other = (
        recognition.run_pipeline(table, parameters, seed)[1]["predicted"] for seed in (1, 1, 2)
    )
    assert first == again
    assert first != other
