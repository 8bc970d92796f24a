"""Adaptive touches: chosen by what is expected of them, from training objects alone."""

from dataclasses import replace

import numpy as np
from recognition.synthetic import features_table

from visuohaptic.recognition.descriptors import POSE
from visuohaptic.recognition.parameters import BestParameters, ProtocolParameters
from visuohaptic.recognition.splits import make_splits
from visuohaptic.studies.curves import choosing
from visuohaptic.studies.curves.choosing import (
    choose_sequences,
    choose_touches,
    expected_entropy,
    fit_touch_model,
    gather_candidates,
    scale_poses,
)
from visuohaptic.tables.phases import CONTOURLET_FEATURES, IMPRINT_FEATURES

PARAMETERS = BestParameters()
NAMES = (*CONTOURLET_FEATURES, *POSE, *IMPRINT_FEATURES, "sensor_size")
TABLE = features_table("adaptive", viewpoints=3, touches=12, separation=1.0)
CANDIDATES = gather_candidates(TABLE, NAMES)
SPLITS = make_splits(CANDIDATES.sequences, ProtocolParameters(), np.random.default_rng(0))
SPLIT = SPLITS[40]
TESTED = np.isin(CANDIDATES.sequence, SPLIT.test)
SKIN = np.array([name not in POSE for name in NAMES])
TOUCHES = 4


def choose(candidates, split=SPLIT, seed=1):
    generator = np.random.default_rng(seed)
    return choose_sequences(candidates, split, TOUCHES, PARAMETERS, 0.2, generator)


def with_altered(rows, columns, alter):
    """Give the candidates with some columns of some rows altered."""
    features = CANDIDATES.features.copy()
    part = np.ix_(np.flatnonzero(rows), columns)
    features[part] = alter(features[part])
    return replace(CANDIDATES, features=features)


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


def test_the_place_is_chosen_whose_imprint_tells_the_classes_apart():
    # At place 1 the two classes feel different; at 0 and 2 alike.
    telling = np.log([[0.9, 0.1], [0.1, 0.9]])
    same = np.log([[0.5, 0.5], [0.5, 0.5]])
    likelihood = np.stack([same, telling, same])
    poses = np.zeros((3, 6))
    poses[:, 0] = [0, 1, 2]
    numbers = np.arange(3)
    one = np.zeros(3, np.int64)
    assert choose_touches(poses, numbers, one, likelihood, one, 3, 0.2).tolist() == [[1, 0, 2]]


def test_touches_keep_apart_until_no_place_is_left():
    poses = np.zeros((4, 6))
    poses[:, 0] = [0, 0.1, 0.15, 1]
    likelihood = np.zeros((4, 2, 2))
    one = np.zeros(4, np.int64)
    chosen = choose_touches(poses, np.arange(4), one, likelihood, one, 6, 0.12)
    # 0 shuts 1; 2 is open, then 3; then what is near, and at last what was touched.
    assert chosen.tolist() == [[0, 2, 3, 1, 0, 1]]


def test_labels_of_test_objects_change_no_choice():
    sequences = CANDIDATES.sequences
    objects = list(sequences.objects)
    tested = np.unique(sequences.object_index[SPLIT.test])
    others = [objects[place][0] for place in np.roll(tested, 1)]
    for place, name in zip(tested, others, strict=True):
        objects[place] = (name, objects[place][1])
    other = replace(CANDIDATES, sequences=replace(sequences, objects=tuple(objects)))
    np.testing.assert_array_equal(choose(CANDIDATES), choose(other))


def test_imprints_of_test_objects_that_were_not_touched_change_no_choice():
    before = choose(CANDIDATES)
    untouched = TESTED.copy()
    untouched[before.reshape(-1)] = False
    assert untouched.sum() > 50
    after = choose(with_altered(untouched, SKIN, lambda _: 1e3))
    np.testing.assert_array_equal(before, after)


def test_imprints_of_test_objects_change_no_choice_in_training():
    before, after = choose(CANDIDATES), choose(with_altered(TESTED, SKIN, lambda _: -7.0))
    np.testing.assert_array_equal(before[SPLIT.train], after[SPLIT.train])
    # The first touch comes before anything was felt.
    np.testing.assert_array_equal(before[SPLIT.test, 0], after[SPLIT.test, 0])
    assert (before[SPLIT.test] != after[SPLIT.test]).any()


