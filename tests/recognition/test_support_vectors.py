"""The support vector machine, beside scikit-learn's."""

import numpy as np
import pytest
from sklearn.svm import SVC

from visuohaptic.recognition.classifier_parameters import ClassifierParameters
from visuohaptic.recognition.support_vectors import fit_support_vector_machine


@pytest.mark.parametrize("kernel", ["linear", "poly", "rbf"])
@pytest.mark.parametrize("classes", [2, 3, 7])
def test_scores_and_classes_are_scikit_learns(kernel, classes):
    generator = np.random.default_rng(3)
    labels = np.arange(90) % classes
    features = generator.normal(size=(90, 5)) + 0.4 * labels[:, None]
    tested = generator.normal(size=(200, 5)) + 1.0
    chosen = ClassifierParameters(svm_kernel=kernel, svm_penalty=10.0)
    ours, _ = fit_support_vector_machine(chosen, features, 3 * labels, 0)
    theirs = SVC(kernel=kernel, C=10.0).fit(features, 3 * labels)
    scores = theirs.decision_function(tested)
    if classes == 2:
        scores = np.column_stack([-scores, scores])
    np.testing.assert_allclose(ours.decision_function(tested), scores, rtol=1e-9, atol=1e-10)
    np.testing.assert_array_equal(ours.predict(tested), theirs.predict(tested))


def test_features_that_do_not_vary_give_one_class():
    labels = np.array([0, 0, 0, 1])
    machine, _ = fit_support_vector_machine(ClassifierParameters(), np.ones((4, 2)), labels, 0)
    assert machine.predict(np.zeros((3, 2))).tolist() == [0, 0, 0]
