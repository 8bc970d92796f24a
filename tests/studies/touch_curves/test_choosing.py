"""Adaptive touches: chosen by what is expected of them, from training objects alone."""

from dataclasses import replace
from unittest.mock import patch

import numpy as np
import pytest
from recognition.synthetic import features_table

from touch_curves import choosing
from touch_curves.choosing import (
    ADAPTIVE,
    CandidateLikelihoods,
    choose_next,
    expected_entropy,
    fit_touch_model,
    scale_poses,
)
from touch_curves.learning import choose_in_split, gather_candidates, lessons_of
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.descriptors import POSE
from visuohaptic.recognition.parameters import OrderFreeParameters, ProtocolParameters
from visuohaptic.recognition.splits import draw_splits
from visuohaptic.tables.phases import CONTOURLET_FEATURES, IMPRINT_FEATURES

PARAMETERS = OrderFreeParameters()
NAMES = (*CONTOURLET_FEATURES, *POSE, *IMPRINT_FEATURES, "sensor_size")
TABLE = features_table("adaptive", viewpoints=3, touches=12, separation=1.0)
CANDIDATES = gather_candidates(TABLE, NAMES)
SPLIT = draw_splits(CANDIDATES.sequences, ProtocolParameters(), 0)[40]
TESTED = np.isin(CANDIDATES.sequence, SPLIT.test)
SKIN = np.array([name not in POSE for name in NAMES])
TOUCHES = 4


def choose(candidates):
    return choose_in_split(ADAPTIVE, candidates, SPLIT, TOUCHES, ExperimentParameters())


def choose_touches(poses, likelihood, kinds, touches, focus_radius):
    """Choose touches of one viewpoint whose candidates have the given words."""
    likelihoods = CandidateLikelihoods(poses, np.arange(len(poses)), likelihood)
    chosen, view = np.zeros((1, 0), np.int64), np.zeros(len(poses), np.int64)
    for _ in range(touches):
        picked = choose_next(likelihoods, likelihood, view, chosen, kinds[chosen], focus_radius)
        chosen = np.column_stack([chosen, picked])
    return chosen[0]


def test_expected_entropy_is_the_mean_over_outcomes():
    generator = np.random.default_rng(0)
    belief = generator.normal(size=(3, 4)) * 3
    likelihood = generator.normal(size=(5, 6, 4)) * 2
    joint = np.exp(belief[:, None, None] + likelihood)
    joint /= joint.sum(axis=(2, 3), keepdims=True)
    outcome = joint.sum(axis=3)
    posterior = joint / outcome[..., None]
    entropies = -(posterior * np.log(posterior)).sum(axis=3)
    expected = (outcome * entropies).sum(axis=2)
    np.testing.assert_allclose(expected_entropy(belief, likelihood), expected, atol=1e-12)


def test_expected_entropy_is_finite_where_belief_is_certain():
    belief = np.array([[0.0, -5000.0, -5000.0]])
    left = expected_entropy(belief, np.log(np.full((2, 3, 3), 1 / 3)))
    np.testing.assert_allclose(left, 0, atol=1e-12)


def test_touches_keep_apart_until_no_place_is_left():
    poses = np.zeros((4, 6))
    poses[:, 0] = [0, 0.1, 0.15, 1]
    likelihood = np.zeros((4, 2, 2))
    chosen = choose_touches(poses, likelihood, np.zeros(4, np.int64), 6, 0.12)
    # 0 shuts 1; 2 is open, then 3; then what is near, and at last what was touched.
    assert chosen.tolist() == [0, 2, 3, 1, 0, 1]


def test_each_touch_is_the_best_guess_from_the_imprints_before_it():
    generator = np.random.default_rng(2)
    poses, kinds = generator.normal(size=(12, 6)), generator.integers(3, size=12)
    likelihood = np.log(generator.dirichlet(np.ones(3), size=(12, 4))).swapaxes(1, 2)
    chosen = choose_touches(poses, likelihood, kinds, 6, focus_radius=0)
    belief = np.zeros((1, 4))
    for turn, place in enumerate(chosen):
        left = expected_entropy(belief, likelihood)[0]
        left[chosen[:turn]] = np.inf
        assert place == left.argmin()
        belief += likelihood[place, kinds[place]]


CHOSEN = choose(CANDIDATES)
UNTOUCHED = TESTED & ~np.isin(np.arange(len(TESTED)), CHOSEN)
OBJECTS = CANDIDATES.sequences.object_index
FIRST, SECOND = np.unique(OBJECTS[SPLIT.test])[:2]


