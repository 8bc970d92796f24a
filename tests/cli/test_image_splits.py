"""Random splits of single images."""

import numpy as np
import pytest

from visuohaptic.cli.image_splits import split_accuracies
from visuohaptic.errors import RecognitionError


def blobs(separation, classes=4, images=20):
    generator = np.random.default_rng(0)
    labels = np.repeat(np.arange(classes), images)
    centres = separation * generator.normal(size=(classes, 6))
    rows = centres[labels] + generator.normal(size=(len(labels), 6))
    noise = generator.normal(size=(len(labels), 200))
    return {"few": rows, "noise": noise}, [f"class{label}" for label in labels]


def test_classes_that_lie_apart_are_separated_also_beside_a_wide_group_of_noise():
    groups, classes = blobs(5.0)
    assert split_accuracies(groups, classes, 5, 0.8, np.random.default_rng(0)).mean() > 0.95


def test_classes_that_are_alike_are_guessed():
    groups, classes = blobs(0.0)
    found = split_accuracies(groups, classes, 20, 0.8, np.random.default_rng(0))
    assert found.shape == (20,)
    assert 0.1 < found.mean() < 0.4


def test_too_few_images_or_classes_are_refused():
    groups, classes = blobs(1.0, classes=2, images=2)
    with pytest.raises(RecognitionError, match="class0 has 2 images, which can't be divided"):
        split_accuracies(groups, classes, 1, 0.8, np.random.default_rng(0))
    with pytest.raises(RecognitionError, match="one class"):
        split_accuracies(groups, ["a"] * 4, 1, 0.8, np.random.default_rng(0))
