"""The entry of a learning policy: a policy that a study trains in each split, on touches of training objects."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from visuohaptic.active.policies import check_bound
from visuohaptic.active.registry import STRATEGIES
from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import RegistryError
from visuohaptic.base.registry import Registry
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.descriptors import POSE


@dataclass(frozen=True)
class Lessons:
    """Training data of a policy in a split: touches at all candidates of the training objects.

    Attributes
    ----------
    names : tuple of str
        Names of the k features.
    features : ndarray of shape (n, k)
        Features of the n touches.
    owner : ndarray of shape (n,), int64
        Index of the object of each touch.
    view : ndarray of shape (n,), int64
        Viewpoint of each touch, numbered over all objects, ascending.
    class_of_object : ndarray of shape (o,), int64
        Class index of each object; -1 for objects that are not in training.
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
    """Candidates of an object with v viewpoints, as known before any touch.

    Attributes
    ----------
    poses : ndarray of shape (n, 6)
        Position and normal of each candidate, as its viewpoint sees them.
    view : ndarray of shape (n,), int64
        Index of the viewpoint of each candidate, 0 to v - 1, ascending.
    left_out : int
        Index of the object if it is a training object, else -1. The policy must not use touches of this object.
    """

    poses: FloatArray
    view: IntArray
    left_out: int


Choose = Callable[[IntArray, FloatArray], IntArray]
"""``choose(chosen, felt)`` takes the indices of the candidates touched so far (v, t) and their features (v, t, k). The
result is the index of the next candidate of each viewpoint (v,)."""

Learnt = Callable[[Places], Choose]
"""A trained policy, which is called once per object."""


@dataclass(frozen=True)
class LearningPolicy:
    """A policy that is trained on touches of training objects.

    Attributes
    ----------
    name : str
        Name in tables and in the report.
    fit : callable
        ``fit(lessons, parameters, generator)`` takes `Lessons`, the parameters of the condition and a random
        generator, and returns a `Learnt`. Calls must not depend on earlier calls.
    longest_seconds : float
        Longest allowed wall time of one call of `Learnt` or `Choose`, in seconds; `math.inf` for no bound. `fit` may
        take as long for each training object. A slower call ends in a `PolicyError`. The time is compared after the
        call, so a call that never returns is not stopped.

    Raises
    ------
    RegistryError
        If `longest_seconds` is no positive number.
    """

    name: str
    fit: Callable[[Lessons, ExperimentParameters, np.random.Generator], Learnt]
    longest_seconds: float = 60.0

    def __post_init__(self) -> None:
        """Check the bound."""
        check_bound(f"learning policy {self.name}", self.longest_seconds)


LEARNING_POLICIES: Registry[LearningPolicy] = Registry("learning policy")
"""The learning policies of study `touch_curves`, in the order of its tables."""


def add_learning_policy(entry: LearningPolicy, source: str) -> None:
    """Register a learning policy.

    Raises `RegistryError` if the name is invalid, or the name of another learning policy or probing strategy.
    """
    if entry.name in STRATEGIES.names:
        raise RegistryError(
            f"{entry.name!r} can't name a learning policy; a probing strategy has that name."
        )
    LEARNING_POLICIES.add(entry, source)
