"""Split sequences into training and test sequences, so that no object or no viewpoint is in both.

The splitters are scikit-learn cross-validators: pass them as `cv`.
"""

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
    """Training and test sequences of one split.

    Attributes
    ----------
    number : int
        Number of the split within the repeat, from 0.
    repeat : int
        Repeat of the protocol, from 0.
    train, test : ndarray of shape (n_train,) and (n_test,)
        Indices of the sequences, ascending.
    """

    number: int
    repeat: int
    train: IntArray
    test: IntArray


class _GroupSplitter(BaseCrossValidator):  # type: ignore[misc]
    """Base of the splitters: `y` (n,) has the class of each row; rows of equal `groups` (n,) are tested together."""

    def get_n_splits(self, X: Any = None, y: Any = None, groups: Any = None) -> int:  # noqa: ARG002
        """Return the number of splits. `y` and `groups`, both (n,), are required; `X` is not used."""
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
        """Return the test groups of each split."""


class LeaveOneObjectPerClassOut(_GroupSplitter):
    """Test one object of each class per split.

    `split` needs the class of each row as `y` and the object of each row as `groups`.

    Parameters
    ----------
    maximum : int
        Maximum number of splits. All combinations of one object per class are tested if these are at most `maximum`.
        Otherwise `maximum` combinations are drawn, as by `leave_one_out_per_class`.
    random_state : int, Generator or None
        Draws the combinations. An int draws the same combinations at each call.
    """

    def __init__(self, maximum: int = 81, random_state: RandomState = None) -> None:
        self.maximum = maximum
        self.random_state = random_state

    def _test_groups(self, y: Any, groups: Any) -> Sequence[Sequence[Any]]:
        generator = np.random.default_rng(self.random_state)
        return leave_one_out_per_class(_members(y, groups), self.maximum, generator)


class GroupedFolds(_GroupSplitter):
    """Test one fold of whole objects per split, stratified by class.

    `split` needs the class of each row as `y` and the object of each row as `groups`.

    Parameters
    ----------
    folds : int
        Maximum number of folds, which are fewer if no class has so many objects.
    rounds : int
        How often the objects are divided into folds anew. Each object is tested once per round.
    random_state : int, Generator or None
        Draws the folds. An int draws the same folds at each call.
    """

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


class ViewpointFolds(_GroupSplitter):
    """Test one fold of viewpoints per split, over all objects.

    `split` needs the viewpoint number of each row as `groups`. Fold i of n has the sorted viewpoints i, i + n, i + 2 n
    and so on. `split` raises `RecognitionError` if all rows have the same viewpoint.

    Parameters
    ----------
    folds : int
        Maximum number of folds n, which is at most the number of viewpoints.
    """

    def __init__(self, folds: int = 5) -> None:
        self.folds = folds

    def _test_groups(self, y: Any, groups: Any) -> Sequence[Sequence[Any]]:  # noqa: ARG002
        viewpoints = np.unique(groups)
        if len(viewpoints) < 2:
            raise RecognitionError(
                f"All touches are from viewpoint {viewpoints[0]}; protocol new_viewpoint needs at "
                "least two viewpoints."
            )
        folds = min(self.folds, len(viewpoints))
        return [viewpoints[start::folds].tolist() for start in range(folds)]


