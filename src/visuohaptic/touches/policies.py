"""Touching by policies: every viewpoint chooses its next location, then one batch of rays touches all of them."""

from __future__ import annotations

import logging
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, partial
from itertools import groupby
from typing import NamedTuple

import numpy as np
import pyarrow as pa

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import PolicyError
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.fixations.parameters import ViewpointParameters
from visuohaptic.fixations.policies import PLACES, Felt, Policy, PolicyView
from visuohaptic.fixations.probing import policy_of
from visuohaptic.fixations.strategies.farthest_point import spread_far
from visuohaptic.fixations.viewpoints import place_cameras
from visuohaptic.geometry.orientation import orient_outwards
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.subject import Subject
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.random_fields import RandomFields
from visuohaptic.sensor.reaching import reachable
from visuohaptic.sensor.touching import Touches, join_touches, touch
from visuohaptic.tables.phases import (
    FIXATIONS,
    NORMAL_NAMES,
    POINT_NAMES,
    SPARE,
    TOUCHES,
    owner_columns,
)
from visuohaptic.tables.schema import build_rows, join_parts
from visuohaptic.touches.choosing import Wanted, choose_locations, with_touch_numbers
from visuohaptic.touches.touching import Part, touch_part, touch_table

FARTHEST = 0.1
"""Largest allowed distance of a chosen point from the surface, object radii."""

SAME_LOCATION = 1e-6
"""Points within this distance of each other, object radii, are the same location."""

SLOW_SECONDS = 1.0
"""Mean seconds per choice above which a policy's time is logged."""

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
        The policy.
    view : PolicyView
        The knowledge of the policy before the first touch.
    felt : list of Felt
        The tries so far.
    touches : int
        The number of touches; tries that are passed over do not count.
    stopped : bool
        Whether the policy returned None.
    seconds : float
        Time of the policy's choices.
    """

    key: str
    viewpoint: int
    policy: Policy
    view: PolicyView
    felt: list[Felt] = field(default_factory=list)
    touches: int = 0
    stopped: bool = False
    seconds: float = 0.0

    def needs_try(self, wanted: int) -> bool:
        """Return whether `choosing.choose_locations` would take another location for `wanted` touches."""
        passed_over = len(self.felt) - self.touches
        return not self.stopped and self.touches < wanted and passed_over <= SPARE

    def choose(self) -> FloatArray | None:
        """Return the policy's next point (3,), object frame; None if the policy stops."""
        started = time.perf_counter()
        try:
            chosen = self.policy.next_location(self.view, tuple(self.felt))
        except Exception as error:
            message = " ".join(str(error).split()).rstrip(".")
            raise self._error(f"raised {type(error).__name__}: {message}") from error
        finally:
            self.seconds += time.perf_counter() - started
        if chosen is None:
            self.stopped = True
            return None
        return self._checked(chosen)

    def check_location(self, chosen: FloatArray, on_surface: FloatArray) -> None:
        """Raise `PolicyError` if `chosen` is too far from `on_surface`, or `on_surface` was chosen before."""
        distance = float(np.linalg.norm(chosen - on_surface))
        if distance > FARTHEST:
            raise self._error(
                f"chose {_written(chosen)}, {distance:.2g} object radii off the surface; at most {FARTHEST} is "
                "allowed, in the object frame"
            )
        for number, earlier in enumerate(self.felt):
            if np.linalg.norm(earlier.point - on_surface) <= SAME_LOCATION:
                raise self._error(
                    f"chose {_written(on_surface)}, the location of try {number}; a new location, or None to stop, "
                    "is needed"
                )

    @property
    def touch_key(self) -> tuple[object, ...]:
        """The key of the next touch's random numbers, as in `touching.random_fields`."""
        return (
            *self.key.split("/"),
            self.viewpoint,
            self.policy.chance or self.policy.name,
            self.touches,
        )

    def row(self, point: FloatArray, normal: FloatArray, face: int) -> dict[str, object]:
        """Return the next try at a point (3,) with a unit normal (3,) and a face, as a row of `tables.FIXATIONS`."""
        return {
            **owner_columns(self.key),
            "viewpoint": self.viewpoint,
            "strategy": self.policy.name,
            "touch": len(self.felt),
            **dict.fromkeys(("pixel_row", "pixel_column", "saliency")),
            **dict(zip((*POINT_NAMES, *NORMAL_NAMES), (*point, *normal), strict=True)),
            "face": face,
            "unreachable": self.policy.unreachable,
            "chance": self.policy.chance or self.policy.name,
        }

    def _checked(self, chosen: object) -> FloatArray:
        try:
            point = np.asarray(chosen, dtype=np.float64)
        except (TypeError, ValueError):
            raise self._error(
                f"chose an object of type {type(chosen).__name__}; three numbers, or None to stop, are needed"
            ) from None
        if point.shape != (3,):
            raise self._error(f"chose an array of shape {point.shape}; (3,) is needed")
        if not np.isfinite(point).all():
            raise self._error(f"chose {_written(point)}; finite numbers are needed")
        return point

    def _error(self, fault: str) -> PolicyError:
        return PolicyError(
            f"policy {self.policy.name}, {self.key}, viewpoint {self.viewpoint}, try {len(self.felt)}: it {fault}."
        )


