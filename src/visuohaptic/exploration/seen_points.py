"""Touches where the eye, or another strategy, chose to from viewpoints all around."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from functools import partial

from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.subject import Subject
from visuohaptic.geometry.surface import Surface, as_stored
from visuohaptic.one_phase import SCHEMAS as OF_PHASES
from visuohaptic.one_phase import Tables
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.pipeline import OF_OBJECT, VIEWPOINTS_AT_ONCE, Phase, after
from visuohaptic.tables.schema import join_parts

SCHEMAS = {name: OF_PHASES[name] for phase in OF_OBJECT for name in phase.writes}
"""The tables of an exploration."""

Steps = Sequence[Callable[[], None]]
Track = Callable[[Steps], Iterable[Callable[[], None]]]


def touch_seen_points(
    key: str, surface: Surface, parameters: ExperimentParameters, track: Track
) -> tuple[Tables, dict[str, float]]:
    """Look at an object and touch it: all tables, as the workflow makes them, and each phase's seconds."""
    # The workflow's surfaces come from files.
    find_caster = lambda: RayCaster(as_stored(surface))  # noqa: E731
    subject = Subject(key, find_caster, range(parameters.viewpoints.total))
    return explore(subject.blocks(VIEWPOINTS_AT_ONCE), parameters, {}, track)


def explore(
    blocks: Iterable[Subject], parameters: ExperimentParameters, known: Tables, track: Track = iter
) -> tuple[Tables, dict[str, float]]:
    """Take blocks of viewpoints through the phases behind the tables that are known."""
    parts = {name: [known[name]] if name in known else [] for name in SCHEMAS}
    seconds: dict[str, float] = {}

    def step(phase: Phase, block: Subject) -> None:
        started = time.perf_counter()
        # The last part of each table is this block's.
        tables = {name: found[-1] for name, found in parts.items() if found}
        found = phase.run(block, tables, parameters)
        for name in phase.writes:
            parts[name].append(getattr(found, name))
        verb = str(phase.verb)
        seconds[verb] = seconds.get(verb, 0.0) + time.perf_counter() - started

    steps = [partial(step, phase, block) for block in blocks for phase in after(known)]
    for work in track(steps):
        work()
    empty = {name: [schema.arrow.empty_table()] for name, schema in SCHEMAS.items()}
    tables = {name: join_parts(SCHEMAS[name], parts[name] or empty[name]) for name in SCHEMAS}
    return tables, seconds
