"""The phases in memory, one after the other: where to touch, then touch, then describe."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import pyarrow as pa

from visuohaptic.features.describing import describe_touches
from visuohaptic.fixations.locations import Look, Standpoint, locate_all, look
from visuohaptic.fixations.probing import STRATEGIES
from visuohaptic.fixations.viewpoints import place_cameras
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.touches.choosing import Wanted
from visuohaptic.touches.touching import acquire_touches

VIEWS_AT_ONCE = 4
"""Viewpoints that are looked from together; it changes no result."""


def look_from(
    caster: RayCaster, key: str, parameters: ExperimentParameters, viewpoints: Sequence[int]
) -> list[Look]:
    """Look at an object from numbered viewpoints, all of them at once."""
    placed = place_cameras(parameters.viewpoints)
    cameras = {number: placed[number] for number in viewpoints}
    rendering, attention = parameters.rendering, parameters.attention
    return look(caster, key, cameras, rendering, attention, parameters.scene.effects)


def find_locations(
    caster: RayCaster,
    key: str,
    parameters: ExperimentParameters,
    viewpoints: Sequence[int] | None = None,
    looking: Callable[..., list[Look]] = look_from,
) -> pa.Table:
    """Look at an object if a strategy needs it, and give where to touch it.

    Parameters
    ----------
    caster : RayCaster
        The object.
    key : str
        `class/name` of the object.
    parameters : ExperimentParameters
        How to look, and by which strategies to choose.
    viewpoints : sequence of int, optional
        Numbers of the viewpoints; all without it.
    looking : callable, optional
        Looks from some of the viewpoints at once, with the arguments of `look_from`.

    Returns
    -------
    pyarrow.Table
        Rows of `tables.FIXATIONS`, the same as the workflow finds.
    """
    numbers = range(parameters.viewpoints.total) if viewpoints is None else viewpoints
    strategies, attention = parameters.probing.strategies, parameters.attention
    if not any(STRATEGIES[name].looks for name in strategies):
        placed = place_cameras(parameters.viewpoints)
        stands = [Standpoint(key, number, caster, placed[number]) for number in numbers]
        return locate_all(stands, strategies, attention, parameters.seed).combine_chunks()
    parts = []
    for start in range(0, len(numbers), VIEWS_AT_ONCE):
        looks = looking(caster, key, parameters, numbers[start : start + VIEWS_AT_ONCE])
        parts.append(locate_all(looks, strategies, attention, parameters.seed))
    return pa.concat_tables(parts).combine_chunks()


def touch_at(caster: RayCaster, locations: pa.Table, parameters: ExperimentParameters) -> pa.Table:
    """Touch an object at those of its probing locations that are chosen: rows of `tables.TOUCHES`."""
    sensor, scene, wanted = parameters.sensor, parameters.scene, wanted_of(parameters)
    return acquire_touches(caster, locations, sensor, scene, parameters.seed, wanted)[0]


def wanted_of(parameters: ExperimentParameters) -> Wanted:
    """Give what an experiment wants of each sequence of touches."""
    probing = parameters.probing
    return Wanted(parameters.attention.fixations, probing.unreachable, probing.when_exhausted)


def describe_at(
    caster: RayCaster, locations: pa.Table, parameters: ExperimentParameters
) -> pa.Table:
    """Touch an object and describe its touches: rows of `tables.FEATURES`."""
    return describe_touches(touch_at(caster, locations, parameters), parameters.features)
