"""Train learning policies per split, and let them choose touches by the features of earlier touches only."""

from __future__ import annotations

import math
import pickle
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np
import pyarrow as pa
from joblib import wrap_non_picklable_objects
from joblib.externals.loky import ProcessPoolExecutor

from visuohaptic.base.arrays import FloatArray, IntArray, masked_fault
from visuohaptic.base.errors import PolicyError, RecognitionError, VisuohapticError
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.io.plugins import child_environment
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.descriptors import POSE
from visuohaptic.recognition.sequences import TouchSequences, spread_contact_states
from visuohaptic.recognition.splits import Split
from visuohaptic.studies.learning_policies import LearningPolicy, Lessons, Places
from visuohaptic.tables.schema import matrix


@dataclass(frozen=True)
class Candidates:
    """Candidates for touches of all objects, and their features.

    Attributes
    ----------
    sequences : TouchSequences
        The s sequences to choose, one per object and viewpoint, without features.
    features : ndarray of shape (n, k)
        Features of a touch at each candidate.
    sequence : ndarray of shape (n,), int64
        Index of the sequence of each candidate, ascending.
    """

    sequences: TouchSequences
    features: FloatArray
    sequence: IntArray

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the k features."""
        return self.sequences.feature_names

    @property
    def poses(self) -> FloatArray:
        """Position and normal of each candidate, shape (n, 6), which are known before a touch."""
        return self.features[:, [self.names.index(name) for name in POSE]]

    @property
    def owner(self) -> IntArray:
        """Index of the object of each candidate, shape (n,)."""
        return self.sequences.object_index[self.sequence]


def gather_candidates(features: pa.Table, names: Sequence[str]) -> Candidates:
    """Gather the candidates of all viewpoints, sorted by class, object, viewpoint and touch.

    `features` has rows of `tables.FEATURES` of strategy ``adaptive``. `names` are the columns to take; names with
    ``contact_…`` are columns of the contact's state. Raises `RecognitionError` if the table is empty.
    """
    if not len(features):
        raise RecognitionError(
            "There are no candidates for touches; rows of strategy adaptive are needed."
        )
    keys = ["class", "object", "viewpoint", "touch"]
    features = spread_contact_states(features)
    features = features.sort_by([(key, "ascending") for key in keys])
    views = list(zip(*(features.column(key).to_pylist() for key in keys[:3]), strict=True))
    distinct = sorted(set(views))
    objects = tuple(sorted({view[:2] for view in distinct}))
    index_of = {view: index for index, view in enumerate(distinct)}
    sequences = TouchSequences(
        features=np.zeros((len(distinct), 0, len(names))),
        feature_names=tuple(names),
        objects=objects,
        classes=tuple(sorted({name for name, _ in objects})),
        object_index=np.array([objects.index(view[:2]) for view in distinct], dtype=np.int64),
        viewpoint=np.array([view[2] for view in distinct], dtype=np.int64),
    )
    return Candidates(
        sequences,
        matrix(features, names),
        np.array([index_of[view] for view in views], dtype=np.int64),
    )


def lessons_of(candidates: Candidates, split: Split) -> Lessons:
    """Select the touches and classes of the training sequences of a split."""
    sequences, in_training = candidates.sequences, np.isin(candidates.sequence, split.train)
    training = np.unique(sequences.object_index[split.train])
    classes = np.full(len(sequences.objects), -1)
    classes[training] = sequences.class_of_object[training]
    return Lessons(
        candidates.names,
        candidates.features[in_training],
        candidates.owner[in_training],
        candidates.sequence[in_training],
        classes,
        len(sequences.classes),
    )


def choose_in_split(
    policy: LearningPolicy,
    candidates: Candidates,
    split: Split,
    touches: int,
    run: ExperimentParameters,
) -> IntArray:
    """Train a policy on a split's training objects, then choose the touches of all sequences.

    While it chooses, the policy gets the poses of all candidates of an object, but only the features of candidates
    touched so far.

    Parameters
    ----------
    policy : LearningPolicy
        The policy.
    candidates : Candidates
        Candidates of s sequences.
    split : Split
        The split.
    touches : int
        The number of touches per sequence.
    run : ExperimentParameters
        Parameters of the condition; their seed seeds the policy's generator.

    Returns
    -------
    ndarray of shape (s, touches), int64
        Row indices of the chosen candidates.

    Raises
    ------
    PolicyError
        If the policy raises an error, takes longer than its bound, does not choose one candidate per viewpoint, or
        chooses a candidate again while the viewpoint has another.
    """
    generator = spawn_generator(run.seed, policy.name, *split.test.tolist())
    lessons, owner = lessons_of(candidates, split), candidates.owner
    chosen = np.zeros((len(candidates.sequences.object_index), touches), dtype=np.int64)
    bound = policy.longest_seconds
    whole = bound * len(np.unique(lessons.owner))
    learnt = _call_policy(policy, "fit", whole, policy.fit, lessons, run, generator)
    for index in range(len(candidates.sequences.objects)):
        rows = np.flatnonzero(owner == index)
        members = np.flatnonzero(candidates.sequences.object_index == index)
        view = np.searchsorted(members, candidates.sequence[rows])
        left_out = index if lessons.class_of_object[index] >= 0 else -1
        places = Places(candidates.poses[rows], view, left_out)
        choose = _call_policy(policy, "begin", bound, learnt, places)
        touched = np.zeros((len(members), 0), dtype=np.int64)
        for _ in range(touches):
            felt = candidates.features[rows[touched]]
            picked = _call_policy(policy, "choose", bound, choose, touched.copy(), felt)
            picked = _check_choice(policy, picked, view, touched)
            touched = np.column_stack([touched, picked])
        chosen[members] = rows[touched]
    return chosen


def choose_in_splits(
    policy: LearningPolicy,
    candidates: Candidates,
    splits: Sequence[Split],
    touches: int,
    run: ExperimentParameters,
) -> list[IntArray]:
    """Choose the touches of each split with `choose_in_split`.

    Raises
    ------
    PolicyError
        As `choose_in_split`. Also if the policy can't be pickled, or if a repetition of the first split, or the last
        split in a new process, gives other touches: the policy then remembers other splits, and their training
        objects may be test objects of this split.
    """
    arguments = touches, run
    # First, because the new process inherits what the policy remembers in this process.
    afresh = choose_afresh(policy, candidates, splits[-1], *arguments) if splits[1:] else None
    chosen = [choose_in_split(policy, candidates, split, *arguments) for split in splits]
    again = choose_in_split(policy, candidates, splits[0], *arguments)
    how = None
    if not np.array_equal(again, chosen[0]):
        how = f"when split {splits[0].number} was repeated after the others"
    elif afresh is not None and not np.array_equal(afresh, chosen[-1]):
        how = f"in split {splits[-1].number} after the others than in a new process"
    if how:
        raise PolicyError(
            f"learning policy {policy.name} chose other touches {how}, so it may remember tested objects; the "
            "choices in a split must not depend on other splits."
        )
    return chosen


def choose_afresh(
    policy: LearningPolicy,
    candidates: Candidates,
    split: Split,
    touches: int,
    run: ExperimentParameters,
) -> IntArray:
    """Choose the touches of a split with `choose_in_split` in a new process, which imports every module anew.

    Raises `PolicyError` as `choose_in_split`, or if the policy can't be pickled.
    """

    def choose() -> IntArray:
        copied = pickle.dumps(wrap_non_picklable_objects(policy, keep_wrapper=False))
        with ProcessPoolExecutor(max_workers=1, env=child_environment()) as pool:
            task = pool.submit(_choose_by_copy, copied, candidates, split, touches, run)
            chosen: IntArray = task.result()
        return chosen

    chosen: IntArray = _call_policy(policy, "copy to a new process", math.inf, choose)
    return chosen


def _choose_by_copy(
    copied: bytes, candidates: Candidates, split: Split, touches: int, run: ExperimentParameters
) -> IntArray:
    """Unpickle a policy and choose with `choose_in_split`; an error of unpickling then has its own message."""
    policy = pickle.loads(copied)  # noqa: S301 - the parent process wrote it
    return choose_in_split(policy, candidates, split, touches, run)


def _call_policy(
    policy: LearningPolicy, step: str, bound: float, work: Callable[..., Any], *arguments: Any
) -> Any:
    """Call a function; raise `PolicyError` if it is slower than `bound`, or for an error that is not the package's."""
    started = perf_counter()
    try:
        result = work(*arguments)
    except VisuohapticError:
        raise
    except Exception as error:
        reason = " ".join(str(error).split()).rstrip(".")
        named = ": ".join(filter(None, (type(error).__name__, reason)))
        raise PolicyError(f"learning policy {policy.name}, {step}: it raised {named}.") from error
    taken = perf_counter() - started
    if taken > bound:
        raise PolicyError(
            f"learning policy {policy.name}, {step}: it took {taken:.3g} s; at most {bound:.3g} s are allowed "
            "(LearningPolicy.longest_seconds)."
        )
    return result


