"""Distances between sets of touches are those of the definition, and see what the cues allow."""

import numpy as np
import pytest
from recognition.synthetic import sequences_of

from visuohaptic.recognition.set_distance import POSITION_WEIGHT, keep_touches
from visuohaptic.tables.phases import NORMAL_NAMES, POINT_NAMES

NAMES = ("contourlet_01", *POINT_NAMES, *NORMAL_NAMES, "imprint_mean", "imprint_empty")
OWNERS = np.array([1, 0, 1, 0, 2])
NEW = np.random.default_rng(1).normal(size=(7, len(NAMES)))


def touches():
    sequences = np.random.default_rng(0).normal(size=(5, 4, len(NAMES)))
    sequences[..., -1] = 0.3  # constant
    return sequences


def kept(features, cues):
    return keep_touches(sequences_of(features, NAMES, 0 * OWNERS, OWNERS, classes=1), cues)


def chamfer(one, other):
    found = np.linalg.norm(one[:, None] - other, axis=2)
    return (found.min(axis=0).mean() + found.min(axis=1).mean()) / 2


def test_the_nearest_object_is_found_by_the_mean_of_both_ways():
    sequences = touches()
    known = kept(sequences, {"pose"})
    weighted = [
        known.weights * sequences[owner == OWNERS].reshape(-1, len(NAMES)) for owner in range(3)
    ]
    by_hand = min(chamfer(known.weights * NEW, one) for one in weighted)
    assert known.nearest(NEW) == pytest.approx(by_hand, rel=1e-5)


def test_a_known_object_is_at_no_distance_in_any_order_of_its_touches():
    sequences = touches()
    known = kept(sequences, {"pose"})
    own = sequences[OWNERS == 1].reshape(-1, len(NAMES))
    assert known.nearest(own[::-1]) == pytest.approx(0, abs=1e-3)
    assert known.nearest(own[:3]) > 0.1


def test_positions_normals_and_what_is_felt_have_their_weights():
    sequences = touches()
    weights = kept(sequences, {"embedding"}).weights
    np.testing.assert_array_equal(weights[1:4], POSITION_WEIGHT)
    np.testing.assert_array_equal(weights[4:7], 1)
    deviations = sequences.reshape(-1, len(NAMES)).std(axis=0)
    np.testing.assert_allclose(weights[[0, 7]], 1 / deviations[[0, 7]] / np.sqrt(3))
    assert weights[8] == 0


@pytest.mark.parametrize("cues", [{"contourlet"}, {"azimuth_free"}])
def test_pose_is_not_looked_at_without_a_cue_that_holds_it(cues):
    known = kept(touches(), cues)
    moved = NEW.copy()
    moved[:, 1:7] += 5
    assert known.nearest(moved) == known.nearest(NEW)
