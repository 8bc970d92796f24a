"""Discriminants of classes with few sequences."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from visuohaptic.recognition.classifiers import ClassifierParameters, fit_classifier
from visuohaptic.recognition.covariance import PseudoQuadraticDiscriminant


def draw(generator, rows, columns, classes=3):
    labels = np.repeat(np.arange(classes), rows)
    mixing = generator.normal(size=(classes, columns, columns))
    rows = np.einsum("nd,nde->ne", generator.normal(size=(len(labels), columns)), mixing[labels])
    return rows + 2.0 * generator.normal(size=(classes, columns))[labels], labels


@pytest.mark.parametrize("rows", [200, 4])
def test_scores_are_scipys_normal_densities_of_possibly_singular_covariances(rows):
    features, labels = draw(np.random.default_rng(1), rows, 6)
    scores = PseudoQuadraticDiscriminant().fit(features, labels).decision_function(features)
    for name in range(3):
        own = features[labels == name]
        normal = multivariate_normal(own.mean(axis=0), np.cov(own.T), allow_singular=True)
        constant = min(rows - 1, 6) * np.log(2 * np.pi) / 2 + np.log(1 / 3)
        # SciPy gives 0 beyond the directions of variance, where we leave these out.
        inside = labels == name if rows < 7 else np.full(len(labels), True)
        expected = normal.logpdf(features[inside]) + constant
        np.testing.assert_allclose(scores[inside, name], expected, rtol=1e-9)


def test_directions_in_which_a_class_does_not_vary_count_for_nothing():
    features, labels = draw(np.random.default_rng(2), 200, 4)
    wider = np.hstack([features, np.full((len(features), 2), 7.0)])
    tested = wider + np.array([0, 0, 0, 0, 3.0, -5.0])
    narrow = PseudoQuadraticDiscriminant().fit(features, labels)
    np.testing.assert_allclose(
        PseudoQuadraticDiscriminant().fit(wider, labels).decision_function(tested),
        narrow.decision_function(features),
        rtol=1e-9,
        atol=1e-9,
    )


@pytest.mark.parametrize("rows", [2, 5])
def test_with_fewer_sequences_than_features_every_class_has_a_finite_score(rows):
    features, labels = draw(np.random.default_rng(3), rows, 9)
    parameters = ClassifierParameters(discriminant_regularisation="pseudo_inverse")
    fitted, note = fit_classifier(
        "quadratic_discriminant", parameters, features, labels, np.random.default_rng(0)
    )
    assert note is None
    assert np.isfinite(fitted.decision_function(features)).all()
    assert fitted.predict(features).shape == labels.shape
