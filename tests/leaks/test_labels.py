"""The class of a test object never reaches training, in the small run that the workflow's tests make."""

from dataclasses import replace

import numpy as np
import pytest
from leaks.predicting import PARAMETERS, predict

from visuohaptic.recognition.experiment import predict_splits
from visuohaptic.recognition.pipelines import PaperPipeline
from visuohaptic.recognition.sequences import gather_pipeline
from visuohaptic.recognition.splits import draw_splits

pytestmark = pytest.mark.workflow

SHUFFLES = 100
# The mean of 100 values in [0, 1] is farther from its expectation with a probability below 2e-5 (Hoeffding,
# J. Am. Stat. Assoc. 58(301), 1963).
FARTHEST = np.sqrt(np.log(1e5) / (2 * SHUFFLES))
# It gives back what it was trained with, so that a leak shows in full.
MEMORISING = PARAMETERS.model_copy(update={"classifiers": ("decision_tree",)})


def splits_of(sequences):
    return draw_splits(sequences, PARAMETERS.protocol, 0)


def with_classes(sequences, classes):
    """Return the sequences with other classes of their objects, whose names stay."""
    names = [f"{number} {name}" for number, (_, name) in enumerate(sequences.objects)]
    return replace(sequences, objects=tuple(zip(classes, names, strict=True)))


@pytest.mark.parametrize("pipeline", ["paper", "order_free"])
def test_other_labels_of_test_objects_change_no_prediction(features, pipeline):
    sequences = gather_pipeline(features, PARAMETERS, pipeline)
    classes = np.array([name for name, _ in sequences.objects])
    for split in splits_of(sequences):
        tested = np.unique(sequences.object_index[split.test])
        others = classes.copy()
        others[tested] = np.roll(classes[tested], 1)
        assert (others != classes).any()
        before = predict(with_classes(sequences, classes.tolist()), split, pipeline)
        after = predict(with_classes(sequences, others.tolist()), split, pipeline)
        assert before
        for name in before:
            np.testing.assert_array_equal(after[name], before[name], name)


def test_shuffled_labels_give_the_accuracy_of_chance(features):
    sequences = gather_pipeline(features, PARAMETERS, "paper")
    generator = np.random.default_rng(0)
    classes = [name for name, _ in sequences.objects]
    accuracies = []
    for _ in range(SHUFFLES):
        shuffled = with_classes(sequences, generator.permutation(classes).tolist())
        splits = splits_of(shuffled)
        split = splits[generator.integers(len(splits))]
        (answer,) = predict_splits(shuffled, PaperPipeline.of(MEMORISING), [split], 0)
        # A split tests one object of each class, so that the expectation is 1 over the number of classes.
        accuracies.append((answer.predicted == shuffled.labels[split.test]).mean())
    assert abs(np.mean(accuracies) - 1 / len(sequences.classes)) < FARTHEST
