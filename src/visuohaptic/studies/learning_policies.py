"""Policies that learn: trained in every split on its training objects, and shown only what a hand would know."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyarrow as pa

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import (
    PolicyError,
    RecognitionError,
    RegistryError,
    VisuohapticError,
)
from visuohaptic.base.registry import Registry
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.fixations.probing import STRATEGIES
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.descriptors import POSE
from visuohaptic.recognition.sequences import TouchSequences, spread_contact_states
from visuohaptic.recognition.splits import Split
from visuohaptic.tables.schema import matrix


@dataclass(frozen=True)
class Lessons:
    """Touches of a split's training objects at all their candidates, and the objects' classes.

    Attributes
    ----------
    names : tuple of str
        The k features.
    features : ndarray of shape (n, k)
    owner : ndarray of shape (n,), int64
        The object of each touch by its index.
    view : ndarray of shape (n,), int64
        The viewpoint of each touch, by an index over all objects, ascending.
    class_of_object : ndarray of shape (o,), int64
        -1 for objects that are not in training.
    classes : int
        Number of classes.
    """

    names: tuple[str, ...]
    features: FloatArray
    owner: IntArray
    view: IntArray
    class_of_object: IntArray
    classes: int

    @property
    def poses(self) -> FloatArray:
        """Position and normal of each touch, shape (n, 6)."""
        return self.features[:, [self.names.index(name) for name in POSE]]


@dataclass(frozen=True, eq=False)
class Places:
    """Where one object may be touched from its v viewpoints, before any touch.

    Attributes
    ----------
    poses : ndarray of shape (n, 6)
        Position and normal of each candidate, as the viewpoint sees it.
    view : ndarray of shape (n,), int64
        The viewpoint of each, ascending from 0 without a gap.
    left_out : int
        The index of a training object, whose own lessons must not choose its touches; -1 for other objects.
    """

    poses: FloatArray
    view: IntArray
    left_out: int


Choose = Callable[[IntArray, FloatArray], IntArray]
"""``choose(chosen, felt)`` takes the candidates touched so far (v, t) and their features (v, t, k), and returns the next
candidate of each viewpoint (v,)."""

Learnt = Callable[[Places], Choose]
"""What was learnt in a split: it begins the touches of an object."""


@dataclass(frozen=True)
class LearningPolicy:
    """A policy that is trained on touches of training objects.

    Attributes
    ----------
    name : str
        What tables and the report call it.
    fit : callable
        ``fit(lessons, parameters, generator)`` takes `Lessons`, the parameters of the condition and a
        generator, and returns a `Learnt`. It must keep nothing from split to split.
    """

    name: str
    fit: Callable[[Lessons, ExperimentParameters, np.random.Generator], Learnt]


LEARNING_POLICIES: Registry[LearningPolicy] = Registry("learning policy")
"""Policies that study `touch_curves` measures, in the order of its tables."""


def add_learning_policy(entry: LearningPolicy, source: str) -> None:
    """Add a learning policy; `RegistryError` if its name is taken, also by a strategy, or can't be one."""
    if entry.name in STRATEGIES.names:
        raise RegistryError(
            f"{entry.name!r} can't name a learning policy; a probing strategy has that name."
        )
    LEARNING_POLICIES.add(entry, source)


@dataclass(frozen=True)
class Candidates:
    """Where objects may be touched, and the features (n, k) of a touch there.

    `sequences` are the s to choose, one per viewpoint of an object, without features; `sequence` (n,),
    ascending, is the index of the sequence that each is a candidate for.
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
        """Position and normal of each candidate (n, 6): known before a touch."""
        return self.features[:, [self.names.index(name) for name in POSE]]

    @property
    def owner(self) -> IntArray:
        """Each candidate's object (n,)."""
        return self.sequences.object_index[self.sequence]


def gather_candidates(features: pa.Table, names: Sequence[str]) -> Candidates:
    """Gather the candidates of every viewpoint, sorted by class, object, viewpoint and place.

    `features` are rows of strategy ``adaptive``; the names are columns to take, ``contact_…`` of the
    contact's state. Raises `RecognitionError` if there are none.
    """
    if not len(features):
        raise RecognitionError("There are no candidates to choose touches among.")
    keys = ["class", "object", "viewpoint", "touch"]
    features = spread_contact_states(features)
    features = features.sort_by([(key, "ascending") for key in keys])
    views = list(zip(*(features.column(key).to_pylist() for key in keys[:3]), strict=True))
    distinct = sorted(set(views))
    objects = tuple(sorted({view[:2] for view in distinct}))
    place = {view: number for number, view in enumerate(distinct)}
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
        np.array([place[view] for view in views], dtype=np.int64),
    )


