"""scikit-learn's interface."""

import numpy as np
import pytest
from recognition.synthetic import features_table
from sklearn.utils.estimator_checks import check_estimator

from visuohaptic.recognition.touch_classifier import TouchClassifier, touch_descriptors


@pytest.mark.slow
def test_scikit_learns_own_checks_pass():
    results = check_estimator(TouchClassifier(random_state=0), on_fail=None)
    assert len(results) > 40
    assert not [one["check_name"] for one in results if one["status"] == "failed"]


@pytest.mark.slow
def test_objects_that_training_lacked_are_named_from_all_their_rows():
    rows, classes, objects = touch_descriptors(features_table(objects=(5, 5, 5), separation=2.0))
    tested = np.char.endswith(objects, ("object4"))
    named = TouchClassifier(random_state=0).fit(rows[~tested], classes[~tested], objects[~tested])
    found, probabilities = named.predict_objects(rows[tested], objects[tested])
    assert found.tolist() == ["class0/object4", "class1/object4", "class2/object4"]
    assert named.classes_[probabilities.argmax(axis=1)].tolist() == ["class0", "class1", "class2"]
    np.testing.assert_allclose(probabilities.sum(axis=1), 1)


def test_a_group_of_two_classes_and_too_few_groups_are_refused():
    rows = np.random.default_rng(0).normal(size=(6, 3))
    with pytest.raises(ValueError, match="two classes"):
        TouchClassifier().fit(rows, [0, 0, 0, 1, 1, 1], [0, 0, 1, 1, 2, 2])
    with pytest.raises(ValueError, match="inconsistent"):
        TouchClassifier().fit(rows, [0, 0, 0, 1, 1, 1], [0, 1])
