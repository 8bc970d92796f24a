"""Phase `touches`: touch planned places, then let policies choose where to touch."""

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
from visuohaptic.touches.choosing import Wanted, choose_places
from visuohaptic.touches.touching import Part, touch_part


@dataclass(frozen=True, eq=False)
class Acquired:
    """The tables of the phase, and the seconds of its parts by verb.

    `policy_fixations` are the places that policies chose. The touches of policies stand behind all others.
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
    """Touch an object at those of its probing locations that `choose_places` gives, and where policies choose to.

    Policies touch from the subject's viewpoints. Raises `PolicyError` if one of them fails.
    """
    parts = list[Part]()
    if fixations.num_rows:
        places, ranks = choose_places(subject.caster, fixations, sensor, wanted)
        parts.append(touch_part(subject.caster, places, sensor, scene, seed, ranks))
    if not policies:
        return _join(subject.key, parts, scene)
    # Runs without a policy do not wait for the code of strategies.
    from visuohaptic.touches.policies import follow_policies

    followed = follow_policies(subject, policies, viewpoints, sensor, scene, seed, wanted)
    acquired = _join(subject.key, [*parts, followed.part], scene)
    return replace(
        acquired, policy_fixations=followed.located, seconds={"choose": followed.seconds}
    )


def _join(key: str, parts: Sequence[Part], scene: Scene) -> Acquired:
    touches = pa.concat_tables([TOUCHES.arrow.empty_table(), *(part.touches for part in parts)])
    if not touches.num_rows:
        return Acquired()
    first = pc.min(touches.column("viewpoint")).as_py()
    records = merge_records([part.effects for part in parts if part.effects])
    return Acquired(touches, effect_table(key, first, scene.preset, records))
