"""Touching by policies: in each round every policy chooses one location per viewpoint, and all are touched together.

A try is one location that a policy chooses. The tries of one policy at one viewpoint are a sequence. A location in
reach is touched. A location out of reach is passed over, or touched if ``unreachable`` is ``keep``; in both cases the
policy gets a `Felt` with `acquired` False. A try that is passed over counts as a touch if ``unreachable`` is ``skip``.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, partial
from itertools import groupby
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visuohaptic.active.policies import (
    FARTHEST_POINT,
    MAX_SURFACE_DISTANCE,
    PLACES,
    Felt,
    Policy,
    PolicyView,
)
from visuohaptic.active.registry import policy_of
from visuohaptic.base.arrays import FloatArray, masked_fault
from visuohaptic.base.bounded_loops import turns
from visuohaptic.base.errors import PolicyError
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.fixations.parameters import ViewpointParameters
from visuohaptic.fixations.places import Unreachable, nearest_places
from visuohaptic.fixations.strategies.farthest_point import spread_far
from visuohaptic.fixations.viewpoints import place_cameras
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.subject import Subject
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.random_fields import RandomFields
from visuohaptic.sensor.reaching import reachable
from visuohaptic.sensor.sensing import Touches, touch
from visuohaptic.tables.phases import NORMAL_NAMES, POINT_NAMES, SPARE, owner_columns

SAME_LOCATION = 1e-6
"""Points within this distance of each other, object radii, are the same location."""

SLOW_SECONDS = 1.0
"""Mean seconds per choice on an object above which a policy is logged as slow."""

logger = logging.getLogger(__name__)


@dataclass(eq=False)
class PolicySession:
    """A policy at one viewpoint of an object, with its tries so far.

    Attributes
    ----------
    key : str
        The object, ``class/name``.
    viewpoint : int
        The number of the viewpoint.
    policy : Policy
    view : PolicyView
        First argument of the policy: the surface, the camera and a random generator.
    unreachable : {"replace", "skip", "keep"}
        Treatment of locations out of reach.
    felt : list of Felt
        The results of all tries so far, touched or passed over.
    touches : int
        The number of tries that were touched.
    stopped : bool
        Whether the policy returned None.
    seconds : float
        Wall time of all choices of the policy so far.
    clock : callable
        Returns seconds of wall time: a policy that waits for a device or a server uses no processor time.
    """

    key: str
    viewpoint: int
    policy: Policy
    view: PolicyView
    unreachable: Unreachable = "replace"
    felt: list[Felt] = field(default_factory=list)
    touches: int = 0
    stopped: bool = False
    seconds: float = 0.0
    clock: Callable[[], float] = time.perf_counter

    def needs_try(self, most: int) -> bool:
        """Return whether the sequence makes another try.

        A sequence ends with `most` touches, if its policy has stopped, or if it is exhausted. If locations out of reach
        are skipped, it ends with `most` tries.
        """
        if self.unreachable == "skip":
            return not self.stopped and len(self.felt) < most
        return not self.stopped and not self.exhausted and self.touches < most

    @property
    def exhausted(self) -> bool:
        """Whether more than `SPARE` tries were passed over."""
        return len(self.felt) - self.touches > SPARE

    def choose(self) -> FloatArray | None:
        """Ask the policy for its next point (3,), object frame, or None if the policy stops.

        The call updates `seconds` and `stopped`. The caller appends the result of the try to `felt`.

        Raises
        ------
        PolicyError
            If the policy raises an error, takes longer than its bound, or returns anything but None or three finite
            numbers below `FARTHEST_POINT`.
        """
        started = self.clock()
        try:
            chosen = self.policy.next_location(self.view, tuple(self.felt))
        except Exception as error:
            message = " ".join(str(error).split()).rstrip(".")
            named = ": ".join(filter(None, (type(error).__name__, message)))
            raise self._error(f"raised {named}") from error
        finally:
            taken = self.clock() - started
            self.seconds += taken
        if taken > self.policy.longest_seconds:
            raise self._error(
                f"took {taken:.3g} s to choose; at most {self.policy.longest_seconds:.3g} s are allowed "
                "(Policy.longest_seconds)"
            )
        if chosen is None:
            self.stopped = True
            return None
        return self._as_point(chosen)

    def check_location(self, chosen: FloatArray, on_surface: FloatArray) -> None:
        """Raise `PolicyError` if a chosen point is far off the surface, or an earlier try has its location.

        `chosen` (3,) is the policy's point and `on_surface` (3,) the nearest point of the surface, object frame.
        The limits are `MAX_SURFACE_DISTANCE` and `SAME_LOCATION`.
        """
        distance = float(np.linalg.norm(chosen - on_surface))
        if distance > MAX_SURFACE_DISTANCE:
            raise self._error(
                f"chose {_format_point(chosen)}, {distance:.2g} object radii off the surface; at most "
                f"{MAX_SURFACE_DISTANCE} is allowed, in the object frame"
            )
        for number, earlier in enumerate(self.felt):
            if np.linalg.norm(earlier.point - on_surface) <= SAME_LOCATION:
                raise self._error(
                    f"chose {_format_point(on_surface)}, the location of try {number}; a new location, or None to "
                    "stop, is needed"
                )

    @property
    def random_key(self) -> tuple[object, ...]:
        """The key of the next touch for `RandomFields`: class, name, viewpoint, ``random_stream``, index of the touch."""
        return (
            *self.key.split("/"),
            self.viewpoint,
            self.policy.random_stream or self.policy.name,
            self.touches,
        )

    def fixation_row(self, point: FloatArray, normal: FloatArray, face: int) -> dict[str, object]:
        """Return the next try as a row of `tables.FIXATIONS`; column ``touch`` is the index of the try.

        `point` (3,) on the surface and its outward unit `normal` (3,) are in the object frame.
        """
        return {
            **owner_columns(self.key),
            "viewpoint": self.viewpoint,
            "strategy": self.policy.name,
            "touch": len(self.felt),
            **dict.fromkeys(("pixel_row", "pixel_column", "saliency")),
            **dict(zip((*POINT_NAMES, *NORMAL_NAMES), (*point, *normal), strict=True)),
            "face": face,
            "unreachable": self.policy.unreachable,
            "random_stream": self.policy.random_stream or self.policy.name,
        }

    def _as_point(self, chosen: object) -> FloatArray:
        if fault := masked_fault(chosen):
            raise self._error(f"chose a point with {fault}")
        try:
            point = np.asarray(chosen).astype(np.float64, casting="same_kind")
        # The `__array__` of an object may raise anything.
        except Exception as error:
            raise self._error(
                f"chose an object of type {type(chosen).__name__}; three numbers that float64 holds, or None to stop, "
                "are needed"
            ) from error
        if point.shape != (3,):
            raise self._error(f"chose an array of shape {point.shape}; (3,) is needed")
        if not (np.abs(point) < FARTHEST_POINT).all():
            raise self._error(
                f"chose {_format_point(point)}; finite numbers below {FARTHEST_POINT:g} object radii are needed"
            )
        return point

    def _error(self, deed: str) -> PolicyError:
        """Return the error of a policy for its `deed`, such as ``raised ValueError``. Tries count from 0."""
        where = f"{self.key}, viewpoint {self.viewpoint}, try {len(self.felt)}"
        return PolicyError(f"policy {self.policy.name}, {where}: it {deed}.", self.policy.name)


@dataclass(eq=False)
class Tries:
    """All tries of policies on an object, round after round, and the m tries that were touched.

    Attributes
    ----------
    sessions : list of PolicySession
        One session per policy and viewpoint, policy after policy.
    rows : list of dict
        All tries, rows of `tables.FIXATIONS`.
    touched : list of int
        The m indices in `rows` of the tries that were touched.
    numbers : list of int
        The index of each of the m touches among the touches of its sequence.
    batches : list of Touches
        The m touches in the order of `touched`, one batch per round with a touch.
    """

    sessions: list[PolicySession]
    rows: list[dict[str, object]] = field(default_factory=list)
    touched: list[int] = field(default_factory=list)
    numbers: list[int] = field(default_factory=list)
    batches: list[Touches] = field(default_factory=list)


def touch_by_policies(
    subject: Subject,
    policies: Sequence[str],
    viewpoints: ViewpointParameters,
    sensor: SensorParameters,
    scene: Scene,
    seed: int,
    most: int,
    unreachable: Unreachable,
) -> Tries:
    """Touch an object at locations that policies choose by their earlier touches.

    Each sequence makes one try per round, at the surface's nearest point to the point that the policy chose. A
    sequence ends with `most` touches, if its policy stops, or if more than `SPARE` tries are passed over.

    The parameters are those of `touches.acquiring.acquire_touches`. `most` is the most touches of a sequence;
    `unreachable` is the treatment of locations out of reach, which a policy's own ``unreachable`` overrides.

    Raises
    ------
    PolicyError
        If a policy raises an error, takes longer than its bound, returns anything but three finite numbers or
        None, chooses a point more than `MAX_SURFACE_DISTANCE` off the surface, or chooses a location twice.
    """
    chosen = [policy_of(name) for name in policies]
    tries = Tries(start_sessions(subject, chosen, viewpoints, seed, unreachable))
    # Each turn is a touch, a location that is passed over, or the end of the session.
    for _ in turns(most + SPARE + 2, "the choice of locations by policies"):
        active = [session for session in tries.sessions if session.needs_try(most)]
        if not active:
            break
        choices = {session: session.choose() for session in active}
        points = {session: point for session, point in choices.items() if point is not None}
        if points:
            _try_locations(subject.caster, points, sensor, scene, seed, tries)
    _log_ended_and_slow(tries.sessions, most)
    return tries


def start_sessions(
    subject: Subject,
    policies: Sequence[Policy],
    viewpoints: ViewpointParameters,
    seed: int,
    unreachable: Unreachable,
) -> list[PolicySession]:
    """Return one session without tries per policy and viewpoint of an object, policy after policy."""
    sessions = []
    for policy in policies:
        treatment = policy.unreachable or unreachable
        views = policy_views(subject, policy.random_stream or policy.name, viewpoints, seed)
        sessions += [
            PolicySession(subject.key, number, policy, view, treatment)
            for number, view in views.items()
        ]
    return sessions


def policy_views(
    subject: Subject, random_stream: str, viewpoints: ViewpointParameters, seed: int
) -> dict[int, PolicyView]:
    """Return the view of a policy at each viewpoint of an object, by number of the viewpoint.

    The views share the locations that are spread over the object. They are computed when a view first reads them.
    `random_stream` is the name from which all random numbers are seeded, together with `seed`.
    """
    caster, cameras = subject.caster, place_cameras(viewpoints)
    spread = spawn_generator(seed, "places", random_stream, subject.key)
    find_places = cache(partial(spread_far, caster.surface, PLACES, spread))
    return {
        number: PolicyView(
            caster,
            cameras[number],
            spawn_generator(seed, random_stream, subject.key, number),
            find_places,
        )
        for number in subject.viewpoints
    }


def _try_locations(
    caster: RayCaster,
    chosen: Mapping[PolicySession, FloatArray],
    sensor: SensorParameters,
    scene: Scene,
    seed: int,
    tries: Tries,
) -> None:
    """Make one try per session at the surface's nearest point, and record it in the session and in `tries`."""
    sessions, points = [*chosen], np.stack([*chosen.values()])
    located = nearest_places(caster, points)
    locations, normals, faces = located.points, located.normals, located.faces
    for session, point, location in zip(sessions, points, locations, strict=True):
        session.check_location(point, location)
    reached = reachable(caster, locations, normals, sensor, faces)
    keeps = [session.unreachable == "keep" for session in sessions]
    rows = np.flatnonzero(reached | keeps)
    tries.touched += (len(tries.rows) + rows).tolist()
    tries.numbers += [sessions[row].touches for row in rows]
    for session, location, normal, face in zip(sessions, locations, normals, faces, strict=True):
        tries.rows.append(session.fixation_row(location, normal, face))
        session.felt.append(felt_nothing(location, normal))
    if not len(rows):
        return
    fields = RandomFields(seed, [sessions[row].random_key for row in rows])
    touches = touch(caster, locations[rows], normals[rows], sensor, scene, fields, faces[rows])
    tries.batches.append(touches)
    for index, row in enumerate(rows):
        sessions[row].felt[-1] = felt_touch(locations[row], touches, index, acquired=reached[row])
        sessions[row].touches += 1


