"""Touch an object at locations that a strategy chooses from viewpoints around it, or at given points."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from visuohaptic.active.policies import FARTHEST_POINT, MAX_SURFACE_DISTANCE
from visuohaptic.base.errors import ParameterError
from visuohaptic.exploration.checking import point_rows, unit_rows
from visuohaptic.exploration.recognising import GIVEN
from visuohaptic.fixations.locations import location_table
from visuohaptic.fixations.places import ProbingLocations
from visuohaptic.geometry.orientation import orient_outwards
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.subject import Subject
from visuohaptic.geometry.surface import Surface, as_stored
from visuohaptic.io.phase_files import SCHEMAS as OF_PHASES
from visuohaptic.io.phase_files import Tables
from visuohaptic.parameters import MOST_SENSING_POINTS, ExperimentParameters
from visuohaptic.phases import OF_OBJECT, Phase, phases_after
from visuohaptic.pipeline import blocks_of, run_phase, touch_all_locations
from visuohaptic.tables.schema import join_parts

_BY_POLICIES = "policy_fixations"

SCHEMAS = {
    name: OF_PHASES[name] for phase in OF_OBJECT for name in phase.writes if name != _BY_POLICIES
}
"""The tables of an exploration; ``fixations`` also has the locations that policies chose."""

_WRITTEN = (*SCHEMAS, _BY_POLICIES)

Steps = Sequence[Callable[[], None]]
Track = Callable[[Steps], Iterable[Callable[[], None]]]
Explored = tuple[Tables, dict[str, float]]
"""Tables of an exploration by name, and wall time by verb of the phase and ``choose`` of policies (s)."""


def touch_seen_points(
    key: str, surface: Surface, parameters: ExperimentParameters, track: Track
) -> Explored:
    """Choose probing locations by the strategy of `parameters`, and touch them; see `TouchableObject.touch`."""
    # The workflow's surfaces come from files.
    find_caster = lambda: RayCaster(as_stored(surface))  # noqa: E731
    subject = Subject(key, find_caster, range(parameters.viewpoints.total))
    return _explore(blocks_of(subject, parameters), parameters, {}, track)


def touch_given_points(
    key: str,
    surface: Surface,
    at: ArrayLike,
    normals: ArrayLike | None,
    parameters: ExperimentParameters,
) -> Explored:
    """Touch an object at given points (n, 3) without rendering views; see `TouchableObject.touch`.

    Raises `ParameterError` if n is 0, points or normals are not finite numbers of this shape, a normal has length 0,
    or a point is farther from the surface than `MAX_SURFACE_DISTANCE`.
    """
    subject = Subject(key, lambda: RayCaster(surface))
    locations, parameters = nearest_locations(subject.caster, at, normals, parameters)
    fixations = location_table(key, {(0, GIVEN): locations})
    return _explore([subject], touch_all_locations(parameters, fixations), {"fixations": fixations})


def nearest_locations(
    caster: RayCaster, at: ArrayLike, normals: ArrayLike | None, parameters: ExperimentParameters
) -> tuple[ProbingLocations, ExperimentParameters]:
    """Return the points of the surface nearest to given points (n, 3), and the parameters for touching them.

    With `normals`, the parameters have ``sensor.normal`` set to ``given``.
    Raises `ParameterError` as `touch_given_points` does.
    """
    points = point_rows(at, "at", FARTHEST_POINT)
    if not len(points):
        raise ParameterError("at has no points; at least one is needed.")
    taxels = parameters.sensor.taxels
    count = len(points) * len(taxels)
    if count > MOST_SENSING_POINTS:
        raise ParameterError(
            f"{len(points)} touches of {' x '.join(map(str, taxels.shape))} have {count} sensing points; "
            f"{MOST_SENSING_POINTS} are allowed: touch in several calls."
        )
    nearest, faces = caster.nearest(points)
    distances = np.linalg.norm(points - nearest, axis=1)
    off = np.flatnonzero(distances > MAX_SURFACE_DISTANCE)
    if len(off):
        raise ParameterError(
            f"point {off[0]} of at is {distances[off[0]]:.2g} object radii off the surface; at most "
            f"{MAX_SURFACE_DISTANCE} is allowed, in the object frame, in which `surface.vertices` are."
        )
    if normals is None:
        outwards = orient_outwards(caster, nearest, caster.surface.face_normals[faces])
        return ProbingLocations(nearest, outwards, faces), parameters
    outwards = unit_rows(normals, "normals", len(points))
    # The sensor points along the caller's normals instead of along those of the faces.
    sensor = parameters.sensor.model_copy(update={"normal": "given"})
    return ProbingLocations(nearest, outwards, faces), parameters.model_copy(
        update={"sensor": sensor}
    )


def _explore(
    blocks: Iterable[Subject], parameters: ExperimentParameters, known: Tables, track: Track = iter
) -> Explored:
    """Run the phases after those of the tables in `known` on blocks of viewpoints."""
    parts = {name: [known.get(name, OF_PHASES[name].arrow.empty_table())] for name in _WRITTEN}
    seconds: dict[str, float] = {}

    def step(phase: Phase, block: Subject) -> None:
        started = time.perf_counter()
        # The last part of each table is this block's.
        last = {name: part[-1] for name, part in parts.items()}
        result = run_phase(phase, block, last, parameters)
        for name in phase.writes:
            parts[name].append(getattr(result, name))
        parts_of_phase = getattr(result, "seconds", {})
        whole = time.perf_counter() - started
        own = {str(phase.verb): max(whole - sum(parts_of_phase.values()), 0.0)}
        for verb, taken in {**own, **parts_of_phase}.items():
            seconds[verb] = seconds.get(verb, 0.0) + taken

    steps = [partial(step, phase, block) for block in blocks for phase in phases_after(known)]
    for work in track(steps):
        work()
    parts["fixations"] += parts.pop(_BY_POLICIES)
    return {name: join_parts(SCHEMAS[name], part) for name, part in parts.items()}, seconds
