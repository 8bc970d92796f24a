"""The temperature makes probabilities as sure as they are right."""

import numpy as np
import pytest
from scipy.special import log_softmax, softmax

from touch_curves.temperature import fit_temperature


def test_scores_that_are_too_sure_by_a_factor_are_divided_by_the_factor():
    generator = np.random.default_rng(0)
    true = 2 * generator.normal(size=(20_000, 3))
    drawn = np.array([generator.choice(3, p=one) for one in softmax(true, axis=1)])
    assert fit_temperature(4 * true, drawn) == pytest.approx(4, rel=0.05)
    assert fit_temperature(true / 4, drawn) == pytest.approx(0.25, rel=0.05)


def test_no_other_temperature_has_less_log_loss():
    generator = np.random.default_rng(1)
    labels = generator.integers(4, size=50)
    scores = 5 * (np.eye(4)[labels] + generator.normal(size=(50, 4)))

    def loss(temperature):
        return -log_softmax(scores / temperature, axis=1)[np.arange(50), labels].mean()

    best = fit_temperature(scores, labels)
    assert all(loss(best) <= loss(best * other) for other in (0.9, 0.99, 1.01, 1.1))


def test_doubt_keeps_answers_that_are_always_right_from_being_certain():
    scores, labels = np.eye(2)[np.arange(40) % 2], np.arange(40) % 2
    doubted = softmax(scores / fit_temperature(scores, labels, doubt=0.1), axis=1)
    # The truth is 0.9 of the right class and half of 0.1 of each.
    np.testing.assert_allclose(doubted.max(axis=1), 0.95, atol=1e-4)
    assert fit_temperature(scores, labels) < 0.03
