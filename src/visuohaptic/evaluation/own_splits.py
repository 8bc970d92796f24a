"""Choose the splits of an evaluation: all or some splits of the protocol, or splits of the caller."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from typing import Any, TypeGuard

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import BoolArray, IntArray, masked_fault
from visuohaptic.base.errors import ParameterError, RecognitionError
from visuohaptic.evaluation.wording import reason_of, short
from visuohaptic.recognition.parameters import ProtocolParameters
from visuohaptic.recognition.sequences import TouchSequences
from visuohaptic.recognition.splits import (
    Split,
    check_two_classes,
    draw_splits,
    objects_of_classes,
)

Splits = int | Iterable[Collection[str]] | Any | None


def choose_splits(
    sequences: TouchSequences, protocol: ProtocolParameters, seed: int, splits: Splits
) -> list[Split]:
    """Split sequences into training and test sequences, as argument `splits` of `evaluating.evaluate` says.

    `protocol` and `seed` are the experiment's.

    Returns
    -------
    list of Split
        Sorted sequence indices of each split.

    Raises
    ------
    ParameterError
        If `splits` has another type, is empty or below 1, or contains an object that was not touched.
    RecognitionError
        If there are fewer than two classes, or `draw_splits` refuses the protocol. Also if a splitter fails or returns
        something else than indices or masks of sequences, or if a split has no test object, trains and tests the same
        object, or tests a class that has no training object.
    """
    if splits is None:
        return draw_splits(sequences, protocol, seed)
    if is_whole(splits):
        return _first_splits(sequences, protocol, seed, int(splits))
    check_two_classes(sequences)
    pairs: Iterable[tuple[IntArray, IntArray]]
    if hasattr(splits, "get_n_splits"):
        pairs = _by_splitter(sequences, splits)
    elif isinstance(splits, Iterable) and not isinstance(splits, str | bytes):
        pairs = _by_objects(sequences, splits)
    else:
        raise ParameterError(
            f"splits is of type {type(splits).__name__}; a whole number, a list of the test objects of each split, "
            "or a scikit-learn splitter is needed."
        )
    chosen = [Split(number, 0, *map(np.sort, pair)) for number, pair in enumerate(pairs)]
    if not chosen:
        raise ParameterError("splits is empty; at least one split is needed.")
    for split in chosen:
        _check(sequences, split)
    return chosen


def is_whole(value: Any) -> TypeGuard[int]:
    """Return whether a value is a whole number, of Python or NumPy. True and False do not count."""
    return isinstance(value, int | np.integer) and not isinstance(value, bool)


def _first_splits(
    sequences: TouchSequences, protocol: ProtocolParameters, seed: int, count: int
) -> list[Split]:
    if count < 1:
        raise ParameterError(f"splits is {count}; a whole number above 0 is needed.")
    resolved = protocol.resolve([len(objects) for objects in objects_of_classes(sequences)])
    if resolved == "leave_one_object_a_class_out":
        most = min(count, protocol.maximum_splits)
        sampled = {"protocol": resolved, "maximum_splits": most}
        protocol = protocol.model_copy(update=sampled)
    return draw_splits(sequences, protocol, seed)[:count]


def _by_splitter(sequences: TouchSequences, splitter: Any) -> Iterator[tuple[IntArray, IntArray]]:
    count = len(sequences.labels)
    try:
        parts = splitter.split(sequences.features, sequences.labels, sequences.object_index)
        # A masked array stays one, so that `_indices` refuses its mask.
        pairs = [(np.asanyarray(train), np.asanyarray(test)) for train, test in parts]
    # A splitter may raise any exception.
    except Exception as error:
        raise RecognitionError(
            f"{short(splitter)} can't divide the objects: {reason_of(error)}."
        ) from error
    for number, (train, test) in enumerate(pairs):
        yield (
            _indices(train, count, f"Split {number} has training"),
            _indices(test, count, f"Split {number} has test"),
        )


def _indices(given: NDArray[Any], count: int, start: str) -> IntArray:
    """Return the indices that a splitter gave, as such or as a mask of `count` sequences; `start` begins errors."""
    if fault := masked_fault(given):
        raise RecognitionError(f"{start} indices with {fault}.")
    if given.dtype == bool and given.shape == (count,):
        return np.flatnonzero(given)
    end = f"; whole numbers from 0 to {count - 1}, each once, are needed."
    # NumPy takes an empty list as floats.
    if given.ndim != 1 or (given.size and given.dtype.kind not in "iu"):
        raise RecognitionError(f"{start} indices of type {given.dtype}, shape {given.shape}{end}")
    indices = given.astype(np.int64)
    outside = (indices < 0) | (indices >= count)
    if outside.any():
        raise RecognitionError(f"{start} index {indices[outside][0]}{end}")
    times = np.bincount(indices, minlength=count)
    if times.max() > 1:
        raise RecognitionError(f"{start} index {times.argmax()} more than once{end}")
    return indices


def _by_objects(
    sequences: TouchSequences, splits: Iterable[Any]
) -> Iterator[tuple[IntArray, IntArray]]:
    index_of = {"/".join(owner): index for index, owner in enumerate(sequences.objects)}
    for number, tested in enumerate(splits):
        if isinstance(tested, str | bytes) or not isinstance(tested, Iterable):
            raise ParameterError(
                f"Split {number} is {tested!r}; a list of its test objects, class/name, is needed."
            )
        names = list(tested)
        for name in names:
            if not isinstance(name, str):
                raise ParameterError(
                    f"Split {number} has a test object of type {type(name).__name__}; names, class/name, are needed, "
                    "not index arrays."
                )
        unknown = [name for name in names if name not in index_of]
        if unknown:
            raise ParameterError(
                f"Split {number} tests {unknown[0]}, which has no whole sequence; objects with whole sequences are "
                f"{', '.join(list(index_of)[:3])} and so on."
            )
        is_tested: BoolArray = np.isin(sequences.object_index, [index_of[name] for name in names])
        yield np.flatnonzero(~is_tested), np.flatnonzero(is_tested)


def _check(sequences: TouchSequences, split: Split) -> None:
    owners, labels = sequences.object_index, sequences.labels
    if not len(split.test):
        raise RecognitionError(f"Split {split.number} has no test object; at least one is needed.")
    both = np.intersect1d(owners[split.train], owners[split.test])
    if len(both):
        name = "/".join(sequences.objects[both[0]])
        raise RecognitionError(
            f"Split {split.number} has {name} in training and test; each object must be in only one of them."
        )
    untrained = np.setdiff1d(labels[split.test], labels[split.train])
    if len(untrained):
        name = sequences.classes[untrained[0]]
        raise RecognitionError(
            f"Split {split.number} tests class {name}, which has no training object; at least one is needed."
        )
