"""Who trains and who is tested."""

import itertools
from collections import Counter

import numpy as np
import pytest
from recognition.synthetic import PAPER_FEATURES, features_table
from sklearn.dummy import DummyClassifier
from sklearn.model_selection import cross_val_score

from visuohaptic.base.errors import RecognitionError
from visuohaptic.recognition.parameters import ProtocolParameters
from visuohaptic.recognition.sequences import gather_sequences
from visuohaptic.recognition.splits import (
    GroupedFolds,
    LeaveOneObjectPerClassOut,
    draw_splits,
    grouped_folds,
    held_out_folds,
    leave_one_out_per_class,
)


def splits_of(objects, viewpoints=2, seed=0, **settings):
    sequences = gather_sequences(
        features_table(objects=objects, viewpoints=viewpoints), PAPER_FEATURES, 5
    )
    return sequences, draw_splits(sequences, ProtocolParameters(**settings), seed)


@pytest.mark.parametrize("protocol", ["auto", "leave_one_object_a_class_out", "grouped_folds"])
@pytest.mark.parametrize("objects", [(2, 2), (3, 3, 3), (2, 5, 3), (4, 9)])
def test_no_object_trains_and_is_tested(protocol, objects):
    sequences, splits = splits_of(objects, protocol=protocol)
    for split in splits:
        train = set(sequences.object_index[split.train])
        test = set(sequences.object_index[split.test])
        assert not train & test
        assert len(train | test) == len(sequences.objects)
        assert set(sequences.labels[split.train]) == set(range(len(objects)))


def places_tested(sequences, split):
    return tuple(np.unique(sequences.object_index[split.test]).tolist())


def members_of(sizes):
    ends = np.cumsum(sizes)
    return [list(range(end - size, end)) for size, end in zip(sizes, ends, strict=True)]


@pytest.mark.parametrize("objects", [(2, 2), (3, 4), (11, 7, 13)])
def test_grouped_folds_test_every_object_once_and_are_even(objects):
    members = members_of(objects)
    folds = grouped_folds(members, 5, np.random.default_rng(1))
    assert sorted(place for fold in folds for place in fold) == list(range(sum(objects)))
    for group in (range(sum(objects)), *members):
        shares = [len(set(fold) & set(group)) for fold in folds]
        assert max(shares) - min(shares) <= 1


def places_of_tests(splits):
    return [split.test.tolist() for split in splits]


@pytest.mark.parametrize("objects", [(3, 3, 3, 3), (2, 2), (9, 9)])
def test_auto_takes_all_combinations_where_they_fit_and_draws_nothing(objects):
    sequences, splits = splits_of(objects, protocol="leave_one_object_a_class_out")
    generator = np.random.default_rng(4)
    splitter = LeaveOneObjectPerClassOut(81, generator)
    assert splitter.get_n_splits(None, sequences.labels, sequences.object_index) == len(splits)
    assert generator.random() == np.random.default_rng(4).random()
    auto = draw_splits(sequences, ProtocolParameters(), 4)
    assert places_of_tests(auto) == places_of_tests(splits)
    tested = [places_tested(sequences, split) for split in auto]
    assert len(set(tested)) == len(tested) == np.prod(objects)
    for places in tested:
        assert sequences.class_of_object[[*places]].tolist() == list(range(len(objects)))


# 142 objects in twelve classes, the paper's with one own object, and classes of uneven sizes.
@pytest.mark.parametrize(
    "objects", [(10, 8, 16, 11, 15, 12, 12, 12, 13, 10, 13, 10), (4, 3, 3, 3), (2, 41), (2,) * 7]
)
def test_auto_tests_every_object_of_larger_sets_equally_often(objects):
    sequences, splits = splits_of(objects, viewpoints=1)
    assert [split.number for split in splits] == list(range(3 * min(5, max(objects))))
    tests = Counter(place for split in splits for place in places_tested(sequences, split))
    assert tests == dict.fromkeys(range(sum(objects)), 3)


def test_rounds_of_folds_are_drawn_anew_and_the_first_is_that_of_grouped_folds():
    objects = (10, 12, 20)
    auto = places_of_tests(splits_of(objects, seed=3)[1])
    first, second, third = (auto[start : start + 5] for start in (0, 5, 10))
    assert first == places_of_tests(splits_of(objects, seed=3, protocol="grouped_folds")[1])
    assert not {tuple(fold) for fold in first} & {tuple(fold) for fold in (*second, *third)}
    assert places_of_tests(splits_of(objects, seed=3)[1]) == auto
    assert places_of_tests(splits_of(objects, seed=4)[1]) != auto
    assert len(splits_of(objects, fold_rounds=1)[1]) == 5