def _check_choice(
    policy: LearningPolicy, choice: object, view: IntArray, touched: IntArray
) -> IntArray:
    """Return the chosen candidates (v,) if each is a new candidate of its viewpoint, else raise `PolicyError`."""
    needed, views = f"({len(touched)},) indices of candidates are needed.", np.arange(len(touched))
    if fault := masked_fault(choice):
        raise PolicyError(f"learning policy {policy.name} chose candidates with {fault}.")
    try:
        picked = np.asarray(choice)
    except (TypeError, ValueError):
        raise PolicyError(
            f"learning policy {policy.name} chose an object of type {type(choice).__name__}; {needed}"
        ) from None
    if picked.shape != views.shape or picked.dtype.kind not in "iu":
        raise PolicyError(
            f"learning policy {policy.name} chose an array of shape {picked.shape} and type {picked.dtype}; {needed}"
        )
    inside = (picked >= 0) & (picked < len(view))
    if not inside.all() or (view[picked] != views).any():
        raise PolicyError(
            f"learning policy {policy.name} chose candidates {picked.tolist()}; one candidate of each viewpoint is "
            "needed."
        )
    # A viewpoint may have fewer candidates than touches.
    left = np.setdiff1d(np.arange(len(view)), touched)
    repeated = (touched == picked[:, None]).any(axis=1) & np.isin(views, view[left])
    if repeated.any():
        raise PolicyError(
            f"learning policy {policy.name} chose candidates {picked[repeated].tolist()} again; a new candidate is "
            "needed while the viewpoint has one."
        )
    return picked.astype(np.int64)
