"""The quadratic discriminant, compared with scikit-learn's and SciPy's."""

from functools import partial

import numpy as np
import pytest
from scipy.stats import multivariate_normal
from sklearn import covariance
from sklearn.discriminant_analysis import QuadraticDiscriminantAnalysis
from sklearn.utils.estimator_checks import check_estimator

from visuohaptic.base.errors import RecognitionError
from visuohaptic.recognition.quadratic_discriminant import (
    VARIANCE_FLOOR,
    QuadraticDiscriminant,
    regularised_covariance,
)

PSEUDO = partial(QuadraticDiscriminant, regularisation="pseudo_inverse")


def draw(rows, columns, classes=3, seed=0):
    generator = np.random.default_rng(seed)
    labels = np.repeat(np.arange(classes), rows)
    mixing = generator.normal(size=(classes, columns, columns))
    rows = np.einsum("nd,nde->ne", generator.normal(size=(len(labels), columns)), mixing[labels])
    return rows + 2.0 * generator.normal(size=(classes, columns))[labels], labels


class Regularised:
    """Our covariance for scikit-learn's discriminants."""

    def __init__(self, shrinkage, target, floor):
        self.chosen = shrinkage, target, floor

    def fit(self, rows):
        self.covariance_ = regularised_covariance(rows - rows.mean(axis=0), *self.chosen)
        return self


@pytest.mark.parametrize("classes", [2, 5])
@pytest.mark.parametrize("rows", [4, 200])
def test_predictions_are_scikit_learns_with_our_covariance(rows, classes):
    features, labels = draw(rows, 6, classes)
    tested, _ = draw(50, 6, classes, seed=1)
    floor = VARIANCE_FLOOR * features.var(axis=0).mean()
    covariance_estimator = Regularised("ledoit_wolf", "own_variances", floor)
    theirs = QuadraticDiscriminantAnalysis(
        solver="eigen", covariance_estimator=covariance_estimator, tol=0
    ).fit(features, labels)
    ours = QuadraticDiscriminant(regularisation="always").fit(features, labels)
    logs = ours.predict_log_proba(tested)
    np.testing.assert_allclose(logs, theirs.predict_log_proba(tested), rtol=1e-9, atol=1e-9)
    np.testing.assert_array_equal(ours.predict(tested), theirs.predict(tested))


def test_covariances_of_full_rank_are_left_alone():
    features, labels = draw(100, 5, 2)
    fitted = QuadraticDiscriminant().fit(features, labels)
    plain = QuadraticDiscriminantAnalysis().fit(features, labels)
    assert fitted.note_ is None
    np.testing.assert_allclose(
        fitted.predict_log_proba(features), plain.predict_log_proba(features), rtol=1e-9
    )


def test_a_covariance_without_variance_in_a_direction_is_not_taken_plain():
    features, labels = draw(100, 5, 2)
    features[labels == 1, 4] = features[labels == 1, 3]
    for rows in ((features, labels), draw(5, 5, 2)):
        note = QuadraticDiscriminant().fit(*rows).note_
        assert note == "singular covariance: Ledoit-Wolf shrinkage of every class"


@pytest.mark.parametrize("rows", [200, 4])
def test_scores_are_scipys_normal_densities_of_possibly_singular_covariances(rows):
    features, labels = draw(rows, 6)
    fitted = PSEUDO().fit(features, labels)
    scores = fitted.decision_function(features)
    for name in range(3):
        own = features[labels == name]
        normal = multivariate_normal(own.mean(axis=0), np.cov(own.T), allow_singular=True)
        constant = min(rows - 1, 6) * np.log(2 * np.pi) / 2 + np.log(1 / 3)
        # SciPy gives 0 beyond the directions of variance, where we leave these out.
        inside = labels == name if rows < 7 else np.full(len(labels), True)
        expected = normal.logpdf(features[inside]) + constant
        np.testing.assert_allclose(scores[inside, name], expected, rtol=1e-9)


def test_directions_in_which_a_class_does_not_vary_count_for_nothing():
    features, labels = draw(200, 4)
    wider = np.hstack([features, np.full((len(features), 2), 7.0)])
    tested = wider + np.array([0, 0, 0, 0, 3.0, -5.0])
    narrow = PSEUDO().fit(features, labels)
    np.testing.assert_allclose(
        PSEUDO().fit(wider, labels).decision_function(tested),
        narrow.decision_function(features),
        rtol=1e-9,
        atol=1e-9,
    )


def centred(rows, columns):
    drawn = np.random.default_rng(0).normal(size=(rows, columns)) * np.arange(1, columns + 1)
    return drawn - drawn.mean(axis=0)


@pytest.mark.parametrize("rows", [2, 5, 40, 400])
def test_a_covariance_is_shrunk_as_scikit_learn_does_it(rows):
    deviations = centred(rows, 6)
    plain = covariance.empirical_covariance(deviations, assume_centered=True)
    found, _ = covariance.ledoit_wolf(deviations, assume_centered=True)
    for amount, theirs in (
        (0.3, covariance.shrunk_covariance(plain, 0.3)),
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


@pytest.mark.parametrize(
    ("features", "labels", "reason"),
    [
        (np.eye(3), [0, 0, 1], "the smallest class has 1 training sequence"),
        (np.ones((4, 2)), [0, 0, 1, 1], "all 4 training sequences are equal"),
    ],
)
def test_rows_without_a_covariance_are_refused(features, labels, reason):
    with pytest.raises(RecognitionError, match=reason):
        QuadraticDiscriminant().fit(features, labels)


def test_scikit_learns_own_checks_pass():
    results = check_estimator(
        QuadraticDiscriminant(),
        on_fail=None,
        expected_failed_checks={"check_fit2d_1sample": "a covariance needs two rows"},
    )
    assert len(results) > 40
    assert not [one["check_name"] for one in results if one["status"] == "failed"]
