"""Touches where the eye, or another strategy, chose to from viewpoints all around."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from functools import cached_property, partial

import pyarrow as pa

from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface, as_stored
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.tables.phases import EFFECTS, FEATURES, FIXATIONS, TOUCHES, VIEWS
from visuohaptic.tables.schema import join_parts

VIEWPOINTS_AT_ONCE = 8
"""Viewpoints that are worked on together; it changes no result."""

SCHEMAS = {schema.name: schema for schema in (VIEWS, FIXATIONS, TOUCHES, EFFECTS, FEATURES)}
"""The tables of an exploration."""

Steps = Sequence[Callable[[], None]]
Track = Callable[[Steps], Iterable[Callable[[], None]]]


def touch_seen_points(
    key: str, surface: Surface, parameters: ExperimentParameters, track: Track
) -> tuple[dict[str, pa.Table], dict[str, float]]:
    """Look at an object and touch it, as `TouchableObject.touch` describes it.

    Gives all tables of an exploration, the same as the workflow makes, and the seconds of each phase.
    """
    work = _Work(key, surface, parameters)
    for step in track(work.steps()):
        step()
    return work.tables(), work.seconds


class _Work:
    """The steps from a surface to features, a block of viewpoints each, and their tables."""

    def __init__(self, key: str, surface: Surface, parameters: ExperimentParameters) -> None:
        self.seconds: dict[str, float] = {}
        self._key, self._surface, self._parameters = key, surface, parameters
        self._parts: dict[str, list[pa.Table]] = {name: [] for name in SCHEMAS}

    @cached_property
    def _caster(self) -> RayCaster:
        # The workflow's surfaces come from files.
        return RayCaster(as_stored(self._surface))

    def steps(self) -> list[Callable[[], None]]:
        numbers = range(self._parameters.viewpoints.total)
        return [
            step
            for start in numbers[::VIEWPOINTS_AT_ONCE]
            for step in (
                partial(
                    self._timed, "look", self._look, numbers[start : start + VIEWPOINTS_AT_ONCE]
                ),
                partial(self._timed, "touch", self._touch),
                partial(self._timed, "describe", self._describe),
            )
        ]

    def tables(self) -> dict[str, pa.Table]:
        return {name: join_parts(SCHEMAS[name], parts) for name, parts in self._parts.items()}

    def _timed(self, phase: str, work: Callable[..., dict[str, pa.Table]], *block: range) -> None:
        started = time.perf_counter()
        for name, part in work(*block).items():
            self._parts[name].append(part)
        self.seconds[phase] = self.seconds.get(phase, 0.0) + time.perf_counter() - started

    def _look(self, block: range) -> dict[str, pa.Table]:
        from visuohaptic.fixations.files import view_tables
        from visuohaptic.fixations.locations import locate_all
        from visuohaptic.phases import look_from

        chosen = self._parameters
        looks = look_from(self._caster, self._key, chosen, block)
        views, effects = view_tables(looks)
        located = locate_all(looks, chosen.probing.strategies, chosen.attention, chosen.seed)
        return {"views": views, "effects": effects, "fixations": located}

    def _touch(self) -> dict[str, pa.Table]:
        from visuohaptic.phases import wanted_of
        from visuohaptic.touches.touching import acquire_touches

        chosen, located = self._parameters, self._parts["fixations"][-1]
        touches, effects = acquire_touches(
            self._caster,
            located,
            chosen.sensor,
            chosen.scene,
            chosen.seed,
            wanted_of(chosen),
        )
        return {"touches": touches, "effects": effects}

    def _describe(self) -> dict[str, pa.Table]:
        from visuohaptic.features.describing import describe_touches

        return {"features": describe_touches(self._parts["touches"][-1], self._parameters.features)}