def make_splitter(
    sizes: Sequence[int], parameters: ProtocolParameters, random_state: RandomState
) -> _GroupSplitter:
    """Return the splitter of a protocol.

    Parameters
    ----------
    sizes : sequence of int
        Number of objects of each class. Protocol ``auto`` chooses its splitter by these.
    parameters : ProtocolParameters
        The protocol and its numbers of splits and folds. `fold_rounds` counts only for protocol ``auto``; protocol
        ``grouped_folds`` has one round.
    random_state : int, Generator or None
        Draws the splits.
    """
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
    """Return the splits of all repeats of a protocol, repeat by repeat.

    Parameters
    ----------
    sequences : TouchSequences
        Sequences to divide.
    parameters : ProtocolParameters
        The protocol and its number of repeats.
    seed : int
        Draws the splits, anew per repeat.

    Raises
    ------
    RecognitionError
        If there are fewer than two classes. In protocol ``new_viewpoint`` also if all sequences have the same
        viewpoint, in other protocols if a class has fewer than two objects.
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
            f"There is one class ({', '.join(sequences.classes)}) with enough objects; at least two classes are needed."
        )


def _check_two_objects(sequences: TouchSequences, members: Sequence[Sequence[int]]) -> None:
    """Raise `RecognitionError` if a class has fewer than two objects."""
    for name, objects in zip(sequences.classes, members, strict=True):
        if len(objects) < 2:
            raise RecognitionError(
                f"Class {name} has one object ({sequences.objects[objects[0]][1]}); at least two "
                f"are needed, one to train and one to test: add another or leave the class out."
            )


def objects_of_classes(sequences: TouchSequences) -> list[list[int]]:
    """Return one list per class of `sequences.classes`: the indices of its objects in `sequences.objects`."""
    of_class = sequences.class_of_object
    return [np.flatnonzero(of_class == index).tolist() for index in range(len(sequences.classes))]


def _members(y: Any, groups: Any) -> list[list[Any]]:
    """Return one sorted list of groups per class, in sorted order of the classes."""
    return [np.unique(groups[y == label]).tolist() for label in np.unique(y)]


def leave_one_out_per_class(
    members: Sequence[Sequence[int]], maximum: int, generator: np.random.Generator
) -> list[tuple[int, ...]]:
    """Return the test objects of each split: one object per class, out of the objects `members` of each class.

    These are all combinations of one object per class, if at most `maximum`. Otherwise `maximum` distinct combinations
    are drawn. Each object of a class is then tested in k or k + 1 splits, with the same k for the whole class.
    """
    if math.prod(len(objects) for objects in members) <= maximum:
        return list(itertools.product(*members))
    columns = [_shuffled_rounds(objects, maximum, generator) for objects in members]
    drawn = list(zip(*columns, strict=True))
    # Independent columns may repeat a combination, most likely if `maximum` is nearly the number of combinations.
    if len(set(drawn)) == maximum:
        return drawn
    return _distinct_combinations(members, maximum, generator)


def _distinct_combinations(
    members: Sequence[Sequence[int]], count: int, generator: np.random.Generator
) -> list[tuple[int, ...]]:
    """Draw `count` distinct combinations of one object per class, with the objects of a class equally often (±1)."""
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
    """Return the objects of each fold, ascending; the folds are stratified by class.

    `members` has the objects of each class. There are at most `folds` folds, and at most as many as objects in the
    largest class. The numbers of objects differ by at most 1 between folds, in total and per class. A class with fewer
    objects than folds is not in every fold.
    """
    return _deal(members, min(folds, max(len(objects) for objects in members)), generator)


def _deal(
    members: Sequence[Sequence[int]], folds: int, generator: np.random.Generator
) -> list[tuple[int, ...]]:
    """Divide the objects of each class over `folds` folds, so that the sizes of folds differ by at most one object."""
    dealt: list[list[int]] = [[] for _ in range(folds)]
    for objects in members:
        # The smallest folds get their objects first, so that sizes differ by at most one object.
        order = sorted(range(folds), key=lambda fold: len(dealt[fold]))
        for turn, index in enumerate(generator.permutation(len(objects))):
            dealt[order[turn % folds]].append(objects[index])
    return [tuple(sorted(objects)) for objects in dealt]


def held_out_folds(
    labels: IntArray, owners: IntArray, folds: int, random_state: RandomState = 0
) -> list[tuple[IntArray, IntArray]]:
    """Return training and held-out indices per fold of whole objects; each training part has all classes.

    If a class has only one object, the object is in every training part and is never held out.

    Parameters
    ----------
    labels, owners : ndarray of shape (n,)
        Class and object of each training sequence.
    folds : int
        Maximum number of folds, at least 2. There are at most as many as objects that can be held out.
    random_state : int, Generator or None
        Draws the folds.

    Returns
    -------
    list of (ndarray, ndarray)
        Indices of the training and of the held-out sequences, both ascending. Empty if every class has one object.
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


def _shuffled_rounds(
    objects: Sequence[int], count: int, generator: np.random.Generator
) -> list[int]:
    """Return `count` objects: round after round of all objects, each round in random order, the last cut short."""
    rounds = math.ceil(count / len(objects))
    order = [generator.permutation(len(objects)) for _ in range(rounds)]
    return [objects[index] for index in np.concatenate(order)[:count]]
