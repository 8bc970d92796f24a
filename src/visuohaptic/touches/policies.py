"""Drive policies: every viewpoint chooses its next place, then one batch of rays touches these places."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Mapping, Sequence
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
from visuohaptic.touches.choosing import Wanted, choose_places, numbered
from visuohaptic.touches.touching import Part, touch_part, touch_table

FARTHEST = 0.1
"""A chosen point may be so far off the surface, object radii."""

SAME_PLACE = 1e-6
"""Points that are as near to each other, object radii, are one place."""

SLOW_SECONDS = 1.0
"""Mean seconds per choice above which a policy's time is logged."""

logger = logging.getLogger(__name__)


@dataclass(eq=False)
class Hand:
    """A policy at one viewpoint of an object, `class/name`, and what it felt so far.

    `clock` returns seconds. Wall time, because a policy that waits for a device, a server or a lock needs no
    processor time.
    """

    key: str
    viewpoint: int
    policy: Policy
    view: PolicyView
    felt: list[Felt] = field(default_factory=list)
    touches: int = 0
    stopped: bool = False
    seconds: float = 0.0
    clock: Callable[[], float] = time.perf_counter

    def goes_on(self, wanted: int) -> bool:
        """Return whether another place is asked for: as long as `choosing.choose_places` would take it."""
        passed_over = len(self.felt) - self.touches
        return not self.stopped and self.touches < wanted and passed_over <= SPARE

    def choose(self) -> FloatArray | None:
        """Ask the policy for its next point (3,), object frame; None if it stops.

        Raises `PolicyError` if the policy raises, takes longer than its bound, or chooses no point.
        """
        started = self.clock()
        try:
            chosen = self.policy.next_location(self.view, tuple(self.felt))
        except Exception as error:
            said = " ".join(str(error).split()).rstrip(".")
            raise self._error(f"raised {type(error).__name__}: {said}") from error
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
        return self._checked(chosen)

    def check_place(self, chosen: FloatArray, place: FloatArray) -> None:
        """Raise `PolicyError` if a chosen point is too far off its nearest place, or that place was chosen before."""
        distance = float(np.linalg.norm(chosen - place))
        if distance > FARTHEST:
            raise self._error(
                f"chose {_written(chosen)}, {distance:.2g} object radii off the surface; at most {FARTHEST} is "
                "allowed, in the object frame"
            )
        for number, earlier in enumerate(self.felt):
            if np.linalg.norm(earlier.point - place) <= SAME_PLACE:
                raise self._error(
                    f"chose {_written(place)}, the place of try {number}; a new place, or None to stop, is needed"
                )

    @property
    def touch_key(self) -> tuple[object, ...]:
        """The names of the next touch's random numbers, as `touching.random_fields` gives them."""
        return (
            *self.key.split("/"),
            self.viewpoint,
            self.policy.chance or self.policy.name,
            self.touches,
        )

    def row(self, point: FloatArray, normal: FloatArray, face: int) -> dict[str, object]:
        """Return the row of `tables.FIXATIONS` of the next try."""
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
class Record:
    """All tries of an object, rows of `tables.FIXATIONS`, and the touches at m of them.

    `touched` are the m tries by index, `numbers` each hand's touches before, `felt` the touches in batches.
    """

    tries: list[dict[str, object]] = field(default_factory=list)
    touched: list[int] = field(default_factory=list)
    numbers: list[int] = field(default_factory=list)
    felt: list[Touches] = field(default_factory=list)

    def tables(self) -> tuple[pa.Table, Part]:
        """Return the tries as `tables.FIXATIONS`, and the touches, both sorted by their keys."""
        located = build_rows(FIXATIONS, self.tries)
        if not self.felt:
            return located, Part(TOUCHES.arrow.empty_table(), ())
        places = located.take(self.touched)
        ranks, felt = places.column("touch").to_numpy(), join_touches(self.felt)
        touches = touch_table(numbered(places, np.array(self.numbers)), felt, ranks)
        return join_parts(FIXATIONS, [located]), Part(join_parts(TOUCHES, [touches]), felt.effects)


