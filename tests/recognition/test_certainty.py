"""Prediction sets and objects of no known class."""

import numpy as np
import pytest
from recognition.synthetic import clusters
from sklearn.pipeline import Pipeline

from visuohaptic.recognition.certainty import (
    Certainty,
    Reference,
    fit_certainty,
    fit_reference,
)
from visuohaptic.recognition.parameters import least_known_objects, least_objects
from visuohaptic.recognition.pipelines import (
    fit_calibrated,
    log_probabilities,
    make_order_free,
    pooled_log_probabilities,
)


def fit(rows, labels, owners):
    unfitted = make_order_free("linear_discriminant")
    preparation = unfitted[:-1].fit(rows)
    model = fit_calibrated(unfitted[-1], preparation.transform(rows), labels, owners)
    return Pipeline([("preparation", preparation), ("classifier", model)])


def fitted(rows, labels, owners):
    final = fit(rows, labels, owners)
    return final, fit_certainty(fit, final, rows, labels, owners)


def assessed(model, rows, coverage):
    final, certainty = model
    prepared = final[:-1].transform(rows)
    logs = log_probabilities(final[-1], prepared, 3)
    pooled = pooled_log_probabilities(logs, np.ones((1, len(rows)), dtype=bool))[0]
    return certainty.assess(prepared, pooled, coverage)


def compared_with(nonconformity, labels):
    """Return training objects that are compared from one view."""
    scores = np.array([nonconformity], dtype=float)
    nowhere = Reference(np.eye(1), np.zeros((1, 1)))
    own = np.array(labels)
    return Certainty(np.unique(own), own, np.ones(1, int), scores, np.zeros_like(scores), nowhere)


def log_of(nonconformity):
    with np.errstate(divide="ignore"):
        return np.log(1 - np.asarray(nonconformity, dtype=float))


@pytest.mark.parametrize("coverage", [0.5, 0.9])
def test_one_more_object_is_within_the_set_as_often_as_stated(coverage):
    generator = np.random.default_rng(0)
    within = [
        compared_with(draw[:-1], [0] * 40).prediction_set(log_of(draw[-1:]), 1, coverage)[0]
        for draw in generator.random((4000, 41))
    ]
    assert coverage - 0.02 < np.mean(within) < coverage + 1 / 40 + 0.02


@pytest.mark.parametrize(("coverage", "least"), [(0.9, 9), (0.75, 3), (0.95, 19)])
def test_a_class_is_left_out_of_a_set_from_the_least_number_of_objects_on(coverage, least):
    assert least_objects(coverage) == least
    for objects, held in ((least, False), (least - 1, True)):
        own = compared_with(np.zeros(objects), [0] * objects)
        assert own.prediction_set(log_of([1.0]), 1, coverage)[0] == held


def test_a_class_with_enough_objects_is_compared_with_them_and_another_with_all():
    own = compared_with([0.1] * 9 + [0.9] * 3, [0] * 9 + [1] * 3)
    p_values = own.p_values(log_of([0.5, 0.5, 0.5]), 1, 0.9)
    np.testing.assert_allclose(p_values, [0.1, 4 / 13, 4 / 13])
    # A set holds classes that fit better, of the classes 0 and 1 that training had.
    for probability, held in ((0.91, [True, True, False]), (0.89, [False, True, False])):
        answer = np.log([probability, 0.2, 0.5])
        assert own.prediction_set(answer, 1, 0.9).tolist() == held


def test_sets_hold_the_class_of_new_objects_as_often_as_stated():
    rows, labels, owners = clusters(objects=(60, 60, 60), separation=0.12, sequences=4)
    trained = owners % 2 == 0
    model = fitted(rows[trained], labels[trained], owners[trained])
    held, sizes = [], []
    for owner in np.unique(owners[~trained]):
        own = owners == owner
        assessment = assessed(model, rows[own], 0.8)
        held.append(assessment.candidates[labels[own][0]])
        sizes.append(assessment.candidates.sum())
    assert 0.7 < np.mean(held) < 0.95
    assert 1 < np.mean(sizes) < 3


def test_known_objects_are_seldom_called_unknown_and_far_ones_are():
    rows, labels, owners = clusters(objects=(30, 30, 30), separation=3.0, sequences=4)
    trained = owners % 2 == 0
    model = fitted(rows[trained], labels[trained], owners[trained])
    known = [assessed(model, rows[owners == owner], 0.9) for owner in np.unique(owners[~trained])]
    assert np.mean([assessment.unknown for assessment in known]) < 0.25
    strange = assessed(model, 20 + rows[:4], 0.9)
    assert strange.unknown
    assert strange.novelty_rank == pytest.approx(1 - 1 / 46)


@pytest.mark.parametrize(("coverage", "least"), [(0.9, 29), (0.6, 6), (0.95, 59)])
def test_known_objects_seldom_lie_beyond_the_least_number_of_known_objects(coverage, least):
    assert least_known_objects(coverage) == least
    # The chance that a share 1 - coverage of the known objects lies beyond all that were learnt.
    assert coverage**least <= 0.05 < coverage ** (least - 1)
    generator = np.random.default_rng(0)
    beyond = 1 - generator.random((20_000, least)).max(axis=1)
    assert np.mean(beyond > 1 - coverage) == pytest.approx(coverage**least, abs=0.005)


def test_the_only_object_of_a_class_is_not_compared_with_and_its_class_stays_a_candidate():
    rows, labels, owners = clusters(objects=(1, 12, 12))
    model = fitted(rows, labels, owners)
    assert set(model[1].labels) == {1, 2}
    assert assessed(model, rows[owners == 0], 0.9).candidates[0]
    assert fitted(*clusters(objects=(1, 1)))[1] is None


def test_no_training_object_is_compared_by_a_model_that_learnt_it():
    rows, labels, owners = clusters(objects=(4, 4))
    learnt = []

    def catching(rows, labels, owners):
        learnt.append((rows, {*owners.tolist()}))
        return fit(rows, labels, owners)

    fit_certainty(catching, fit(rows, labels, owners), rows, labels, owners)
    for caught, known in learnt:
        np.testing.assert_array_equal(caught, rows[np.isin(owners, [*known])])
    left_out = [owner for _, known in learnt for owner in {*owners.tolist()} - known]
    assert sorted(left_out) == sorted({*owners.tolist()})


def test_novelty_is_the_mahalanobis_distance_by_the_views_of_an_object():
    generator = np.random.default_rng(0)
    spread = np.array([1.0, 2.0, 3.0])
    centres = 100 * generator.normal(size=(4, 3))
    rows = np.repeat(centres, 500, axis=0) + spread * generator.normal(size=(2000, 3))
    reference = fit_reference(rows, np.repeat(np.arange(4), 500))
    moved = centres[2] + np.array([3.0, -2.0, 5.0])
    expected = np.sqrt((np.array([3.0, -2.0, 5.0]) ** 2 / spread**2).sum())
    assert reference.novelty(moved[None]) == pytest.approx(expected, rel=0.05)


def test_with_one_view_per_object_distances_are_euclidean():
    reference = fit_reference(np.array([[0.0, 0.0], [3.0, 4.0]]), np.array([0, 1]))
    assert reference.novelty(np.array([[0.0, 4.0]])) == pytest.approx(3.0)
