"""Fixations in order: winner-take-all with inhibition of return."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from .parameters import AttentionParameters
from .plain_filters import plain_filters
from .planes import Plane

TIE_TOLERANCE = 1e-4
"""Drives this close to the largest drive tie with it."""

ROUNDING_TOLERANCE = 1e-6
"""Drives this close to each other differ by rounding only; the first pixel in row order wins."""

INWARD_WEIGHT = 1e-3
"""Drive added at the pixel farthest from the outline; so small that it decides only where saliency is even."""

OUTLINE_MARGIN = 0.016
"""Least distance of a fixation from the outline, as a fraction of the view's longer edge."""

THIN_PART_FRACTION = 0.7
"""Least distance from the outline in parts too thin for the margin, as a fraction of the largest distance nearby."""

CLOSED_DRIVE = -1.0
"""Drive of pixels that may not be fixated again; all other drives are at least 0."""


@dataclass(frozen=True)
class Scanpath:
    """The k fixations on one view, in order: k different pixels and the surface there.

    Attributes
    ----------
    rows, columns : ndarray of shape (k,), int64
        Row from the top and column from the left of each fixated pixel.
    points, normals : ndarray of shape (k, 3), float64
        Visible point of the surface and unit normal at each pixel, in the frame of `scan`'s `point` and `normal`. For
        rendered views this is the object frame, not the camera frame.
    faces : ndarray of shape (k,), int64
        Index of the visible face at each pixel.
    saliency : ndarray of shape (k,), float64
        Value of the saliency map at each pixel, before any inhibition. `attend` scales maps to a maximum of 1.
    asked : int
        The requested number of fixations; k is smaller if the view has no further pixel to fixate.
    """

    rows: NDArray[np.int64]
    columns: NDArray[np.int64]
    points: NDArray[np.float64]
    normals: NDArray[np.float64]
    faces: NDArray[np.int64]
    saliency: NDArray[np.float64]
    asked: int

    @property
    def distinct(self) -> int:
        """The number k of fixations, which are all different."""
        return len(self.rows)

    @property
    def exhausted(self) -> bool:
        """Whether fewer fixations were found than requested."""
        return self.distinct < self.asked


@plain_filters()
def scan(
    saliency: Plane,
    mask: NDArray[np.bool_],
    point: NDArray[np.float64],
    normal: NDArray[np.float64],
    face: NDArray[np.int64],
    parameters: AttentionParameters,
) -> Scanpath:
    """Choose the fixations on a saliency map by winner-take-all with inhibition of return.

    Each fixation is at the pixel with the largest drive. At first the drive is the saliency plus up to
    `INWARD_WEIGHT`, in proportion to the distance from the outline. A fixation closes all pixels within the focus
    radius. In a rim around this focus the drive is multiplied by a share that grows smoothly from 0 to 1. The path
    ends if all pixels are closed.

    Pixels near the outline are never fixated, see `OUTLINE_MARGIN`; the edge of the view counts as outline.

    Drives within `TIE_TOLERANCE` of the largest drive tie. Only tied pixels within a focus radius of the first tied
    pixel, row by row from the top left, compete. The largest of their drives wins.

    Parameters
    ----------
    saliency : ndarray of shape (h, w), float32
        The saliency map, 0 to 1; pixels outside the mask are ignored.
    mask : ndarray of shape (h, w), bool
        True on the object.
    point, normal : ndarray of shape (h, w, 3), float64
        Visible points of the surface and their unit normals.
    face : ndarray of shape (h, w), int64
        Index of the visible face at each pixel.
    parameters : AttentionParameters
        Number of fixations, focus and inhibition; the weights are not used. `focus_radius` is in the unit of `point`.

    Returns
    -------
    Scanpath
        At most `parameters.fixations` fixations.
    """
    rows, columns, depth = _allowed_pixels(mask)
    pixels = rows * mask.shape[1] + columns
    values = saliency.reshape(-1).take(pixels)
    inward = depth / np.float32(max(float(depth.max(initial=0.0)), 1.0))
    # Positions of shape (3, p) or (2, p), in focus radii.
    if parameters.inhibition == "surface":
        positions = np.take(point.reshape(-1, 3), pixels, axis=0).T / parameters.focus_radius
    else:
        positions = np.stack([rows, columns]) / (parameters.focus_fraction * max(mask.shape))
    drive = values + np.float32(INWARD_WEIGHT) * inward
    winners = _winners(drive, np.ascontiguousarray(positions, dtype=np.float32), parameters)
    chosen = pixels[winners]
    return Scanpath(
        rows[winners],
        columns[winners],
        point.reshape(-1, 3)[chosen],
        normal.reshape(-1, 3)[chosen],
        face.reshape(-1)[chosen],
        values[winners].astype(np.float64),
        parameters.fixations,
    )


