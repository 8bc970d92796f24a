"""A policy that learns sees nothing of tested objects, and one that finds a way to is caught."""

import numpy as np
import pyarrow as pa
import pytest
from recognition.synthetic import features_table

import visuohaptic as vh
from touch_curves.adaptive import choose_for_splits, learning_rows
from touch_curves.choosing import ADAPTIVE
from touch_curves.study import STUDY as TOUCH_CURVES
from visuohaptic.base.errors import PolicyError, RegistryError
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.descriptors import POSE
from visuohaptic.recognition.parameters import ProtocolParameters
from visuohaptic.recognition.splits import draw_splits
from visuohaptic.studies.conditions import plan_study
from visuohaptic.studies.learning_policies import (
    LEARNING_POLICIES,
    LearningPolicy,
    choose_in_split,
    choose_in_splits,
    gather_candidates,
)
from visuohaptic.tables.phases import CONTOURLET_FEATURES

RUN, TOUCHES = ExperimentParameters(), 3
TABLE = features_table("adaptive", viewpoints=2, touches=6)
CANDIDATES = gather_candidates(TABLE, (*CONTOURLET_FEATURES, *POSE))
SPLITS = draw_splits(CANDIDATES.sequences, ProtocolParameters(), 0)[:4]
OBJECTS = CANDIDATES.sequences.object_index


def next_in_order(places):
    """Choose each viewpoint's candidates in their order."""
    starts = np.searchsorted(places.view, np.arange(places.view[-1] + 1))
    return lambda chosen, _: starts + chosen.shape[1]


def plain(fit=lambda *_: next_in_order, name="plain"):
    return LearningPolicy(name, fit)


def test_lessons_hold_training_objects_only():
    given = []

    def fit(lessons, *_):
        given.append(lessons)
        return next_in_order

    choose_in_split(plain(fit), CANDIDATES, SPLITS[0], TOUCHES, RUN)
    (lessons,) = given
    training = np.unique(OBJECTS[SPLITS[0].train])
    tested = np.setdiff1d(OBJECTS, training)
    assert len(tested)
    assert np.unique(lessons.owner).tolist() == training.tolist()
    assert (lessons.class_of_object[tested] == -1).all()
    known = CANDIDATES.sequences.class_of_object[training]
    np.testing.assert_array_equal(lessons.class_of_object[training], known)
    rows = np.isin(CANDIDATES.sequence, SPLITS[0].train)
    np.testing.assert_array_equal(lessons.features, CANDIDATES.features[rows])


def test_a_policy_sees_poses_before_and_features_after_its_touches_and_no_name():
    seen = []

    def learnt(places):
        choose = next_in_order(places)

        def watch(chosen, felt):
            seen.append((places, chosen, felt))
            return choose(chosen, felt)

        return watch

    chosen = choose_in_split(plain(lambda *_: learnt), CANDIDATES, SPLITS[0], TOUCHES, RUN)
    training = np.unique(OBJECTS[SPLITS[0].train])
    for place, (places, _, felt) in enumerate(seen[TOUCHES - 1 :: TOUCHES]):
        before = chosen[place == OBJECTS][:, : TOUCHES - 1]
        np.testing.assert_array_equal(felt, CANDIDATES.features[before])
        assert places.left_out == (place if place in training else -1)
        assert set(vars(places)) == {"poses", "view", "left_out"}
    assert [felt.shape[:2] for _, _, felt in seen[:TOUCHES]] == [(2, 0), (2, 1), (2, 2)]


def test_a_policy_that_keeps_the_classes_of_objects_from_split_to_split_is_caught():
    """Once trained on an object, it knows the object by its poses where it is tested."""
    classes = {}

    def fit(lessons, *_):
        for owner in np.unique(lessons.owner):
            poses = lessons.poses[lessons.owner == owner]
            classes[poses.tobytes()] = lessons.class_of_object[owner]

        def learnt(places):
            choose, known = next_in_order(places), classes.get(places.poses.tobytes(), 0)
            return lambda chosen, felt: choose(chosen, felt) + known

        return learnt

    leak = plain(fit, "leak")
    with pytest.raises(
        PolicyError, match=r"policy leak chose other touches when split 0 was repeated"
    ):
        choose_in_splits(leak, CANDIDATES, SPLITS, TOUCHES, RUN)
    planned = plan_study(TOUCH_CURVES, RUN).conditions[:1]
    (row,) = pa.concat_tables(learning_rows(leak, TABLE, planned, "paper")).to_pylist()
    assert (row["strategy"], row["accuracy"]) == ("leak", None)
    assert "may remember tested objects" in row["error"]


@pytest.mark.parametrize("policy", [plain(), ADAPTIVE], ids=lambda policy: policy.name)
def test_a_policy_that_learns_in_its_split_only_passes(policy):
    found = choose_in_splits(policy, CANDIDATES, SPLITS, TOUCHES, RUN)
    alone = choose_in_split(policy, CANDIDATES, SPLITS[2], TOUCHES, RUN)
    np.testing.assert_array_equal(found[2], alone)


def fail(*_):
    raise KeyError("imprint")


def fail_silently(*_):
    raise KeyError


@pytest.mark.parametrize(
    ("fit", "sentence"),
    [
        (fail, "learning policy plain, fit: it raised KeyError: 'imprint'."),
        (fail_silently, "learning policy plain, fit: it raised KeyError[.]$"),
        (lambda *_: fail, "learning policy plain, begin: it raised KeyError"),
        (lambda *_: lambda _: fail, "learning policy plain, choose: it raised KeyError"),
        (lambda *_: lambda _: lambda *_: None, r"chose an array of shape \(\) and type object; \(2,\)"),
        (lambda *_: lambda _: lambda *_: [0.0, 6.0], "type float64; .* indices of candidates are needed"),
        (lambda *_: lambda _: lambda *_: [0, 0], r"chose candidates \[0, 0\]; one candidate of each viewpoint"),
        (lambda *_: lambda _: lambda *_: [0, 99], r"chose candidates \[0, 99\]"),
        (lambda *_: lambda _: lambda *_: [-12, 6], r"chose candidates \[-12, 6\]"),
    ],
)  # fmt: skip
def test_a_policy_that_misbehaves_is_one_sentence(fit, sentence):
    with pytest.raises(PolicyError, match=sentence):
        choose_in_split(plain(fit), CANDIDATES, SPLITS[0], TOUCHES, RUN)


def test_a_policy_of_ones_own_is_measured_beside_adaptive(monkeypatch):
    entries = {one.name: one for one in LEARNING_POLICIES}
    monkeypatch.setattr(LEARNING_POLICIES, "_entries", dict(entries))
    vh.register(plain(name="in_order"))
    assert LEARNING_POLICIES.names == ("adaptive", "in_order")
    planned = plan_study(TOUCH_CURVES, RUN).conditions[:2]
    chosen = choose_for_splits(LEARNING_POLICIES["in_order"], TABLE, planned)
    assert len(chosen.splits) == len(chosen.features)
    assert chosen.features[0].shape[:2] == (len(chosen.sequences.object_index), 2)
    for name, sentence in (
        ("random", "a probing strategy has that name"),
        ("adaptive", "each name"),
    ):
        with pytest.raises(RegistryError, match=sentence):
            vh.register(plain(name=name))
