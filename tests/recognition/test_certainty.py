"""Prediction sets and objects of no known class."""

import numpy as np
import pytest
from recognition.synthetic import clusters, sequences_of

from visuohaptic.recognition import certainty
from visuohaptic.recognition.certainty import (
    Calibration,
    Landmarks,
    fit_calibration,
    least_objects,
    one_classifier,
)
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.tuning import fit_best_classifiers

PARAMETERS = one_classifier(RecognitionParameters(), "support_vector_machine")


def fitted(descriptors, labels, owners, classes=3, parameters=PARAMETERS):
    training = (labels, owners, classes, parameters)
    projection, fits = fit_best_classifiers(descriptors, *training, np.random.default_rng(0))
    names = [f"imprint_{place}" for place in range(descriptors.shape[1])]
    sequences = sequences_of(descriptors[:, None], names, labels, owners, classes)
    calibration = fit_calibration(
        sequences, descriptors, parameters, projection, np.random.default_rng(0)
    )
    return projection, fits[0][1], calibration


def assessed(model, rows, coverage):
    projection, tuned, calibration = model
    projected = projection.apply(rows)
    found = tuned.ballots(projected).together(np.ones((1, len(rows)), dtype=bool))[0]
    return calibration.assess(tuned, projected, rows, found, coverage)


def calibrated(nonconformity, labels):
    """Give a calibration by bags of one size."""
    nowhere = Landmarks(np.zeros((1, 1)), None)
    evidence = np.zeros((1, len(labels), 2))
    return Calibration(
        np.ones(1, int), np.array(labels), np.array([nonconformity]), evidence, nowhere
    )


@pytest.mark.parametrize("coverage", [0.5, 0.9])
def test_one_more_object_is_within_the_set_as_often_as_stated(coverage):
    generator = np.random.default_rng(0)
    within = [
        calibrated(draw[:-1], [0] * 40).p_values(0, draw[-1:], coverage)[0] > 1 - coverage + 1e-12
        for draw in generator.random((4000, 41))
    ]
    assert coverage - 0.02 < np.mean(within) < coverage + 1 / 40 + 0.02


@pytest.mark.parametrize(("coverage", "least"), [(0.9, 9), (0.5, 1), (0.95, 19)])
def test_a_class_is_left_out_of_a_set_from_the_least_number_of_objects_on(coverage, least):
    assert least_objects(coverage) == least
    for objects, held in ((least, False), (least - 1, True)):
        worst = calibrated(np.zeros(objects), [0] * objects).p_values(0, np.ones(1), coverage)
        assert (worst[0] > 1 - coverage + 1e-12) == held


@pytest.mark.slow
def test_sets_hold_the_class_of_new_objects_as_often_as_stated():
    descriptors, labels, owners = clusters(objects=(60, 60, 60), separation=0.12, sequences=4)
    trained = owners % 2 == 0
    model = fitted(descriptors[trained], labels[trained], owners[trained])
    held, sizes = [], []
    for owner in np.unique(owners[~trained]):
        one = owners == owner
        found = assessed(model, descriptors[one], 0.8)
        held.append(found.candidates[labels[one][0]])
        sizes.append(found.candidates.sum())
    assert 0.7 < np.mean(held) < 0.95
    assert 1 < np.mean(sizes) < 3


def test_known_objects_are_seldom_called_unknown_and_far_ones_are():
    descriptors, labels, owners = clusters(objects=(30, 30, 30), separation=3.0, sequences=4)
    trained = owners % 2 == 0
    model = fitted(descriptors[trained], labels[trained], owners[trained])
    known = [
        assessed(model, descriptors[owners == owner], 0.9) for owner in np.unique(owners[~trained])
    ]
    assert np.mean([one.unknown for one in known]) < 0.25
    strange = assessed(model, 20 + descriptors[:4], 0.9)
    assert strange.unknown
    assert strange.strangeness == pytest.approx(1 - 1 / 46)


def test_a_class_with_enough_objects_is_compared_with_them_and_another_with_all():
    own = calibrated([0.1] * 9 + [0.9] * 3, [0] * 9 + [1] * 3)
    p_values = own.p_values(0, np.array([0.5, 0.5, 0.5]), 0.9)
    np.testing.assert_allclose(p_values, [0.1, 4 / 13, 4 / 13])
    # A set holds what fits better, of the classes 0 and 1 that training had.
    for probability, held in ((0.9, [True, True, False]), (0.89, [False, True, False])):
        answer = np.array([probability, 0.2, 0.5])
        assert own.prediction_set(answer, np.array([0, 1]), 1, 0.9).tolist() == held


def test_an_object_whose_class_has_no_other_has_no_part_in_what_is_compared_with():
    assert set(fitted(*clusters(objects=(1, 12, 12)))[2].labels) == {1, 2}
    assert fitted(*clusters(objects=(1, 1)), classes=2)[2] is None


def test_no_training_object_is_named_by_what_has_learnt_it(monkeypatch):
    descriptors, labels, owners = clusters(objects=(4, 4))
    learnt = []
    original = certainty.fit_best_classifiers

    def catching(rows, labels, owners, *rest):
        learnt.append((rows, set(owners)))
        return original(rows, labels, owners, *rest)

    monkeypatch.setattr(certainty, "fit_best_classifiers", catching)
    fitted(descriptors, labels, owners, classes=2)
    for rows, known in learnt:
        np.testing.assert_array_equal(rows, descriptors[np.isin(owners, [*known])])
    left_out = [place for _, known in learnt for place in set(owners) - known]
    assert sorted(left_out) == sorted(set(owners))