def lessons_of(candidates: Candidates, split: Split) -> Lessons:
    """Take what may be learnt in a split: touches and classes of its training sequences."""
    sequences, taken = candidates.sequences, np.isin(candidates.sequence, split.train)
    training = np.unique(sequences.object_index[split.train])
    classes = np.full(len(sequences.objects), -1)
    classes[training] = sequences.class_of_object[training]
    return Lessons(
        candidates.names,
        candidates.features[taken],
        candidates.owner[taken],
        candidates.sequence[taken],
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
    """Train a policy in a split, and let it choose every sequence's touches: rows of the candidates, (s, touches).

    The policy learns `lessons_of` the split. Of an object it sees the poses of all candidates, and the features of those
    that it has touched.

    Raises
    ------
    PolicyError
        If the policy raises, or chooses no candidate of each viewpoint.
    """
    generator = spawn_generator(run.seed, policy.name, *split.test.tolist())
    lessons, owner = lessons_of(candidates, split), candidates.owner
    chosen = np.zeros((len(candidates.sequences.object_index), touches), dtype=np.int64)
    learnt = _asked(policy, "fit", policy.fit, lessons, run, generator)
    for place in range(len(candidates.sequences.objects)):
        rows = np.flatnonzero(owner == place)
        members = np.flatnonzero(candidates.sequences.object_index == place)
        view = np.searchsorted(members, candidates.sequence[rows])
        left_out = place if lessons.class_of_object[place] >= 0 else -1
        choose = _asked(policy, "begin", learnt, Places(candidates.poses[rows], view, left_out))
        own = np.zeros((len(members), 0), dtype=np.int64)
        for _ in range(touches):
            found = _asked(policy, "choose", choose, own.copy(), candidates.features[rows[own]])
            own = np.column_stack([own, _checked(policy, found, view, len(members))])
        chosen[members] = rows[own]
    return chosen


def choose_in_splits(
    policy: LearningPolicy,
    candidates: Candidates,
    splits: Sequence[Split],
    touches: int,
    run: ExperimentParameters,
) -> list[IntArray]:
    """Choose the touches of every split, as `choose_in_split` does.

    Raises
    ------
    PolicyError
        Also if the policy chooses otherwise in the first split once it was trained in the others: what it
        keeps may be of the tested objects.
    """
    found = [choose_in_split(policy, candidates, split, touches, run) for split in splits]
    again = choose_in_split(policy, candidates, splits[0], touches, run)
    if not np.array_equal(again, found[0]):
        raise PolicyError(
            f"learning policy {policy.name} chose other touches in split {splits[0].number} once it was trained in "
            "others: it keeps what it learnt, which may be of tested objects; nothing may stay from split to split."
        )
    return found


def _asked(policy: LearningPolicy, step: str, work: Callable[..., Any], *arguments: Any) -> Any:
    try:
        return work(*arguments)
    except VisuohapticError:
        raise
    except Exception as error:
        said = " ".join(str(error).split()).rstrip(".")
        raise PolicyError(
            f"learning policy {policy.name}, {step}: it raised {type(error).__name__}: {said}."
        ) from error


def _checked(policy: LearningPolicy, found: object, view: IntArray, views: int) -> IntArray:
    """Return the chosen candidates (v,) if each is one of its own viewpoint's."""
    picked = np.asarray(found)
    if picked.shape != (views,) or picked.dtype.kind not in "iu":
        raise PolicyError(
            f"learning policy {policy.name} chose an array of shape {picked.shape} and type {picked.dtype}; "
            f"({views},) indices of candidates are needed."
        )
    inside = (picked >= 0) & (picked < len(view))
    if not inside.all() or (view[picked] != np.arange(views)).any():
        raise PolicyError(
            f"learning policy {policy.name} chose candidates {picked.tolist()}; one of each viewpoint's own is needed."
        )
    return picked.astype(np.int64)