@dataclass(eq=False)
class Tries:
    """All tries of an object, and the m touches among them.

    Attributes
    ----------
    rows : list of dict
        The tries, rows of `tables.FIXATIONS`.
    touched : list of int
        The indices of the m touches in `rows`.
    numbers : list of int
        The number of each touch in its sequence.
    batches : list of Touches
        The m touches, in batches.
    """

    rows: list[dict[str, object]] = field(default_factory=list)
    touched: list[int] = field(default_factory=list)
    numbers: list[int] = field(default_factory=list)
    batches: list[Touches] = field(default_factory=list)

    def tables(self) -> tuple[pa.Table, Part]:
        """Return the tries as `tables.FIXATIONS`, and the touches, both sorted by their keys."""
        fixations = build_rows(FIXATIONS, self.rows)
        if not self.batches:
            return fixations, Part(TOUCHES.arrow.empty_table(), ())
        touched = fixations.take(self.touched)
        ranks, felt = touched.column("touch").to_numpy(), join_touches(self.batches)
        numbered = with_touch_numbers(touched, np.array(self.numbers))
        touches = join_parts(TOUCHES, [touch_table(numbered, felt, ranks)])
        return join_parts(FIXATIONS, [fixations]), Part(touches, felt.effects)


class PolicyTouches(NamedTuple):
    """The locations that policies chose, rows of `tables.FIXATIONS`, the touches, and the seconds of the choices."""

    fixations: pa.Table
    part: Part
    seconds: float


def follow_policies(
    subject: Subject,
    policies: Sequence[str],
    viewpoints: ViewpointParameters,
    sensor: SensorParameters,
    scene: Scene,
    seed: int,
    wanted: Wanted,
) -> PolicyTouches:
    """Touch an object by policies.

    In each round every policy at every viewpoint makes one try, until no sequence needs another try. A location out
    of reach is touched or not, as parameter ``unreachable`` says; the policy sees it as a try that was not acquired.
    A sequence ends after more than `SPARE` locations without a touch, or if the policy stops. The arguments are as
    for `acquiring.acquire_touches`.

    Raises
    ------
    PolicyError
        If a policy raises an error, chooses a location off the surface, or chooses a location twice.
    """
    caster = subject.caster
    sessions = start_sessions(subject, [policy_of(name) for name in policies], viewpoints, seed)
    tries = Tries()
    while active := [session for session in sessions if session.needs_try(wanted.touches)]:
        choices = {session: session.choose() for session in active}
        points = {session: point for session, point in choices.items() if point is not None}
        if points:
            _try_locations(caster, points, sensor, scene, seed, wanted, tries)
    _log(sessions, wanted.touches)
    fixations, part = tries.tables()
    is_short = any(0 < session.touches < wanted.touches for session in sessions)
    if is_short and wanted.when_exhausted == "begin_again":
        repeated, ranks = choose_locations(caster, fixations, sensor, wanted)
        part = touch_part(caster, repeated, sensor, scene, seed, ranks)
    return PolicyTouches(fixations, part, sum(session.seconds for session in sessions))


