"""Strategy `random_walk`: a random walk over the surface, as of a hand that stays in contact."""

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
"""Length of a step along the surface, object radii: the edge of the largest sensor."""

MOVES = 8
"""Straight moves per step."""

ATTEMPTS = 64
"""Directions that are tried from a location before the walk ends."""

# Height above the surface at which rays start, object radii.
_LIFT = 1e-4
# Rounding may put a hit slightly beyond the length of a move.
_ROUNDING = 1e-6


def choose(
    viewpoint: Viewpoint, attention: AttentionParameters, generator: np.random.Generator
) -> ProbingLocations:
    """Walk over the object from a random location."""
    return walk(viewpoint.caster, attention.fixations, generator)


def walk(caster: RayCaster, count: int, generator: np.random.Generator) -> ProbingLocations:
    """Walk over a surface at random.

    The first location is drawn uniformly by area. The next location is a step of length `STEP` along the surface
    away, in a direction that is drawn uniformly about the normal. A location that is obstructed along its normal,
    as inside a bottle, is drawn again.

    A step has `MOVES` straight moves. A move ends at the surface in its way; without an obstacle on the surface
    below its end, down an edge, or on the other side of a thin sheet. The direction follows the smallest rotation
    between the normals (parallel transport; K. Polthier and M. Schmies, Straightest geodesics on polyhedral
    surfaces, 1998). So the walk visits every part of a smooth closed surface in proportion to its area. The moves
    are rays, so faces need not be connected.

    Parameters
    ----------
    caster : RayCaster
        The surface, prepared for rays.
    count : int
        Number of locations; a smaller number returns a prefix of the same walk.
    generator : numpy.random.Generator
        Source of the random numbers.

    Returns
    -------
    ProbingLocations
        The locations with outward normals; fewer than `count` if the walk finds no way on.
    """
    steps = [_first(caster, generator)]
    while steps[-1] is not None and len(steps) < count:
        steps.append(_next(caster, steps[-1], generator))
    locations = [location for location in steps if location is not None][:count]
    points, normals, faces = zip(*locations, strict=True) if locations else ([], [], [])
    return ProbingLocations(
        np.array(points, dtype=np.float64).reshape(-1, 3),
        np.array(normals, dtype=np.float64).reshape(-1, 3),
        np.array(faces, dtype=np.int64),
    )


Vector = FloatArray
Location = tuple[Vector, Vector, int]
"""A point, its outward normal, and its face."""


def _first(caster: RayCaster, generator: np.random.Generator) -> Location | None:
    for _ in range(FRUITLESS_BATCHES):
        (drawn,) = face_outwards(caster, [draw_by_area(caster.surface, BATCH, generator)])
        free = np.flatnonzero(_is_open(caster, drawn.points, drawn.normals))
        if len(free):
            row = free[0]
            return drawn.points[row], drawn.normals[row], int(drawn.faces[row])
    return None


def _next(caster: RayCaster, location: Location, generator: np.random.Generator) -> Location | None:
    for angle in generator.uniform(0.0, 2.0 * np.pi, ATTEMPTS):
        reached = _step(caster, location, _tangent(location[1], angle))
        if reached is not None and _is_open(caster, reached[0][None], reached[1][None])[0]:
            return reached
    return None


def _step(caster: RayCaster, location: Location, direction: Vector) -> Location | None:
    for _ in range(MOVES):
        moved = _move(caster, location, direction)
        if moved is None:
            return None
        location, direction = moved
    return location


def _move(
    caster: RayCaster, location: Location, direction: Vector
) -> tuple[Location, Vector] | None:
    """Return location and direction after a straight move; None without a way on."""
    point, normal, _ = location
    length = STEP / MOVES
    # Four rays in order of preference: ahead; down at the end; back below the edge; up to the other side.
    above = point + _LIFT * normal
    below = point - length * normal
    ahead = length * direction
    origins = np.stack([above, above + ahead, below + ahead, below])
    directions = np.stack([direction, -normal, -direction, normal])
    farthest = np.array([length, length + _LIFT, length, length]) * (1.0 + _ROUNDING)
    hits = caster.first_hits(origins, directions)
    faces = np.where(hits.hit, hits.face, 0)
    sides = np.einsum("nd,nd->n", caster.surface.face_normals[faces], directions)
    near_hits = np.flatnonzero(hits.hit & (hits.distance <= farthest) & (sides != 0.0))
    if not len(near_hits):
        return None
    row = near_hits[0]
    face = int(faces[row])
    new_normal = -np.sign(sides[row]) * caster.surface.face_normals[face]
    new_point = origins[row] + hits.distance[row] * directions[row]
    return (new_point, new_normal, face), _carry(direction, normal, new_normal)


def _carry(direction: Vector, before: Vector, after: Vector) -> Vector:
    """Turn a tangent by the smallest rotation between two normals; opposite normals reverse the tangent."""
    half = 1.0 + dot(before, after)
    if half < _ROUNDING:
        return -direction
    turned = direction - dot(direction, after) / half * (before + after)
    turned -= dot(turned, after) * after
    return unit_vectors(turned)


def _tangent(normal: Vector, angle: float) -> Vector:
    """Return the unit tangent at an angle, radians, from a reference tangent that depends only on the normal."""
    axis = np.eye(3)[np.argmin(np.abs(normal))]
    first = unit_vectors(np.cross(normal, axis))
    sine, cosine = sin_cos(angle)
    return cosine * first + sine * np.cross(normal, first)


def _is_open(caster: RayCaster, points: FloatArray, normals: FloatArray) -> BoolArray:
    return ~caster.first_hits(points + _LIFT * normals, normals).hit
