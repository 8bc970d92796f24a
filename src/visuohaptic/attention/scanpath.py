"""Fixations in order: winner-take-all with inhibition of return."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from .parameters import AttentionParameters
from .plain_filters import plain_filters
from .planes import Plane

# Values this close to the maximum tie with it. Among ties, the focus of the first pixel in row order wins.
TIE = 1e-4
# Values this close to the maximum differ by rounding only. The first of them in row order counts as the maximum.
ROUNDING = 1e-6
# Weight of the distance from the outline. The weight is small, so that distance decides only where saliency is even.
INWARD = 1e-3
# Least distance of a fixation from the outline, as a fraction of the view's longer edge.
OUTLINE_MARGIN = 0.016
# In parts too thin for this margin: the least distance as a fraction of that of the part's middle.
THIN_PART = 0.7
# Drive of pixels that may not be fixated again. Other pixels have a drive of at least 0.
CLOSED = -1.0


@dataclass(frozen=True)
class Scanpath:
    """The k fixations on one view, in order; no pixel is fixated twice.

    Attributes
    ----------
    rows, columns : ndarray of shape (k,), int64
        The fixated pixels.
    points, normals : ndarray of shape (k, 3), float64
        The surface there, in the frame of the view.
    faces : ndarray of shape (k,), int64
        The faces there.
    saliency : ndarray of shape (k,), float64
        Saliency as a fraction of the view's maximum.
    asked : int
        The requested number of fixations; k is smaller if no pixel was left.
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
        """Number of fixations, k."""
        return len(self.rows)

    @property
    def exhausted(self) -> bool:
        """Whether the view has fewer fixations than requested."""
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

    If maxima tie, the largest value within a focus of the first of them in row order wins.

    Parameters
    ----------
    saliency : ndarray of shape (h, w), float32
        The saliency map, 0 to 1.
    mask, point, normal, face : ndarray
        The surface in the view, as for `attend`, without the axis of views.
    parameters : AttentionParameters
        Number of fixations, focus and inhibition.

    Returns
    -------
    Scanpath
        At most `parameters.fixations` fixations.
    """
    rows, columns, depth = _pixels_off_outline(mask)
    pixels = rows * mask.shape[1] + columns
    values = saliency.reshape(-1).take(pixels)
    inward = depth / np.float32(max(float(depth.max(initial=0.0)), 1.0))
    # Positions are in units of the focus radius.
    if parameters.inhibition == "surface":
        positions = np.take(point.reshape(-1, 3), pixels, axis=0).T / parameters.focus_radius
    else:
        positions = np.stack([rows, columns]) / (parameters.focus_fraction * max(mask.shape))
    drive = values + np.float32(INWARD) * inward
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
    """Return the indices of the fixated pixels in order, by winner-take-all with inhibition of return."""
    drive = drive.copy()
    winners: list[int] = []
    while len(winners) < parameters.fixations and drive.max(initial=CLOSED) > CLOSED:
        winner = _winner(drive, positions)
        distance: Plane = np.sqrt(_squared_distances(positions, positions[:, winner]))
        near = np.flatnonzero(distance <= 1.0 + parameters.inhibition_falloff)
        distance, faded = distance[near], drive[near]
        closed = (distance <= 1.0) | (faded == CLOSED)
        if parameters.inhibition_falloff > 0.0:
            fade = (distance - np.float32(1.0)) / np.float32(parameters.inhibition_falloff)
            faded *= _release(fade)
        drive[near] = np.where(closed, np.float32(CLOSED), faded)
        winners.append(winner)
    return np.array(winners, dtype=np.int64)


def _winner(drive: Plane, positions: Plane) -> int:
    """Return the index of the largest drive within the focus of the first tied maximum in row order."""
    tied = np.flatnonzero(drive >= drive.max() - TIE)
    near = tied[_squared_distances(positions[:, tied], positions[:, tied[0]]) <= 1.0]
    largest = drive[near] >= drive[near].max() - np.float32(ROUNDING)
    return int(near[np.argmax(largest)])


def _squared_distances(positions: Plane, centre: Plane) -> Plane:
    total = np.zeros(positions.shape[1], dtype=np.float32)
    for coordinates, centre_coordinate in zip(positions, centre, strict=True):
        total += (coordinates - centre_coordinate) ** 2
    return total


def _release(progress: Plane) -> Plane:
    """Return a smooth step from 0 to 1: the share of the drive that inhibition leaves."""
    step = np.clip(progress, 0.0, 1.0)
    return step * step * (3.0 - 2.0 * step)


def _pixels_off_outline(
    mask: NDArray[np.bool_],
) -> tuple[NDArray[np.int64], NDArray[np.int64], Plane]:
    """Return rows, columns and distances from the outline of pixels that may be fixated."""
    padded = cv2.copyMakeBorder(mask.view(np.uint8), 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=0)
    depth = cv2.distanceTransform(padded, cv2.DIST_L2, cv2.DIST_MASK_5)
    margin = OUTLINE_MARGIN * max(mask.shape)
    width = 2 * round(margin) + 1
    window = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (width, width))
    depth_of_middle = cv2.dilate(depth, window, borderType=cv2.BORDER_CONSTANT, borderValue=0)
    allowed = (depth > 0.0) & (depth >= np.minimum(margin, THIN_PART * depth_of_middle))
    rows, columns = np.nonzero(allowed)
    return rows - 1, columns - 1, depth[allowed]
