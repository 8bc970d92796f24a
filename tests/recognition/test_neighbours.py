"""The nearest neighbours, beside scikit-learn's."""

import numpy as np
import pytest
from sklearn.neighbors import KNeighborsClassifier

from visuohaptic.recognition.classifier_parameters import ClassifierParameters
from visuohaptic.recognition.neighbours import fit_nearest_neighbours


def fit(features, labels, neighbours):
    chosen = ClassifierParameters(neighbours=neighbours)
    return fit_nearest_neighbours(chosen, features, np.array(labels), 0)[0]


@pytest.mark.parametrize("neighbours", [1, 5, 60])
def test_shares_and_classes_are_scikit_learns(neighbours):
    generator = np.random.default_rng(5)
    labels = 2 * (np.arange(60) % 4)
    features = generator.normal(size=(60, 3)) + 0.2 * labels[:, None]
    tested = np.vstack([generator.normal(size=(100, 3)), features[:5]])
    ours = fit(features, labels, neighbours)
    theirs = KNeighborsClassifier(neighbours, algorithm="brute")
    theirs.fit(features, labels)
    np.testing.assert_allclose(
        ours.predict_proba(tested), theirs.predict_proba(tested), rtol=1e-12, atol=1e-14
    )
    np.testing.assert_array_equal(ours.predict(tested), theirs.predict(tested))


def test_of_rows_as_far_away_the_first_ones_vote():
    features = np.array([[1.0], [-1.0], [1.0], [0.0]])
    found = fit(features, [0, 1, 2, 3], 3)
    np.testing.assert_allclose(found.predict_proba(np.zeros((1, 1))), [[1 / 3, 1 / 3, 0, 1 / 3]])
