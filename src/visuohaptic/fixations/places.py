"""Probing locations on a surface: random draws, visibility and direction of normals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.base.errors import RegistryError
from visuohaptic.fixations.viewpoints import Camera
from visuohaptic.geometry.orientation import orient_outwards
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface

SEEN_TOLERANCE = 1e-5
"""A point is hidden if a surface is nearer to the camera by more than this share of the point's distance."""

BATCH = 256
"""Points per draw where points may be rejected. The number is constant, so that fewer locations are a prefix of more."""

FRUITLESS_BATCHES = 64
"""Rejected batches in a row after which drawing ends."""

Unreachable = Literal["replace", "skip", "keep"]
"""Treatment of a location out of the sensor's reach.

``replace``: the next location is touched instead. ``skip``: no location is touched instead, so the sequence is shorter.
``keep``: the sensor comes as near as it can.
"""


def check_unreachable(owner: str, value: object) -> None:
    """Raise `RegistryError` about `owner` if the treatment of locations out of reach is unknown."""
    if value is not None and value not in get_args(Unreachable):
        raise RegistryError(
            f"{owner}: unreachable is {value!r}; 'replace', 'skip', 'keep' or None is allowed."
        )


@dataclass(frozen=True)
class ProbingLocations:
    """Points to touch, in order.

    Attributes
    ----------
    points : ndarray of shape (n, 3), float64
        The points, object frame.
    normals : ndarray of shape (n, 3), float64
        Unit normals of the surface there.
    faces : ndarray of shape (n,), int64
        The face of each point.
    is_turned : bool
        Whether the normals point out of the object or towards a camera, not to an arbitrary side.
    """

    points: FloatArray
    normals: FloatArray
    faces: IntArray
    is_turned: bool = True

    def take(self, indices: IntArray) -> ProbingLocations:
        """Return the locations at `indices`, in that order."""
        points, normals, faces = self.points[indices], self.normals[indices], self.faces[indices]
        return ProbingLocations(points, normals, faces, self.is_turned)


def draw_by_area(surface: Surface, count: int, generator: np.random.Generator) -> ProbingLocations:
    """Draw points uniformly by area over a surface, including hidden parts.

    A smaller `count` returns a prefix of the same points. A triangle is drawn by its share of the area, a point in
    the triangle by the square-root map of the unit square (Osada et al., ACM Trans. Graph. 21(4), 2002, eq. 1). The
    normals are those of the faces, which are not turned.
    """
    cumulative = np.cumsum(surface.face_areas)
    drawn, outer, along = generator.random((count, 3)).T
    faces = np.searchsorted(cumulative, drawn * cumulative[-1], side="right")
    faces = np.minimum(faces, len(cumulative) - 1)
    root = np.sqrt(outer)
    weights = np.column_stack([1 - root, root * (1 - along), root * along])
    points = np.einsum("nc,nck->nk", weights, surface.triangles[faces])
    return ProbingLocations(points, surface.face_normals[faces], faces, is_turned=False)


def is_visible(caster: RayCaster, camera: Camera, points: FloatArray) -> BoolArray:
    """Return whether each point of a surface, shape (n, 3), is inside a camera's square view and not hidden."""
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
    """Flip normals that point away from a camera."""
    towards = camera.eye - locations.points
    if camera.projection == "orthographic":
        towards = np.broadcast_to(camera.axes[2], locations.points.shape)
    away = np.einsum("nd,nd->n", locations.normals, towards) < 0
    normals = np.where(away[:, None], -locations.normals, locations.normals)
    return ProbingLocations(locations.points, normals, locations.faces)


def face_outwards(caster: RayCaster, parts: Sequence[ProbingLocations]) -> list[ProbingLocations]:
    """Flip normals that point into the object. Rays of all parts are cast together; no result depends on another."""
    if not parts:
        return []
    points, normals = (
        np.concatenate([getattr(part, name) for part in parts]) for name in ("points", "normals")
    )
    ends = np.cumsum([len(part.faces) for part in parts])
    outwards = np.split(orient_outwards(caster, points, normals), ends[:-1])
    return [
        ProbingLocations(part.points, turned, part.faces)
        for part, turned in zip(parts, outwards, strict=True)
    ]


def nearest_places(caster: RayCaster, points: FloatArray) -> ProbingLocations:
    """Return the places of the surface nearest to points (n, 3), with outward normals of their faces."""
    nearest, faces = caster.nearest(points)
    outwards = orient_outwards(caster, nearest, caster.surface.face_normals[faces])
    return ProbingLocations(nearest, outwards, faces)
