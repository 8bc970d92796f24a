"""Phase `touches`: touch the locations of strategies, then touch by policies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from visuohaptic.fixations.parameters import ViewpointParameters
from visuohaptic.geometry.subject import Subject
from visuohaptic.scene.effect_log import effect_table
from visuohaptic.scene.parameters import Scene
from visuohaptic.scene.records import merge_records
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.sensing import join_touches
from visuohaptic.tables.phases import EFFECTS, FIXATIONS, TOUCHES
from visuohaptic.tables.schema import build_rows, join_parts
from visuohaptic.touches.choosing import Wanted, choose_locations, with_touch_numbers
from visuohaptic.touches.touch_table import Part, touch_part, touch_table

if TYPE_CHECKING:
    from visuohaptic.active.sessions import Tries


@dataclass(frozen=True, eq=False)
class Acquired:
    """The tables of phase `touches`.

    Attributes
    ----------
    touches : pyarrow.Table
        Rows of `tables.TOUCHES`, with the touches of policies last.
    effects : pyarrow.Table
        Rows of `tables.EFFECTS`.
    policy_fixations : pyarrow.Table
        The locations that policies chose, rows of `tables.FIXATIONS`.
    seconds : mapping of str to float
        Seconds of parts of the phase by verb: ``choose`` is the time of the policies.
    """

    touches: pa.Table = field(default_factory=TOUCHES.arrow.empty_table)
    effects: pa.Table = field(default_factory=EFFECTS.arrow.empty_table)
    policy_fixations: pa.Table = field(default_factory=FIXATIONS.arrow.empty_table)
    seconds: Mapping[str, float] = field(default_factory=dict)


def acquire_touches(
    subject: Subject,
    fixations: pa.Table,
    sensor: SensorParameters,
    scene: Scene,
    seed: int,
    wanted: Wanted,
    viewpoints: ViewpointParameters,
    policies: tuple[str, ...],
) -> Acquired:
    """Touch an object at its probing locations, and at locations that policies choose.

    Parameters
    ----------
    subject : Subject
        The object and the viewpoints of the policies.
    fixations : pyarrow.Table
        The probing locations of strategies, rows of `tables.FIXATIONS`; `choose_locations` selects from them.
    sensor : SensorParameters
        The sensor.
    scene : Scene
        The simulated effects.
    seed : int
        Seed of the run.
    wanted : Wanted
        The touches of a sequence.
    viewpoints : ViewpointParameters
        The arrangement of the viewpoints.
    policies : tuple of str
        Names of policies.

    Returns
    -------
    Acquired
        The tables of the phase. If `wanted.when_exhausted` is ``begin_again``, a sequence that ended early repeats its
        locations in their order; a sequence without a touch stays empty.

    Raises
    ------
    PolicyError
        If a policy fails.
    """
    parts = list[Part]()
    if fixations.num_rows:
        locations, ranks = choose_locations(subject.caster, fixations, sensor, wanted)
        parts.append(touch_part(subject.caster, locations, sensor, scene, seed, ranks))
    if not policies:
        return _join(subject.key, parts, scene)
    # Imported here, so that runs without policies do not import the strategies.
    from visuohaptic.active.sessions import touch_by_policies

    tries = touch_by_policies(
        subject, policies, viewpoints, sensor, scene, seed, wanted.touches, wanted.unreachable
    )
    located, part = _tables_of(tries)
    is_short = any(0 < session.touches < wanted.touches for session in tries.sessions)
    if is_short and wanted.when_exhausted == "begin_again":
        repeated, ranks = choose_locations(subject.caster, located, sensor, wanted)
        part = touch_part(subject.caster, repeated, sensor, scene, seed, ranks)
    seconds = {"choose": sum(session.seconds for session in tries.sessions)}
    acquired = _join(subject.key, [*parts, part], scene)
    return replace(acquired, policy_fixations=located, seconds=seconds)


def _tables_of(tries: Tries) -> tuple[pa.Table, Part]:
    """Return tries as `tables.FIXATIONS`, and the touches, both sorted by their keys."""
    by_round = build_rows(FIXATIONS, tries.rows)
    located = join_parts(FIXATIONS, [by_round])
    if not tries.batches:
        return located, Part(TOUCHES.arrow.empty_table(), ())
    touched = by_round.take(tries.touched)
    ranks, felt = touched.column("touch").to_numpy(), join_touches(tries.batches)
    numbered = with_touch_numbers(touched, np.array(tries.numbers))
    return located, Part(join_parts(TOUCHES, [touch_table(numbered, felt, ranks)]), felt.effects)


def _join(key: str, parts: Sequence[Part], scene: Scene) -> Acquired:
    touches = pa.concat_tables([TOUCHES.arrow.empty_table(), *(part.touches for part in parts)])
    if not touches.num_rows:
        return Acquired()
    first = pc.min(touches.column("viewpoint")).as_py()
    records = merge_records([part.effects for part in parts if part.effects])
    return Acquired(touches, effect_table(key, first, scene.preset, records))
