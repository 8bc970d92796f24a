"""Covariances of classes with few sequences, beside scikit-learn's."""

import numpy as np
import pytest
from sklearn import covariance as scikit_learn

from visuohaptic.recognition.covariance import regularised_covariance


def centred(rows, columns):
    drawn = np.random.default_rng(0).normal(size=(rows, columns)) * np.arange(1, columns + 1)
    return drawn - drawn.mean(axis=0)


@pytest.mark.parametrize("rows", [2, 5, 40, 400])
def test_a_covariance_is_shrunk_as_scikit_learn_does_it(rows):
    deviations = centred(rows, 6)
    plain = scikit_learn.empirical_covariance(deviations, assume_centered=True)
    found, _ = scikit_learn.ledoit_wolf(deviations, assume_centered=True)
    for amount, theirs in (
        (0.3, scikit_learn.shrunk_covariance(plain, 0.3)),
        ("ledoit_wolf", found),
    ):
        ours = regularised_covariance(deviations, amount, "mean_variance", 0.0)
        np.testing.assert_allclose(ours, theirs, rtol=1e-12, atol=1e-13)


def test_features_keep_their_variances_where_these_are_the_target():
    deviations = centred(5, 6)
    found = regularised_covariance(deviations, 0.4, "own_variances", 1e-3)
    plain = np.cov(deviations.T, bias=True)
    np.testing.assert_allclose(np.diagonal(found), np.diagonal(plain) + 1e-3, rtol=1e-12)
    np.testing.assert_allclose(found[0, 1:], 0.6 * plain[0, 1:], rtol=1e-12)


def test_a_feature_that_does_not_vary_has_the_least_variance_and_no_correlation():
    deviations = centred(5, 6)
    deviations[:, 3] = 0.0
    found = regularised_covariance(deviations, "ledoit_wolf", "own_variances", 1e-3)
    np.testing.assert_array_equal(found[3], 1e-3 * np.eye(6)[3])
    assert np.linalg.eigvalsh(found)[0] == pytest.approx(1e-3)