def start_sessions(
    subject: Subject, policies: Sequence[Policy], viewpoints: ViewpointParameters, seed: int
) -> list[PolicySession]:
    """Return a session without tries for each policy and each viewpoint of an object."""
    caster, cameras = subject.caster, place_cameras(viewpoints)
    sessions = []
    for policy in policies:
        chance = policy.chance or policy.name
        spread = spawn_generator(seed, "places", chance, subject.key)
        # The viewpoints of an object share these locations, which are computed on first use.
        find_places = cache(partial(spread_far, caster.surface, PLACES, spread))
        for number in subject.viewpoints:
            generator = spawn_generator(seed, chance, subject.key, number)
            view = PolicyView(caster, cameras[number], generator, find_places)
            sessions.append(PolicySession(subject.key, number, policy, view))
    return sessions


def _try_locations(
    caster: RayCaster,
    chosen: Mapping[PolicySession, FloatArray],
    sensor: SensorParameters,
    scene: Scene,
    seed: int,
    wanted: Wanted,
    tries: Tries,
) -> None:
    """Touch the surface nearest to the chosen points, and add the results to the sessions and to `tries`."""
    sessions, points = [*chosen], np.stack([*chosen.values()])
    locations, faces = caster.nearest(points)
    for session, point, location in zip(sessions, points, locations, strict=True):
        session.check_location(point, location)
    normals = orient_outwards(caster, locations, caster.surface.face_normals[faces])
    reached = reachable(caster, locations, normals, sensor, faces)
    keeps = [(session.policy.unreachable or wanted.unreachable) == "keep" for session in sessions]
    rows = np.flatnonzero(reached | keeps)
    tries.touched += (len(tries.rows) + rows).tolist()
    tries.numbers += [sessions[row].touches for row in rows]
    for session, location, normal, face in zip(sessions, locations, normals, faces, strict=True):
        tries.rows.append(session.row(location, normal, face))
        session.felt.append(Felt(location, normal, acquired=False))
    if not len(rows):
        return
    fields = RandomFields(seed, [sessions[row].touch_key for row in rows])
    touches = touch(caster, locations[rows], normals[rows], sensor, scene, fields, faces[rows])
    tries.batches.append(touches)
    for index, row in enumerate(rows):
        sessions[row].felt[-1] = Felt(
            locations[row],
            touches.normals[index],
            bool(reached[row]),
            touches.images[index],
            float(touches.size[index]),
            str(touches.contact_state[index]),
        )
        sessions[row].touches += 1


def _log(sessions: Sequence[PolicySession], wanted: int) -> None:
    """Log the policies that stopped early, and the policies that took long to choose."""
    for name, group in groupby(sessions, key=lambda session: session.policy.name):
        of_policy = list(group)
        stopped = ", ".join(str(session.viewpoint) for session in of_policy if session.stopped)
        if stopped:
            logger.warning(
                "policy %s stopped before touch %d of %s, viewpoints %s.",
                name, wanted, of_policy[0].key, stopped,
            )  # fmt: skip
        seconds = sum(session.seconds for session in of_policy)
        choices = sum(len(session.felt) + session.stopped for session in of_policy)
        if seconds > SLOW_SECONDS * choices:
            logger.warning(
                "policy %s took %.1f s for %d choices on %s.",
                name, seconds, choices, of_policy[0].key,
            )  # fmt: skip


def _written(point: FloatArray) -> str:
    return f"({', '.join(f'{value:.3g}' for value in point)})"
