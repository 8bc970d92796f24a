"""Split sequences into training and test sequences by splitters of scikit-learn's kind that keep objects whole."""

from __future__ import annotations

import itertools
import math
from abc import abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from sklearn.model_selection import BaseCrossValidator

from visuohaptic.base.arrays import BoolArray, IntArray
from visuohaptic.base.errors import RecognitionError
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.recognition.parameters import ProtocolParameters
from visuohaptic.recognition.sequences import TouchSequences

RandomState = int | np.random.Generator | None


@dataclass(frozen=True)
class Split:
    """One division of the sequences: indices of training and test sequences, ascending.

    `number` counts from 0 within each `repeat` of the protocol.
    """

    number: int
    repeat: int
    train: IntArray
    test: IntArray


class _ObjectSplitter(BaseCrossValidator):  # type: ignore[misc]
    """Base of splitters that test whole groups: `y` (n,) is the class of each row, `groups` (n,) the object."""

    def get_n_splits(self, X: Any = None, y: Any = None, groups: Any = None) -> int:  # noqa: ARG002
        """Return the number of splits for these classes and objects."""
        return len(self._test_groups(np.asarray(y), np.asarray(groups)))

    def _iter_test_masks(
        self,
        X: Any = None,  # noqa: ARG002
        y: Any = None,
        groups: Any = None,
    ) -> Iterator[BoolArray]:
        for tested in self._test_groups(np.asarray(y), np.asarray(groups)):
            yield np.isin(groups, tested)

    @abstractmethod
    def _test_groups(self, y: Any, groups: Any) -> Sequence[Sequence[Any]]:
        """Return the tested groups of each split."""


class LeaveOneObjectPerClassOut(_ObjectSplitter):
    """Tests one object of each class, in all combinations, or in a balanced sample of `maximum` combinations."""

    def __init__(self, maximum: int = 81, random_state: RandomState = None) -> None:
        self.maximum = maximum
        self.random_state = random_state

    def _test_groups(self, y: Any, groups: Any) -> Sequence[Sequence[Any]]:
        generator = np.random.default_rng(self.random_state)
        return leave_one_out_per_class(_members(y, groups), self.maximum, generator)


class GroupedFolds(_ObjectSplitter):
    """Folds of whole objects, stratified by class; each object is tested once per round."""

    def __init__(self, folds: int = 5, rounds: int = 1, random_state: RandomState = None) -> None:
        self.folds = folds
        self.rounds = rounds
        self.random_state = random_state

    def _test_groups(self, y: Any, groups: Any) -> Sequence[Sequence[Any]]:
        generator, members = np.random.default_rng(self.random_state), _members(y, groups)
        return [
            objects
            for _ in range(self.rounds)
            for objects in grouped_folds(members, self.folds, generator)
        ]


class ViewpointFolds(_ObjectSplitter):
    """Folds of viewpoints, which are the `groups`: every n-th viewpoint is tested together."""

    def __init__(self, folds: int = 5) -> None:
        self.folds = folds

    def _test_groups(self, y: Any, groups: Any) -> Sequence[Sequence[Any]]:  # noqa: ARG002
        viewpoints = np.unique(groups)
        if len(viewpoints) < 2:
            raise RecognitionError(
                "The objects have one viewpoint; protocol new_viewpoint needs at least two."
            )
        folds = min(self.folds, len(viewpoints))
        return [viewpoints[start::folds].tolist() for start in range(folds)]


def make_splitter(
    sizes: Sequence[int], parameters: ProtocolParameters, random_state: RandomState
) -> _ObjectSplitter:
    """Return the splitter of a protocol for classes with `sizes` objects."""
    protocol = parameters.resolve(sizes)
    if protocol == "new_viewpoint":
        return ViewpointFolds(parameters.folds)
    if protocol == "grouped_folds":
        rounds = parameters.fold_rounds if parameters.protocol == "auto" else 1
        return GroupedFolds(parameters.folds, rounds, random_state)
    return LeaveOneObjectPerClassOut(parameters.maximum_splits, random_state)


def draw_splits(
    sequences: TouchSequences, parameters: ProtocolParameters, seed: int
) -> list[Split]:
    """Divide sequences into training and test sequences: all splits of all repeats.

    Raises `RecognitionError` if there are fewer than two classes, or a class has too few objects or an object too few
    viewpoints.
    """
    check_two_classes(sequences)
    members = objects_of_classes(sequences)
    by_viewpoint = parameters.protocol == "new_viewpoint"
    if not by_viewpoint:
        _check_two_objects(sequences, members)
    groups = sequences.viewpoint if by_viewpoint else sequences.object_index
    splits = []
    for repeat in range(parameters.repeats):
        generator = spawn_generator(seed, "recognition", "splits", repeat)
        splitter = make_splitter([len(objects) for objects in members], parameters, generator)
        divided = splitter.split(sequences.features, sequences.labels, groups)
        splits += [Split(number, repeat, *parts) for number, parts in enumerate(divided)]
    return splits