def _winners(drive: Plane, positions: Plane, parameters: AttentionParameters) -> NDArray[np.int64]:
    """Return indices of the fixated pixels, in order, from drives (p,) and positions (d, p) in focus radii."""
    drive = drive.copy()
    winners: list[int] = []
    while len(winners) < parameters.fixations and drive.max(initial=CLOSED_DRIVE) > CLOSED_DRIVE:
        winner = _next_winner(drive, positions)
        distance: Plane = np.sqrt(_squared_distances(positions, positions[:, winner]))
        near = np.flatnonzero(distance <= 1.0 + parameters.inhibition_falloff)
        distance, remaining = distance[near], drive[near]
        closed = (distance <= 1.0) | (remaining == CLOSED_DRIVE)
        if parameters.inhibition_falloff > 0.0:
            across_rim = (distance - np.float32(1.0)) / np.float32(parameters.inhibition_falloff)
            remaining *= _remaining_share(across_rim)
        drive[near] = np.where(closed, np.float32(CLOSED_DRIVE), remaining)
        winners.append(winner)
    return np.array(winners, dtype=np.int64)


def _next_winner(drive: Plane, positions: Plane) -> int:
    """Return the index of the largest drive (p,) among the tied pixels within a focus radius of the first of them."""
    tied = np.flatnonzero(drive >= drive.max() - TIE_TOLERANCE)
    near = tied[_squared_distances(positions[:, tied], positions[:, tied[0]]) <= 1.0]
    largest = drive[near] >= drive[near].max() - np.float32(ROUNDING_TOLERANCE)
    return int(near[np.argmax(largest)])


def _squared_distances(positions: Plane, centre: Plane) -> Plane:
    """Compute the squared distance (p,) of each position, a column of (d, p), from a centre (d,)."""
    total = np.zeros(positions.shape[1], dtype=np.float32)
    for coordinates, centre_coordinate in zip(positions, centre, strict=True):
        total += (coordinates - centre_coordinate) ** 2
    return total


def _remaining_share(across_rim: Plane) -> Plane:
    """Return the share of the drive that inhibition leaves: 0 at the inner edge 0 of the rim, 1 at the outer edge 1."""
    step = np.clip(across_rim, 0.0, 1.0)
    return step * step * (3.0 - 2.0 * step)


def _allowed_pixels(
    mask: NDArray[np.bool_],
) -> tuple[NDArray[np.int64], NDArray[np.int64], Plane]:
    """Return row, column and distance from the outline (pixels) of each pixel that may be fixated, in row order."""
    # The edge of the view counts as outline.
    padded = cv2.copyMakeBorder(mask.view(np.uint8), 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=0)
    depth = cv2.distanceTransform(padded, cv2.DIST_L2, cv2.DIST_MASK_5)
    margin = OUTLINE_MARGIN * max(mask.shape)
    width = 2 * round(margin) + 1
    window = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (width, width))
    largest_depth_nearby = cv2.dilate(depth, window, borderType=cv2.BORDER_CONSTANT, borderValue=0)
    allowed = (depth > 0.0) & (
        depth >= np.minimum(margin, THIN_PART_FRACTION * largest_depth_nearby)
    )
    rows, columns = np.nonzero(allowed)
    return rows - 1, columns - 1, depth[allowed]