def test_poses_of_one_test_object_change_no_choice_on_another():
    places = CANDIDATES.sequences.object_index
    first, second = np.unique(places[SPLIT.test])[:2]
    moved = with_altered(CANDIDATES.owner == first, ~SKIN, lambda poses: 0.5 * poses)
    before, after = choose(CANDIDATES), choose(moved)
    np.testing.assert_array_equal(before[places == second], after[places == second])
    assert (before[places == first] != after[places == first]).any()


def test_imprints_of_training_objects_change_choices():
    reversed_ = with_altered(~TESTED, SKIN, lambda imprints: imprints[::-1])
    assert (choose(CANDIDATES) != choose(reversed_)).any()


def test_the_touches_of_a_training_object_are_chosen_without_it(monkeypatch):
    left_out, likelihood = [], choosing.TouchModel.log_likelihood

    def leave_out(model, poses, place):
        left_out.append(place)
        return likelihood(model, poses, place)

    monkeypatch.setattr(choosing.TouchModel, "log_likelihood", leave_out)
    choose(CANDIDATES)
    training = np.unique(CANDIDATES.sequences.object_index[SPLIT.train])
    assert [place for place in left_out if place != -1] == training.tolist()


def test_a_training_object_is_not_predicted_from_itself():
    model, _ = fit_touch_model(CANDIDATES, SPLIT, PARAMETERS, np.random.default_rng(3))
    place = int(CANDIDATES.sequences.object_index[SPLIT.train[0]])
    poses = CANDIDATES.poses[CANDIDATES.owner == place]
    alone = model.log_likelihood(poses, place)
    kinds = model.kinds.copy()
    kinds[model.owner == place] = 0
    altered = replace(model, kinds=kinds)
    np.testing.assert_array_equal(alone, altered.log_likelihood(poses, place))
    assert (model.log_likelihood(poses, -1) != altered.log_likelihood(poses, -1)).any()


def test_likelihoods_of_a_class_are_a_mean_over_its_objects():
    model, _ = fit_touch_model(CANDIDATES, SPLIT, PARAMETERS, np.random.default_rng(3))
    poses = CANDIDATES.poses[:3]
    scaled = scale_poses(poses, PARAMETERS)
    expected = np.zeros((3, model.words, model.classes))
    for category in range(model.classes):
        objects = [o for o in np.unique(model.owner) if model.class_of_owner[o] == category]
        for o in objects:
            rows = np.flatnonzero(model.owner == o)
            distances = ((scaled[:, None] - model.poses[rows]) ** 2).sum(axis=2)
            for row, kernel in zip(rows, np.exp(-distances / 2).T, strict=True):
                expected[:, model.kinds[row], category] += kernel / len(rows) / len(objects)
    expected = 0.9 * expected + 0.1 * expected.mean(axis=2, keepdims=True)
    found = np.exp(model.log_likelihood(poses, -1)) - choosing.LEAST_LIKELIHOOD
    np.testing.assert_allclose(found, expected, atol=1e-12)


def test_the_only_training_object_of_a_class_is_asked_about_itself():
    table = features_table("adaptive", objects=(2, 2), viewpoints=2, touches=6)
    candidates = gather_candidates(table, NAMES)
    split = make_splits(candidates.sequences, ProtocolParameters(), np.random.default_rng(0))[0]
    chosen = choose_sequences(candidates, split, 3, PARAMETERS, 0.2, np.random.default_rng(1))
    assert np.isfinite(chosen).all()
    model, _ = fit_touch_model(candidates, split, PARAMETERS, np.random.default_rng(3))
    place = int(candidates.sequences.object_index[split.train[0]])
    poses = candidates.poses[:2]
    np.testing.assert_array_equal(
        model.log_likelihood(poses, place), model.log_likelihood(poses, -1)
    )


def test_left_and_right_are_alike():
    poses = np.array([[0.3, 0.1, 0.2, 0.6, 0.0, 0.8]])
    mirrored = poses * [-1, 1, 1, -1, 1, 1]
    np.testing.assert_array_equal(scale_poses(poses, PARAMETERS), scale_poses(mirrored, PARAMETERS))


def test_the_order_of_rows_changes_nothing():
    shuffled = TABLE.take(np.random.default_rng(0).permutation(TABLE.num_rows))
    again = gather_candidates(shuffled, NAMES)
    np.testing.assert_array_equal(again.features, CANDIDATES.features)
    np.testing.assert_array_equal(choose(CANDIDATES), choose(again))
