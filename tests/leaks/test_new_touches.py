"""Protocol `new_touches`: no turn and no touch of the test reaches training."""

from dataclasses import replace

import numpy as np
import pytest
from studies.known_objects.made_up import gathered, turned_touches

from known_objects.new_touches import (
    Turned,
    answer_new_touches,
    classify_splits,
    split_turns,
)
from visuohaptic.base.errors import RecognitionError
from visuohaptic.geometry.turning import draw_rotation
from visuohaptic.recognition.splits import Split
from visuohaptic.tables.phases import POINT_NAMES
from visuohaptic.tables.schema import matrix

TURNED = turned_touches(objects=3, turns=4, separation=0.5)
SEQUENCES = gathered(TURNED)
PARAMETERS = TURNED[0].parameters.recognition
SPLITS = split_turns(SEQUENCES, 0)


def test_each_turn_of_each_object_is_tested_once_and_never_trains_then():
    owners = SEQUENCES.object_index
    for split in SPLITS:
        assert not set(owners[split.train]) & set(owners[split.test])
        # All objects train, each in its other turns.
        assert set(SEQUENCES.labels[split.train]) == set(range(3))
        assert len(split.train) + len(split.test) == len(owners)
    tested = np.concatenate([split.test for split in SPLITS])
    assert sorted(tested) == list(range(len(owners)))


def last_answers(split, noisy):
    """Return the probabilities of the test sequences that are not noisy, after two touches."""
    values = SEQUENCES.features[:, :2].copy()
    values[noisy] = np.random.default_rng(0).normal(scale=10, size=values[noisy].shape)
    sequences = replace(SEQUENCES, features=values)
    found = classify_splits(sequences, [split], PARAMETERS, 0)[-1]
    return found[np.setdiff1d(split.test, noisy)]


def test_noise_in_place_of_some_test_touches_changes_no_other_answer():
    split = SPLITS[1]
    noisy = split.test[::2]
    np.testing.assert_array_equal(last_answers(split, noisy), last_answers(split, [])[1::2])


def test_a_test_turn_that_trains_is_noticed():
    split = SPLITS[1]
    noisy = split.test[::2]
    leaking = Split(0, 0, np.sort(np.append(split.train, noisy)), split.test)
    assert not np.array_equal(last_answers(leaking, noisy), last_answers(leaking, [])[1::2])


def test_a_training_touch_at_a_tested_point_is_refused():
    key = "class1/object0"
    learnt, tested = TURNED[0], TURNED[2]
    points = []
    for one, sign in ((learnt, 1), (tested, -1)):
        meshes = one.parameters.meshes
        rotation = draw_rotation(meshes.turns, key, one.parameters.seed, meshes.turn_draw)
        points.append(rotation if sign > 0 else rotation.T)
    # The point of the first touch, in the object's own pose and then in the other turn.
    is_key = np.array(learnt.features["class"].to_pylist()) == "class1"
    row = int(is_key.argmax())
    point = matrix(learnt.features, POINT_NAMES)[row] @ points[0] @ points[1]
    features = tested.features
    for name, value in zip(POINT_NAMES, point, strict=True):
        index = features.column_names.index(name)
        values = features.column(name).to_numpy().copy()
        values[row] = value
        features = features.set_column(index, features.schema.field(index), [values])
    planted = [*TURNED]
    planted[2] = Turned(features, tested.parameters)
    with pytest.raises(
        RecognitionError, match=f"{key} was touched by fixation at the same point in turns 0 and 2"
    ):
        answer_new_touches(planted, "fixation", 0)


def test_a_turn_given_twice_is_refused():
    with pytest.raises(RecognitionError, match="at the same point in turns"):
        answer_new_touches([*TURNED[:3], TURNED[0]], "fixation", 0)