def check_two_classes(sequences: TouchSequences) -> None:
    """Raise `RecognitionError` if there are fewer than two classes."""
    if len(sequences.classes) < 2:
        raise RecognitionError(
            f"There is one class ({', '.join(sequences.classes)}); at least two classes are needed."
        )


def _check_two_objects(sequences: TouchSequences, members: Sequence[Sequence[int]]) -> None:
    for name, objects in zip(sequences.classes, members, strict=True):
        if len(objects) < 2:
            raise RecognitionError(
                f"Class {name} has one object ({sequences.objects[objects[0]][1]}); at least two "
                f"are needed, one to train and one to test: add another or leave the class out."
            )


def objects_of_classes(sequences: TouchSequences) -> list[list[int]]:
    """Return the indices of each class's objects, in the order of the classes."""
    of_class = sequences.class_of_object
    return [np.flatnonzero(of_class == index).tolist() for index in range(len(sequences.classes))]


def _members(y: Any, groups: Any) -> list[list[Any]]:
    """Return the groups of each class, both sorted."""
    return [np.unique(groups[y == label]).tolist() for label in np.unique(y)]


def leave_one_out_per_class(
    members: Sequence[Sequence[int]], maximum: int, generator: np.random.Generator
) -> list[tuple[int, ...]]:
    """Return the test objects of each split: one object of each class, in all combinations.

    If there are more combinations than `maximum`, distinct combinations are drawn. Each object of a class is drawn as
    often as any other object of the class, or once more.
    """
    if math.prod(len(objects) for objects in members) <= maximum:
        return list(itertools.product(*members))
    # The objects of a class take turns in shuffled order. If few combinations are left out, some may repeat.
    turns = [_turns(objects, maximum, generator) for objects in members]
    drawn = list(zip(*turns, strict=True))
    if len(set(drawn)) == maximum:
        return drawn
    return _distinct_combinations(members, maximum, generator)


def _distinct_combinations(
    members: Sequence[Sequence[int]], count: int, generator: np.random.Generator
) -> list[tuple[int, ...]]:
    """Draw distinct combinations of one object per class; objects of a class are drawn equally often, or once more."""
    # All classes advance to their next object together, until the first combination would repeat. Such a cycle has
    # the objects of a class equally often, and shares no combination with another cycle.
    sizes = [len(objects) for objects in members]
    chosen: dict[tuple[int, ...], None] = {}
    while len(chosen) < count:
        orders = [generator.permutation(size).tolist() for size in sizes]
        start = next(indices for indices in itertools.product(*orders) if indices not in chosen)
        for turn in range(min(math.lcm(*sizes), count - len(chosen))):
            chosen[
                tuple((index + turn) % size for index, size in zip(start, sizes, strict=True))
            ] = None
    return [
        tuple(objects[index] for objects, index in zip(members, indices, strict=True))
        for indices in chosen
    ]


def grouped_folds(
    members: Sequence[Sequence[int]], folds: int, generator: np.random.Generator
) -> list[tuple[int, ...]]:
    """Return folds of whole objects, stratified by class.

    `members` are the objects of each class. There are at most as many folds as objects in the largest class.
    """
    return _deal(members, min(folds, max(len(objects) for objects in members)), generator)


def _deal(
    members: Sequence[Sequence[int]], folds: int, generator: np.random.Generator
) -> list[tuple[int, ...]]:
    dealt: list[list[int]] = [[] for _ in range(folds)]
    for objects in members:
        # The largest folds come last, so that sizes differ by at most one object.
        order = sorted(range(folds), key=lambda fold: len(dealt[fold]))
        for turn, index in enumerate(generator.permutation(len(objects))):
            dealt[order[turn % folds]].append(objects[index])
    return [tuple(sorted(objects)) for objects in dealt]


def held_out_folds(
    labels: IntArray, owners: IntArray, folds: int, random_state: RandomState = 0
) -> list[tuple[IntArray, IntArray]]:
    """Return (training indices, held-out indices) for folds of whole objects in which every class is trained.

    The only object of a class trains in every fold. The list is empty if every class has one object.

    Parameters
    ----------
    labels, owners : ndarray of shape (n,)
        Class and object of each training sequence.
    """
    lonely = [label for label in np.unique(labels) if len(np.unique(owners[labels == label])) < 2]
    candidates = np.flatnonzero(~np.isin(labels, lonely))
    if not len(candidates):
        return []
    members = _members(labels[candidates], owners[candidates])
    folds = min(folds, sum(len(objects) for objects in members))
    dealt = _deal(members, folds, np.random.default_rng(random_state))
    masks = [np.isin(owners, objects) for objects in dealt]
    return [(np.flatnonzero(~mask), np.flatnonzero(mask)) for mask in masks]


def _turns(objects: Sequence[int], count: int, generator: np.random.Generator) -> list[int]:
    rounds = math.ceil(count / len(objects))
    order = [generator.permutation(len(objects)) for _ in range(rounds)]
    return [objects[index] for index in np.concatenate(order)[:count]]