class Followed(NamedTuple):
    """Where policies chose to touch, rows of `tables.FIXATIONS`, the touches, and the seconds of choosing."""

    located: pa.Table
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
) -> Followed:
    """Touch an object by policies, one try of each viewpoint and policy at a time, until none goes on.

    A place out of reach is no touch where such places are replaced; the policy is told. A sequence ends
    after `SPARE` + 1 such places, or where the policy stops.

    Raises
    ------
    PolicyError
        If a policy raises, takes longer than its bound, or chooses a place off the surface or one that it
        chose before.
    """
    caster = subject.caster
    hands = make_hands(subject, [policy_of(name) for name in policies], viewpoints, seed)
    record = Record()
    while choosing := [hand for hand in hands if hand.goes_on(wanted.touches)]:
        chosen = {hand: point for hand in choosing if (point := hand.choose()) is not None}
        if chosen:
            _try_places(caster, chosen, sensor, scene, seed, wanted, record)
    _log(hands, wanted.touches)
    located, part = record.tables()
    is_short = any(0 < hand.touches < wanted.touches for hand in hands)
    if is_short and wanted.when_exhausted == "begin_again":
        places, ranks = choose_places(caster, located, sensor, wanted)
        part = touch_part(caster, places, sensor, scene, seed, ranks)
    return Followed(located, part, sum(hand.seconds for hand in hands))


def make_hands(
    subject: Subject, policies: Sequence[Policy], viewpoints: ViewpointParameters, seed: int
) -> list[Hand]:
    """Make a hand for each viewpoint of an object and each policy; nothing is felt yet."""
    caster, cameras = subject.caster, place_cameras(viewpoints)
    hands = []
    for policy in policies:
        chance = policy.chance or policy.name
        spread = spawn_generator(seed, "places", chance, subject.key)
        # The viewpoints of an object share the places, which are made on first use.
        find_places = cache(partial(spread_far, caster.surface, PLACES, spread))
        for number in subject.viewpoints:
            generator = spawn_generator(seed, chance, subject.key, number)
            view = PolicyView(caster, cameras[number], generator, find_places)
            hands.append(Hand(subject.key, number, policy, view))
    return hands


def _try_places(
    caster: RayCaster,
    chosen: Mapping[Hand, FloatArray],
    sensor: SensorParameters,
    scene: Scene,
    seed: int,
    wanted: Wanted,
    record: Record,
) -> None:
    """Touch the surface's places nearest to the points that hands chose; hands and record take what was felt."""
    hands, points = [*chosen], np.stack([*chosen.values()])
    places, faces = caster.nearest(points)
    for hand, point, place in zip(hands, points, places, strict=True):
        hand.check_place(point, place)
    normals = orient_outwards(caster, places, caster.surface.face_normals[faces])
    reached = reachable(caster, places, normals, sensor, faces)
    keeps = [(hand.policy.unreachable or wanted.unreachable) == "keep" for hand in hands]
    rows = np.flatnonzero(reached | keeps)
    record.touched += (len(record.tries) + rows).tolist()
    record.numbers += [hands[row].touches for row in rows]
    record.tries += [
        hand.row(*place) for hand, *place in zip(hands, places, normals, faces, strict=True)
    ]
    for hand, place, normal in zip(hands, places, normals, strict=True):
        hand.felt.append(Felt(place, normal, acquired=False))
    if not len(rows):
        return
    fields = RandomFields(seed, [hands[row].touch_key for row in rows])
    felt = touch(caster, places[rows], normals[rows], sensor, scene, fields, faces[rows])
    record.felt.append(felt)
    for index, row in enumerate(rows):
        hands[row].felt[-1] = Felt(
            places[row],
            felt.normals[index],
            bool(reached[row]),
            felt.images[index],
            float(felt.size[index]),
            str(felt.contact_state[index]),
        )
        hands[row].touches += 1


def _log(hands: Sequence[Hand], wanted: int) -> None:
    """Log which policies stopped by themselves, and which took long to choose."""
    for name, group in groupby(hands, key=lambda hand: hand.policy.name):
        found = list(group)
        stopped = ", ".join(str(hand.viewpoint) for hand in found if hand.stopped)
        if stopped:
            logger.warning(
                "policy %s stopped before touch %d of %s, viewpoints %s.",
                name, wanted, found[0].key, stopped,
            )  # fmt: skip
        seconds = sum(hand.seconds for hand in found)
        choices = sum(len(hand.felt) + hand.stopped for hand in found)
        if seconds > SLOW_SECONDS * choices:
            logger.warning(
                "policy %s took %.1f s for %d choices on %s.",
                name, seconds, choices, found[0].key,
            )  # fmt: skip


def _written(point: FloatArray) -> str:
    return f"({', '.join(f'{value:.3g}' for value in point)})"
