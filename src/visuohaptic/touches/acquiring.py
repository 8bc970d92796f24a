"""Phase `touches`: touch the locations of strategies, then touch by policies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import pyarrow as pa
import pyarrow.compute as pc

from visuohaptic.fixations.parameters import ViewpointParameters
from visuohaptic.geometry.subject import Subject
from visuohaptic.scene.effect_log import effect_table
from visuohaptic.scene.parameters import Scene
from visuohaptic.scene.records import merge_records
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.tables.phases import EFFECTS, FIXATIONS, TOUCHES
from visuohaptic.touches.choosing import Wanted, choose_locations
from visuohaptic.touches.touching import Part, touch_part


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
        The tables of the phase.

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
    from visuohaptic.touches.policies import follow_policies

    by_policy = follow_policies(subject, policies, viewpoints, sensor, scene, seed, wanted)
    acquired = _join(subject.key, [*parts, by_policy.part], scene)
    return replace(
        acquired, policy_fixations=by_policy.fixations, seconds={"choose": by_policy.seconds}
    )


def _join(key: str, parts: Sequence[Part], scene: Scene) -> Acquired:
    touches = pa.concat_tables([TOUCHES.arrow.empty_table(), *(part.touches for part in parts)])
    if not touches.num_rows:
        return Acquired()
    first = pc.min(touches.column("viewpoint")).as_py()
    records = merge_records([part.effects for part in parts if part.effects])
    return Acquired(touches, effect_table(key, first, scene.preset, records))
