"""Which sequences train and which are tested."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from visuohaptic.base.arrays import BoolArray, IntArray
from visuohaptic.base.errors import RecognitionError
from visuohaptic.recognition.parameters import Protocol, ProtocolParameters
from visuohaptic.recognition.sequences import TouchSequences


@dataclass(frozen=True)
class Split:
    """One division of the sequences: its number, from 0, and the places of either part, ascending."""

    number: int
    train: IntArray
    test: IntArray


def make_splits(
    sequences: TouchSequences, parameters: ProtocolParameters, generator: np.random.Generator
) -> list[Split]:
    """Divide the sequences as the protocol says.

    Raises `RecognitionError` if there are fewer than two classes, or a class has too few objects or
    an object too few viewpoints.
    """
    check_two_classes(sequences)
    if parameters.protocol == "new_viewpoint":
        return _viewpoint_splits(sequences, parameters.folds)
    members = objects_of_classes(sequences)
    for name, objects in zip(sequences.classes, members, strict=True):
        if len(objects) < 2:
            raise RecognitionError(
                f"Class {name} has one object ({sequences.objects[objects[0]][1]}); at least two "
                f"are needed, one to train and one to test: add another or leave the class out."
            )
    if settled_protocol([len(objects) for objects in members], parameters) == "grouped_folds":
        rounds = parameters.fold_rounds if parameters.protocol == "auto" else 1
        tested = [
            objects
            for _ in range(rounds)
            for objects in grouped_folds(members, parameters.folds, generator)
        ]
    else:
        tested = leave_one_out_a_class(members, parameters.maximum_splits, generator)
    return [
        _split(number, np.isin(sequences.object_index, objects))
        for number, objects in enumerate(tested)
    ]


def settled_protocol(sizes: Sequence[int], parameters: ProtocolParameters) -> Protocol:
    """Give the protocol that is run for classes of so many objects; only `auto` depends on these."""
    if parameters.protocol != "auto":
        return parameters.protocol
    fit = math.prod(sizes) <= parameters.maximum_splits
    return "leave_one_object_a_class_out" if fit else "grouped_folds"


def check_two_classes(sequences: TouchSequences) -> None:
    """Raise `RecognitionError` where there is nothing to distinguish."""
    if len(sequences.classes) < 2:
        raise RecognitionError(
            f"There is one class ({', '.join(sequences.classes)}); at least two are needed to "
            f"distinguish them."
        )


def objects_of_classes(sequences: TouchSequences) -> list[list[int]]:
    """Give the places of each class's objects, classes in their order."""
    of_class = sequences.class_of_object
    return [np.flatnonzero(of_class == place).tolist() for place in range(len(sequences.classes))]


def leave_one_out_a_class(
    members: Sequence[Sequence[int]], maximum: int, generator: np.random.Generator
) -> list[tuple[int, ...]]:
    """Choose one test object of each class, in all combinations: the test objects of each split.

    Of more combinations than `maximum`, distinct ones are drawn, each object of a class as often as
    any other, or once more.
    """
    if math.prod(len(objects) for objects in members) <= maximum:
        return list(itertools.product(*members))
    # The objects of a class take turns in a shuffled order; of few left out some may meet twice.
    turns = [_turns(objects, maximum, generator) for objects in members]
    drawn = list(zip(*turns, strict=True))
    if len(set(drawn)) == maximum:
        return drawn
    return _distinct_combinations(members, maximum, generator)


def _distinct_combinations(
    members: Sequence[Sequence[int]], count: int, generator: np.random.Generator
) -> list[tuple[int, ...]]:
    """Draw distinct combinations of an object of each class, each object as often or once more."""
    # From a drawn combination all classes go on to their next object together, until it would come
    # again: a cycle that has the objects of a class equally often, and no combination of another.
    sizes = [len(objects) for objects in members]
    chosen: dict[tuple[int, ...], None] = {}
    while len(chosen) < count:
        orders = [generator.permutation(size).tolist() for size in sizes]
        start = next(places for places in itertools.product(*orders) if places not in chosen)
        for turn in range(min(math.lcm(*sizes), count - len(chosen))):
            chosen[
                tuple((place + turn) % size for place, size in zip(start, sizes, strict=True))
            ] = None
    return [
        tuple(objects[place] for objects, place in zip(members, places, strict=True))
        for places in chosen
    ]


def grouped_folds(
    members: Sequence[Sequence[int]], folds: int, generator: np.random.Generator
) -> list[tuple[int, ...]]:
    """Deal the objects of each class over folds, at most as many as the largest class has objects."""
    folds = min(folds, max(len(objects) for objects in members))
    dealt: list[list[int]] = [[] for _ in range(folds)]
    for objects in members:
        # The fullest folds come last, so sizes differ by one object at most.
        order = sorted(range(folds), key=lambda fold: len(dealt[fold]))
        for turn, place in enumerate(generator.permutation(len(objects))):
            dealt[order[turn % folds]].append(objects[place])
    return [tuple(sorted(objects)) for objects in dealt]


def hold_out_objects(
    labels: IntArray, owners: IntArray, folds: int, generator: np.random.Generator
) -> Iterator[tuple[BoolArray, list[int]]]:
    """Deal objects over folds: which sequences, (n,), the other folds have, and the fold's objects.

    `labels` and `owners` (n,) are the sequences' classes and objects. Those of two classes at least
    train; the fold's objects are of these, one at least. There is no fold where no class has a
    second object.
    """
    members = [np.unique(owners[labels == place]).tolist() for place in np.unique(labels)]
    if max(len(objects) for objects in members) < 2:
        return
    for objects in grouped_folds(members, folds, generator):
        train = ~np.isin(owners, objects)
        classes = np.unique(labels[train])
        known = [place for place in objects if labels[owners == place][0] in classes]
        if known and len(classes) > 1:
            yield train, known


def _turns(objects: Sequence[int], count: int, generator: np.random.Generator) -> list[int]:
    rounds = math.ceil(count / len(objects))
    order = [generator.permutation(len(objects)) for _ in range(rounds)]
    return [objects[place] for place in np.concatenate(order)[:count]]


def _viewpoint_splits(sequences: TouchSequences, folds: int) -> list[Split]:
    """Test every folds-th viewpoint of known objects."""
    viewpoints = np.unique(sequences.viewpoint)
    if len(viewpoints) < 2:
        raise RecognitionError(
            "The objects have one viewpoint; protocol new_viewpoint needs at least two."
        )
    folds = min(folds, len(viewpoints))
    fold = np.searchsorted(viewpoints, sequences.viewpoint) % folds
    return [_split(number, fold == number) for number in range(folds)]


def _split(number: int, tested: BoolArray) -> Split:
    return Split(number, np.flatnonzero(~tested), np.flatnonzero(tested))