def test_labels_of_test_objects_change_no_choice():
    tested = np.unique(OBJECTS[SPLIT.test])
    objects = list(CANDIDATES.sequences.objects)
    others = [objects[place][0] for place in np.roll(tested, 1)]
    for place, name in zip(tested, others, strict=True):
        objects[place] = (name, objects[place][1])
    sequences = replace(CANDIDATES.sequences, objects=tuple(objects))
    np.testing.assert_array_equal(choose(replace(CANDIDATES, sequences=sequences)), CHOSEN)


@pytest.mark.parametrize(
    ("rows", "columns", "alter", "same", "other"),
    [
        pytest.param(UNTOUCHED, SKIN, lambda skin: 0 * skin + 1e3, np.s_[:], None, id="what is not touched"),
        # The first touch of a test object comes before anything was felt.
        pytest.param(TESTED, SKIN, lambda skin: 0 * skin - 7, SPLIT.train, SPLIT.test, id="test imprints"),
        pytest.param(TESTED, SKIN, lambda skin: 0 * skin - 7, (SPLIT.test, 0), SPLIT.test, id="first touches"),
        pytest.param(CANDIDATES.owner == FIRST, ~SKIN, lambda poses: 0.5 * poses, OBJECTS == SECOND, OBJECTS == FIRST, id="poses of one test object"),
        pytest.param(~TESTED, SKIN, lambda skin: skin[::-1], np.s_[:0], np.s_[:], id="training imprints"),
    ],
)  # fmt: skip
def test_choices_change_by_what_is_known_alone(rows, columns, alter, same, other):
    features = CANDIDATES.features.copy()
    part = np.ix_(np.flatnonzero(rows), columns)
    features[part] = alter(features[part])
    after = choose(replace(CANDIDATES, features=features))
    np.testing.assert_array_equal(CHOSEN[same], after[same])
    assert other is None or (CHOSEN[other] != after[other]).any()
    assert rows.sum() > 30


def test_the_touches_of_a_training_object_are_chosen_without_it():
    likelihood = choosing.TouchModel.log_likelihood
    with patch.object(
        choosing.TouchModel, "log_likelihood", autospec=True, side_effect=likelihood
    ) as asked:
        choose(CANDIDATES)
    left_out = [call.args[2] for call in asked.call_args_list]
    assert [place for place in left_out if place != -1] == np.unique(OBJECTS[SPLIT.train]).tolist()


@pytest.mark.parametrize("training_objects", [1, 2])
@pytest.mark.parametrize("is_left_out", [True, False])
def test_likelihoods_of_a_class_are_a_mean_over_its_objects_but_one(training_objects, is_left_out):
    """The object that is left out takes no part, unless it is the only one of its class."""
    table = features_table("adaptive", (training_objects + 1,) * 2, viewpoints=2, touches=6)
    candidates = gather_candidates(table, NAMES)
    split = draw_splits(candidates.sequences, ProtocolParameters(), 0)[0]
    lessons = lessons_of(candidates, split)
    model, _ = fit_touch_model(lessons, PARAMETERS, np.random.default_rng(3))
    left_out = int(candidates.sequences.object_index[split.train[0]]) if is_left_out else -1
    poses = candidates.poses[:3]
    scaled = scale_poses(poses, PARAMETERS)
    expected = np.zeros((3, model.words, model.classes))
    for category in range(model.classes):
        objects = [o for o in np.unique(model.owner) if model.class_of_owner[o] == category]
        if training_objects > 1:
            objects = [o for o in objects if o != left_out]
        for o in objects:
            rows = np.flatnonzero(model.owner == o)
            distances = ((scaled[:, None] - model.poses[rows]) ** 2).sum(axis=2)
            for row, kernel in zip(rows, np.exp(-distances / 2).T, strict=True):
                expected[:, model.kinds[row], category] += kernel / len(rows) / len(objects)
    expected = 0.9 * expected + 0.1 * expected.mean(axis=2, keepdims=True)
    found = np.exp(model.log_likelihood(poses, left_out)) - choosing.LEAST_LIKELIHOOD
    np.testing.assert_allclose(found, expected, atol=1e-12)


def test_poses_are_scaled_and_left_and_right_are_alike():
    poses = np.array([[0.3, 0.1, 0.2, 0.6, 0.0, 0.8]])
    scaled = poses / PARAMETERS.wave_length * np.repeat([1, PARAMETERS.normal_weight], 3)
    for one in (poses, poses * [-1, 1, 1, -1, 1, 1]):
        np.testing.assert_allclose(scale_poses(one, PARAMETERS), scaled)


def test_the_order_of_rows_changes_nothing():
    shuffled = TABLE.take(np.random.default_rng(0).permutation(TABLE.num_rows))
    again = gather_candidates(shuffled, NAMES)
    np.testing.assert_array_equal(again.features, CANDIDATES.features)
    np.testing.assert_array_equal(CHOSEN, choose(again))
