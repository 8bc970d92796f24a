"""A random walk over a surface, as of a hand that never leaves the object."""

from __future__ import annotations

import numpy as np

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.base.arrays import BoolArray, FloatArray
from visuohaptic.fixations.attended_views import Viewpoint
from visuohaptic.fixations.places import (
    BATCH,
    FRUITLESS_BATCHES,
    ProbingLocations,
    draw_by_area,
    face_outwards,
)
from visuohaptic.geometry.curvature import unit_vectors
from visuohaptic.geometry.elementary import sin_cos
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.vectors import dot

STEP = 0.3
"""Way along the surface from a touch to the next, object radii: the largest sensor's edge."""

MOVES = 8
"""Straight moves that a step is made of."""

ATTEMPTS = 64
"""Directions that are tried from a place before the walk ends there."""

_LIFT = 1e-4
# A ray that looks for what lies one move away may fall short of it by rounding.
_ROUNDING = 1e-6


def choose(
    one: Viewpoint, attention: AttentionParameters, generator: np.random.Generator
) -> ProbingLocations:
    """Walk over the object from wherever chance puts the first place."""
    return walk(one.caster, attention.fixations, generator)


def walk(caster: RayCaster, count: int, generator: np.random.Generator) -> ProbingLocations:
    """Walk over a surface at random; fewer places are the first of more, or there is no way on.

    The first place is drawn uniformly by area. Each next one lies a step of length `STEP` farther along the
    surface, in a direction drawn uniformly about the normal. A place whose way out along the normal is
    obstructed, as inside a bottle, is drawn again.

    A step is made of `MOVES` straight moves, each to what stands in its way, else to what lies below its end,
    past an edge down, at the rim of a thin sheet to its other side. The direction is carried along by the
    least rotation from normal to normal (parallel transport; K. Polthier and M. Schmies, Straightest
    geodesics on polyhedral surfaces, 1998), so that on a smooth closed surface the walk comes to every part
    in proportion to its area. Rays find the way, so faces need no connections.
    """
    places = [_first(caster, generator)]
    while places[-1] is not None and len(places) < count:
        places.append(_next(caster, places[-1], generator))
    found = [place for place in places if place is not None][:count]
    points, normals, faces = zip(*found, strict=True) if found else ([], [], [])
    return ProbingLocations(
        np.array(points, dtype=np.float64).reshape(-1, 3),
        np.array(normals, dtype=np.float64).reshape(-1, 3),
        np.array(faces, dtype=np.int64),
    )


Vector = FloatArray
Place = tuple[Vector, Vector, int]
"""A point, its outward normal, and its face."""


def _first(caster: RayCaster, generator: np.random.Generator) -> Place | None:
    for _ in range(FRUITLESS_BATCHES):
        drawn = face_outwards(caster, draw_by_area(caster.surface, BATCH, generator))
        free = np.flatnonzero(_is_open(caster, drawn.points, drawn.normals))
        if len(free):
            row = free[0]
            return drawn.points[row], drawn.normals[row], int(drawn.faces[row])
    return None


def _next(caster: RayCaster, place: Place, generator: np.random.Generator) -> Place | None:
    for angle in generator.uniform(0.0, 2.0 * np.pi, ATTEMPTS):
        found = _step(caster, place, _tangent(place[1], angle))
        if found is not None and _is_open(caster, found[0][None], found[1][None])[0]:
            return found
    return None


def _step(caster: RayCaster, place: Place, direction: Vector) -> Place | None:
    for _ in range(MOVES):
        moved = _move(caster, place, direction)
        if moved is None:
            return None
        place, direction = moved
    return place


def _move(caster: RayCaster, place: Place, direction: Vector) -> tuple[Place, Vector] | None:
    """Move straight on; give the place and the direction there, or nothing where no way is found."""
    point, normal, _ = place
    length = STEP / MOVES
    above = point + _LIFT * normal
    below = point - length * normal
    ahead = length * direction
    origins = np.stack([above, above + ahead, below + ahead, below])
    directions = np.stack([direction, -normal, -direction, normal])
    farthest = np.array([length, length + _LIFT, length, length]) * (1.0 + _ROUNDING)
    hits = caster.first_hits(origins, directions)
    faces = np.where(hits.hit, hits.face, 0)
    sides = np.einsum("nd,nd->n", caster.surface.face_normals[faces], directions)
    met = np.flatnonzero(hits.hit & (hits.distance <= farthest) & (sides != 0.0))
    if not len(met):
        return None
    row = met[0]
    face = int(faces[row])
    turned = -np.sign(sides[row]) * caster.surface.face_normals[face]
    found = origins[row] + hits.distance[row] * directions[row]
    return (found, turned, face), _carry(direction, normal, turned)


def _carry(direction: Vector, before: Vector, after: Vector) -> Vector:
    """Turn a tangent by the least rotation from a normal to another; right round, it goes back."""
    half = 1.0 + dot(before, after)
    if half < _ROUNDING:
        return -direction
    turned = direction - dot(direction, after) / half * (before + after)
    turned -= dot(turned, after) * after
    return unit_vectors(turned)


def _tangent(normal: Vector, angle: float) -> Vector:
    """Give the unit tangent at an angle from one that depends on the normal alone."""
    axis = np.eye(3)[np.argmin(np.abs(normal))]
    first = unit_vectors(np.cross(normal, axis))
    sine, cosine = sin_cos(angle)
    return cosine * first + sine * np.cross(normal, first)


def _is_open(caster: RayCaster, points: FloatArray, normals: FloatArray) -> BoolArray:
    return ~caster.first_hits(points + _LIFT * normals, normals).hit