def felt_touch(point: FloatArray, touches: Touches, index: int, *, acquired: bool) -> Felt:
    """Return what a policy is told of one of `touches`, which was made at `point` (3,); `acquired` as in `Felt`."""
    return Felt(
        _read_only(point),
        _read_only(touches.normals[index]),
        bool(acquired),
        _read_only(touches.images[index]),
        float(touches.size[index]),
        str(touches.contact_state[index]),
    )


def felt_nothing(point: FloatArray, normal: FloatArray) -> Felt:
    """Return what a policy is told of a try at `point` (3,) with the outward unit `normal` (3,) that was passed over."""
    return Felt(_read_only(point), _read_only(normal), acquired=False)


def _read_only(array: NDArray[Any]) -> NDArray[Any]:
    """Return a read-only copy, by which a policy can't change the recorded array."""
    copy = array.copy()
    copy.flags.writeable = False
    return copy


def _log_ended_and_slow(sessions: Sequence[PolicySession], most: int) -> None:
    """Log sequences that ended before `most` touches, and policies slower than `SLOW_SECONDS` per choice."""
    for name, group in groupby(sessions, key=lambda session: session.policy.name):
        of_policy = list(group)
        stopped = ", ".join(str(session.viewpoint) for session in of_policy if session.stopped)
        if stopped:
            logger.warning(
                "policy %s stopped before touch %d of %s, viewpoints %s.",
                name, most, of_policy[0].key, stopped,
            )  # fmt: skip
        exhausted = ", ".join(str(session.viewpoint) for session in of_policy if session.exhausted)
        if exhausted:
            logger.warning(
                "policy %s ended before touch %d of %s, viewpoints %s: %d places were out of reach.",
                name, most, of_policy[0].key, exhausted, SPARE + 1,
            )  # fmt: skip
        seconds = sum(session.seconds for session in of_policy)
        choices = sum(len(session.felt) + session.stopped for session in of_policy)
        if seconds > SLOW_SECONDS * choices:
            logger.warning(
                "policy %s took %.1f s for %d choices on %s.",
                name, seconds, choices, of_policy[0].key,
            )  # fmt: skip


def _format_point(point: FloatArray) -> str:
    return f"({', '.join(f'{value:.3g}' for value in point)})"
