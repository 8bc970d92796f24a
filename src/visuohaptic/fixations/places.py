"""Points of a surface to touch, and what a camera sees of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.fixations.viewpoints import Camera
from visuohaptic.geometry.orientation import orient_outwards
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface

SEEN_TOLERANCE = 1e-5
"""How much nearer than a point, as a share of its distance, what hides it must be."""

BATCH = 256
"""Points that are drawn at a time where only some are kept; it must not depend on how many are asked for."""

FRUITLESS_BATCHES = 64
"""Batches in a row without a kept point, after which nothing is expected any more."""


@dataclass(frozen=True)
class ProbingLocations:
    """Points (n, 3) to touch, in order, object frame, with unit normals (n, 3) and the face (n,) of each."""

    points: FloatArray
    normals: FloatArray
    faces: IntArray

    def take(self, places: IntArray) -> ProbingLocations:
        """Give some of the locations, in the order of their places."""
        return ProbingLocations(self.points[places], self.normals[places], self.faces[places])


def draw_by_area(surface: Surface, count: int, generator: np.random.Generator) -> ProbingLocations:
    """Draw points uniformly over a surface, by area, hidden parts too; fewer are the first of more.

    A triangle is drawn by its share of the area, a point in it by the square-root map of the unit square
    (Osada et al., ACM Trans. Graph. 21(4), 2002, eq. 1).
    """
    cumulative = np.cumsum(surface.face_areas)
    drawn, outer, along = generator.random((count, 3)).T
    faces = np.searchsorted(cumulative, drawn * cumulative[-1], side="right")
    faces = np.minimum(faces, len(cumulative) - 1)
    root = np.sqrt(outer)
    weights = np.column_stack([1 - root, root * (1 - along), root * along])
    points = np.einsum("nc,nck->nk", weights, surface.triangles[faces])
    return ProbingLocations(points, surface.face_normals[faces], faces)


def sees(caster: RayCaster, camera: Camera, points: FloatArray) -> BoolArray:
    """Find which points of a surface, shape (n, 3), are within a camera's square view, and not hidden."""
    offsets = points - camera.eye
    across, along, towards = np.einsum("nd,kd->kn", offsets, camera.axes)
    depth = -towards
    half = 0.5 * camera.view_height / camera.distance
    reach = half * (camera.distance if camera.projection == "orthographic" else depth)
    within = (np.abs(across) <= reach) & (np.abs(along) <= reach) & (depth > 0)
    eyes = np.broadcast_to(camera.eye, points.shape)
    if camera.projection == "orthographic":
        eyes = points + depth[:, None] * camera.axes[2]
    distance = caster.first_hits(eyes, points - eyes).distance
    return within & (distance >= 1.0 - SEEN_TOLERANCE)


def turn_towards(locations: ProbingLocations, camera: Camera) -> ProbingLocations:
    """Turn normals to a camera that sees the points; one edge-on to it stays as it is."""
    towards = camera.eye - locations.points
    if camera.projection == "orthographic":
        towards = np.broadcast_to(camera.axes[2], locations.points.shape)
    away = np.einsum("nd,nd->n", locations.normals, towards) < 0
    normals = np.where(away[:, None], -locations.normals, locations.normals)
    return ProbingLocations(locations.points, normals, locations.faces)


def face_outwards(caster: RayCaster, locations: ProbingLocations) -> ProbingLocations:
    """Turn normals to the outside of an object."""
    outwards = orient_outwards(caster, locations.points, locations.normals)
    return ProbingLocations(locations.points, outwards, locations.faces)
