"""The terms: planes of the gaze model that depend on the surface, on the grid of the maps."""

from __future__ import annotations

from dataclasses import dataclass, field

import cv2
import numpy as np
from numpy.typing import NDArray

from .planes import Plane
from .pyramid import BORDER_ZERO, reciprocal, reduce, to_working_size

SEEN = 0.25
"""A grid cell counts as seen if the object covers more than this share of it."""

SMALLEST_LENGTH = 1e-9
"""Least divisor of a vector, so that vectors of length 0 stay 0."""


@dataclass(frozen=True)
class SeenSurface:
    """The visible part of a surface, averaged over the object in each cell of the maps' grid.

    Attributes
    ----------
    point : ndarray of shape (n, n, 3), float32
        Points, object frame: y up, z to the front; zero off the object.
    normal : ndarray of shape (n, n, 3), float32
        Unit normals, object frame; zero off the object.
    certainty : ndarray of shape (n, n), float32
        Share of each cell that the object covers.
    facing : ndarray of shape (n, n), float32
        Absolute cosine between the normal and the direction to the eye, 0 to 1.
    sight : ndarray of shape (3,), float32
        Unit vector from the eye to the middle of the visible part.
    cell : float
        Width of a cell in the unit of the points.
    protrusions : dict
        Results of `protrusion` by its reach: two terms use each of them.
    """

    point: Plane
    normal: Plane
    certainty: Plane
    facing: Plane
    sight: Plane
    cell: float
    protrusions: dict[float, Plane] = field(default_factory=dict, repr=False)


def prepare_surface(
    mask: NDArray[np.bool_],
    point: NDArray[np.float64],
    normal: NDArray[np.float64],
    eye: NDArray[np.float64],
) -> SeenSurface:
    """Average the surface of a view over the cells of the maps' grid.

    `mask`, `point` and `normal` are as for `attend`, without the axis of views; `eye` (3,) is in the object frame.
    """
    cover = mask.astype(np.float32)
    certainty = reduce(to_working_size(cover))
    normaliser = reciprocal(certainty)[..., None]
    covers = cover[..., None]
    points = reduce(to_working_size(point.astype(np.float32) * covers)) * normaliser
    normals = reduce(to_working_size(normal.astype(np.float32) * covers)) * normaliser
    normals /= np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), SMALLEST_LENGTH)
    towards = eye.astype(np.float32) - points
    towards /= np.maximum(np.linalg.norm(towards, axis=2, keepdims=True), SMALLEST_LENGTH)
    seen = certainty > SEEN
    offset = _middle(points, seen) - eye.astype(np.float32)
    sight = (offset / max(float(np.linalg.norm(offset)), SMALLEST_LENGTH)).astype(np.float32)
    facing = np.abs(np.einsum("ijk,ijk->ij", normals, towards))
    return SeenSurface(points, normals, certainty, facing, sight, _cell_width(points, seen, sight))


def nearness_to_centre(seen: SeenSurface, reach: float) -> Plane:
    """Compute a Gaussian, of deviation `reach`, of the distance across the line of sight from the visible middle."""
    offset = seen.point - _middle(seen.point, seen.certainty > SEEN)
    along = np.einsum("ijk,k->ij", offset, seen.sight)
    across = np.einsum("ijk,ijk->ij", offset, offset) - along**2
    return cv2.exp(-across / np.float32(2 * reach**2))


def protrusion(seen: SeenSurface, reach: float) -> Plane:
    """Compute how far the surface stands out of its surroundings, in units of `reach`; positive where convex.

    This is the distance along the normal from the centroid of the visible surface in a Gaussian window around
    the point (Clarenz, Rumpf & Telea 2004, "Robust feature detection and local classification for surfaces
    based on moment analysis", IEEE TVCG 10(5)).
    """
    if reach in seen.protrusions:
        return seen.protrusions[reach]
    deviation = reach / 1.5
    weight = _smooth(seen.certainty, deviation / seen.cell)
    mean = _smooth(seen.point * seen.certainty[..., None], deviation / seen.cell)
    offset = seen.point - mean * reciprocal(weight)[..., None]
    heights: Plane = np.einsum("ijk,ijk->ij", offset, seen.normal) / np.float32(reach)
    seen.protrusions[reach] = heights
    return heights


def relief(seen: SeenSurface, reach: float) -> Plane:
    """Compute how far the surface lies above or below its surroundings, in units of `reach`."""
    return np.abs(protrusion(seen, reach))


def coordinate_product(seen: SeenSurface, *axes: int) -> Plane:
    """Return the product of each point's coordinates along `axes`."""
    return np.prod(seen.point[..., axes], axis=-1)


def distance_from_origin(seen: SeenSurface) -> Plane:
    """Return each point's distance from the origin, the object's middle."""
    return np.linalg.norm(seen.point, axis=2)


def visible_share(seen: SeenSurface, reach: float) -> Plane:
    """Compute the share of a Gaussian window that the object fills, 0 to 1."""
    return _smooth(seen.certainty, reach / 1.5 / seen.cell)


def _middle(points: Plane, seen: NDArray[np.bool_]) -> Plane:
    """Return the mean (3,) of the points of seen cells, and 0 without seen cells."""
    return points[seen].mean(axis=0) if seen.any() else np.zeros(3, np.float32)


def _smooth(planes: Plane, deviation: float) -> Plane:
    deviation = max(deviation, 0.5)
    return cv2.GaussianBlur(planes, (0, 0), deviation, borderType=BORDER_ZERO)


def _cell_width(points: Plane, seen: NDArray[np.bool_], sight: Plane) -> float:
    """Compute the median distance, across the line of sight, of horizontally adjacent cells."""
    both_seen = seen[:, 1:] & seen[:, :-1]
    steps = (points[:, 1:] - points[:, :-1])[both_seen]
    if not len(steps):
        return 1.0 / len(points)
    across = steps - np.einsum("nk,k->n", steps, sight)[:, None] * sight
    return max(float(np.median(np.linalg.norm(across, axis=1))), SMALLEST_LENGTH)
