"""What the terms measure, on the grid of the maps."""

from __future__ import annotations

from dataclasses import dataclass, field

import cv2
import numpy as np
from numpy.typing import NDArray

from .planes import Plane
from .pyramid import NOTHING_BEYOND, reciprocal, reduce, to_working_size

# A grid cell counts as seen if so much of it shows the object.
SEEN = 0.25
SMALLEST_LENGTH = 1e-9


@dataclass(frozen=True)
class SeenSurface:
    """What a view shows of a surface, averaged over the object in each cell of the maps' grid, float32.

    `point` (n, n, 3), y up and z to the front, and unit `normal` (n, n, 3) are in the object frame, zero off
    the object; `certainty` (n, n) is the share of each cell that shows it, `facing` (n, n) the cosine, 0 to 1,
    of normal and eye. `sight` (3,) is the unit vector from the eye, `cell` a cell's width in the points' unit.
    `protrusions` keeps what `protrusion` found, by its reach, as two terms use each.
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
    """Bring what one view shows of a surface, as `attend` takes it, to the maps' grid."""
    cover = mask.astype(np.float32)
    certainty = reduce(to_working_size(cover))
    share = reciprocal(certainty)[..., None]
    lift = cover[..., None]
    points = reduce(to_working_size(point.astype(np.float32) * lift)) * share
    normals = reduce(to_working_size(normal.astype(np.float32) * lift)) * share
    normals /= np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), SMALLEST_LENGTH)
    towards = eye.astype(np.float32) - points
    towards /= np.maximum(np.linalg.norm(towards, axis=2, keepdims=True), SMALLEST_LENGTH)
    seen = certainty > SEEN
    middle = points[seen].mean(axis=0) if seen.any() else np.zeros(3, np.float32)
    offset = middle - eye.astype(np.float32)
    sight = (offset / max(float(np.linalg.norm(offset)), SMALLEST_LENGTH)).astype(np.float32)
    facing = np.abs(np.einsum("ijk,ijk->ij", normals, towards))
    return SeenSurface(points, normals, certainty, facing, sight, _cell_width(points, seen, sight))


def nearness_to_centre(seen: SeenSurface, reach: float) -> Plane:
    """Give a Gaussian of the distance, across the line of sight, from the middle of what is seen."""
    shown = seen.certainty > SEEN
    middle = seen.point[shown].mean(axis=0) if shown.any() else np.zeros(3, np.float32)
    offset = seen.point - middle
    along = np.einsum("ijk,k->ij", offset, seen.sight)
    across = np.einsum("ijk,ijk->ij", offset, offset) - along**2
    return cv2.exp(-across / np.float32(2 * reach**2))


def protrusion(seen: SeenSurface, reach: float) -> Plane:
    """Measure how far the surface stands out of its surroundings, in units of `reach`; above 0 where convex.

    The distance, along the normal, from the centroid of what is seen around a place in a Gaussian window
    (Clarenz, Rumpf & Telea 2004, "Robust feature detection and local classification for surfaces based on
    moment analysis", IEEE TVCG 10(5)).
    """
    if reach in seen.protrusions:
        return seen.protrusions[reach]
    deviation = reach / 1.5
    weight = _smooth(seen.certainty, deviation / seen.cell)
    mean = _smooth(seen.point * seen.certainty[..., None], deviation / seen.cell)
    offset = seen.point - mean * reciprocal(weight)[..., None]
    found: Plane = np.einsum("ijk,ijk->ij", offset, seen.normal) / np.float32(reach)
    seen.protrusions[reach] = found
    return found


def relief(seen: SeenSurface, reach: float) -> Plane:
    """Measure how far the surface lies out of or in its surroundings, in units of `reach`."""
    return np.abs(protrusion(seen, reach))


def place(seen: SeenSurface, *axes: int) -> Plane:
    """Give the product of each place's coordinates along some axes."""
    return np.prod(seen.point[..., axes], axis=-1)


def distance_from_middle(seen: SeenSurface) -> Plane:
    """Give the distance of each place from the origin."""
    return np.linalg.norm(seen.point, axis=2)


def visible_share(seen: SeenSurface, reach: float) -> Plane:
    """Give the share of a Gaussian window that the object fills, 0 to 1."""
    return _smooth(seen.certainty, reach / 1.5 / seen.cell)


def _smooth(planes: Plane, deviation: float) -> Plane:
    deviation = max(deviation, 0.5)
    return cv2.GaussianBlur(planes, (0, 0), deviation, borderType=NOTHING_BEYOND)


def _cell_width(points: Plane, seen: NDArray[np.bool_], sight: Plane) -> float:
    """Measure the median distance, across the line of sight, of cells side by side."""
    both = seen[:, 1:] & seen[:, :-1]
    step = (points[:, 1:] - points[:, :-1])[both]
    if not len(step):
        return 1.0 / len(points)
    across = step - np.einsum("nk,k->n", step, sight)[:, None] * sight
    return max(float(np.median(np.linalg.norm(across, axis=1))), SMALLEST_LENGTH)
