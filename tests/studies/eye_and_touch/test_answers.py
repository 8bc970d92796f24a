"""What a sense answers is recognition's own answer; held-out answers and products keep to training objects."""

import numpy as np
import pytest
from recognition.synthetic import features_table

from eye_and_touch.answers import (
    Answered,
    Sense,
    answer_splits,
    ask_if_familiar,
    multiply,
)
from visuohaptic.base.errors import RecognitionError
from visuohaptic.recognition.descriptors import describe_all
from visuohaptic.recognition.experiment import predict_splits
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.pipelines import pipeline_of
from visuohaptic.recognition.sequences import gather_pipeline
from visuohaptic.recognition.splits import draw_splits

PARAMETERS = RecognitionParameters(order_free={"classifiers": ("linear_discriminant",)})
SEED = 7


def sequences_of(*objects):
    table = features_table(objects=objects, viewpoints=3, separation=1.0)
    return gather_pipeline(table, PARAMETERS, "order_free", SEED)


def answer(sequences, *described, count=1):
    splits = draw_splits(sequences, PARAMETERS.protocol, SEED)[:count]
    return splits, answer_splits(splits, [described] * count, sequences)


@pytest.fixture(scope="module")
def answered():
    sequences = sequences_of(4, 4, 4)
    described = describe_all(sequences, PARAMETERS, SEED)
    # In a second condition of the test, descriptors are nowhere near those of training.
    strange = described + 50 * described.std(axis=0) * np.sin(np.arange(described.shape[1]))
    return sequences, *answer(sequences, described, strange, count=3)


def test_the_answers_are_those_of_pipeline_order_free_and_each_training_sequence_is_held_out_once(
    answered,
):
    sequences, splits, found = answered
    pipeline = pipeline_of("order_free", PARAMETERS, SEED)
    theirs = predict_splits(sequences, pipeline, splits, SEED)
    for split, own, ours in zip(splits, theirs, found, strict=True):
        assert np.array_equal(own.predicted, ours.tested[0].argmax(axis=1))
        assert np.array_equal(np.sort(ours.indices), split.train)
        assert np.allclose(ours.held_out.sum(axis=1), 1)


def test_a_held_out_answer_is_of_a_model_without_its_object():
    # Objects have one descriptor of their own: only a model that met an object could know its class.
    sequences = sequences_of(6, 6)
    _, (one,) = answer(sequences, np.eye(len(sequences.objects))[sequences.object_index])
    right = one.held_out.argmax(axis=1) == sequences.labels[one.indices]
    assert right.mean() <= 0.5


def test_one_training_object_a_class_is_refused():
    sequences = sequences_of(2, 2)
    with pytest.raises(RecognitionError, match="one training object"):
        answer(sequences, np.eye(len(sequences.labels)))


def test_strangeness_is_the_distance_from_the_nearest_training_object_after_scaling():
    sequences = sequences_of(2, 2)
    generator = np.random.default_rng(0)
    described = generator.normal(size=(len(sequences.labels), 3)) * [1, 10, 100]
    train = np.arange(len(described))
    sense = Sense.learn(described, train, sequences)
    scaled = (described - described.mean(axis=0)) / described.std(axis=0)
    centres = [scaled[sequences.object_index == one].mean(axis=0) for one in range(4)]
    expected = [min(np.linalg.norm(row - centre) for centre in centres) for row in scaled]
    np.testing.assert_allclose(sense.strangeness(described), expected)


def test_what_is_strange_is_not_asked_and_what_is_familiar_is(answered):
    sequences, _, found = answered
    for one in found:
        asked = ask_if_familiar(one)
        assert np.allclose(asked.tested[1], 1 / len(sequences.classes))
        kept = one.strange[0] <= one.held_out_strange.max()
        changed = (asked.tested[0] != one.tested[0]).any(axis=1)
        assert changed.sum() <= len(changed) / 2
        assert kept[~changed].all()


def test_two_senses_that_err_alike_make_the_product_no_surer():
    generator = np.random.default_rng(1)
    labels = generator.integers(2, size=400)
    # Each says 80 %, is right in 80 %, and both are right and wrong together.
    right = np.arange(400) % 5 != 0
    said = 0.2 + 0.6 * np.eye(2)[np.where(right, labels, 1 - labels)]
    one = Answered(said[None], said, np.arange(400), np.zeros((1, 400)), np.zeros(400))
    both = multiply(one, one, labels, np.arange(400))
    assert (both.tested[0].argmax(axis=1) == said.argmax(axis=1)).all()
    assert both.tested.max(axis=2).mean() == pytest.approx(0.8, abs=0.02)


def test_a_product_favours_what_neither_sense_rules_out():
    def answer(*probabilities):
        own = np.array([probabilities])
        return Answered(own[None], own, np.arange(1), np.zeros((1, 1)), np.zeros(1))

    first, second = answer(0.8, 0.19, 0.01), answer(0.02, 0.2, 0.78)
    both = multiply(first, second, np.array([1]), np.array([0]))
    assert both.tested[0, 0].argmax() == 1