@pytest.mark.parametrize(
    ("sizes", "maximum", "settled"),
    [
        ((3, 3, 3, 3), 81, "leave_one_object_a_class_out"),
        ((3, 3, 3, 3), 80, "grouped_folds"),
        ((4, 3, 3, 3), 81, "grouped_folds"),
        ((4, 3, 3, 3), 108, "leave_one_object_a_class_out"),
    ],
)
def test_auto_turns_to_folds_above_the_most_combinations(sizes, maximum, settled):
    assert ProtocolParameters(maximum_splits=maximum).resolve(sizes) == settled
    named = ProtocolParameters(protocol="new_viewpoint", maximum_splits=maximum)
    assert named.resolve(sizes) == "new_viewpoint"


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    ("sizes", "maximum"),
    [
        ((4, 3, 3, 3), 81), ((4, 3, 3, 3), 107), ((3, 3, 3, 3), 80), ((12, 12), 81), ((5, 2), 9),
        ((4, 6, 9), 211), ((2, 2, 2, 2, 2, 2, 2), 127), ((7, 12), 81), ((1, 100), 81), ((4, 4), 3),
        ((12,) * 12, 36),
    ],
)  # fmt: skip
def test_few_combinations_are_sampled_distinct_and_balanced(sizes, maximum, seed):
    members = members_of(sizes)
    chosen = leave_one_out_per_class(members, maximum, np.random.default_rng(seed))
    assert len(set(chosen)) == len(chosen) == maximum
    for tested, objects in zip(zip(*chosen, strict=True), members, strict=True):
        counts = [tested.count(place) for place in objects]
        assert sum(counts) == maximum
        assert max(counts) - min(counts) <= 1


def test_where_no_combination_comes_twice_each_draw_is_kept():
    members = members_of((9,) * 5)
    chosen = leave_one_out_per_class(members, 12, np.random.default_rng(2))
    assert (chosen[0], chosen[-1]) == ((2, 11, 20, 33, 41), (7, 12, 18, 32, 37))


def test_pairs_of_objects_of_two_classes_are_tested_together_in_many_ways():
    chosen = leave_one_out_per_class(members_of((3,) * 5), 81, np.random.default_rng(0))
    for first, second in itertools.combinations(zip(*chosen, strict=True), 2):
        assert len(set(zip(first, second, strict=True))) == 9


def test_new_viewpoint_keeps_every_object_in_training_and_no_viewpoint_in_both():
    sequences, splits = splits_of((2, 3), viewpoints=16, protocol="new_viewpoint", folds=4)
    assert len(splits) == 4
    for split in splits:
        assert not set(sequences.viewpoint[split.train]) & set(sequences.viewpoint[split.test])
        assert set(sequences.object_index[split.train]) == set(range(5))


@pytest.mark.parametrize(
    ("objects", "settings", "sentence"),
    [
        ((3, 1, 2), {}, r"Class class1 has one object \(object0\)"),
        ((3,), {}, r"one class \(class0\) with enough objects; at least two"),
        ((2, 2), {"viewpoints": 1, "protocol": "new_viewpoint"}, "at least two"),
    ],
)
def test_what_can_not_be_divided_is_named(objects, settings, sentence):
    with pytest.raises(RecognitionError, match=sentence):
        splits_of(objects, **settings)


def test_repeats_are_numbered_and_drawn_anew():
    _, splits = splits_of((6, 6), protocol="grouped_folds", folds=2, repeats=2)
    assert [(split.repeat, split.number) for split in splits] == [(0, 0), (0, 1), (1, 0), (1, 1)]
    assert splits[0].test.tolist() != splits[2].test.tolist()


@pytest.mark.parametrize("objects", [(2, 2), (2, 5, 3)])
def test_held_out_folds_hold_whole_objects_and_train_every_class(objects):
    labels = np.repeat(np.repeat(np.arange(len(objects)), objects), 4)
    owners = np.repeat(np.arange(sum(objects)), 4)
    folds = held_out_folds(labels, owners, 3)
    held_out = np.concatenate([part for _, part in folds])
    assert sorted(held_out.tolist()) == list(range(len(labels)))
    for train, part in folds:
        assert not {*owners[train]} & {*owners[part]}
        assert {*labels[train]} == {*labels}


def test_the_only_object_of_a_class_is_never_held_out():
    labels, owners = np.array([0, 0, 1, 1]), np.array([0, 1, 2, 2])
    held_out = [part.tolist() for _, part in held_out_folds(labels, owners, 3)]
    assert sorted(held_out) == [[0], [1]]
    assert held_out_folds(labels[1:], owners[1:], 3) == []


def test_a_splitter_serves_scikit_learn():
    classes = np.repeat(["cup", "lamp"], 12)
    objects = np.repeat(np.arange(8), 3)
    scores = cross_val_score(
        DummyClassifier(strategy="most_frequent"), np.zeros((24, 1)), classes,
        groups=objects, cv=GroupedFolds(4, random_state=0),
    )  # fmt: skip
    assert scores.tolist() == [0.5] * 4
