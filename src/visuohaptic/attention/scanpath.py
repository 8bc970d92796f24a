"""Fixations in order: winner-take-all with inhibition of return."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from .parameters import AttentionParameters
from .plain_filters import plain_filters
from .planes import Plane

# Maxima closer than this tie: the first in row order is fixated, at the largest value of its focus.
TIE = 1e-4
# Values closer than this differ by rounding only: the first in row order counts as the largest.
ROUNDING = 1e-6
# Weight of the depth inside the outline; small, so that it decides only where saliency is even.
INWARD = 1e-3
# Least distance of a fixation from the outline, as a fraction of the view's longer edge; in thinner
# parts, at least this share of the depth of their middle.
OUTLINE_MARGIN = 0.016
THIN_PART = 0.7
# Drive of a place that may not be fixated again; that of other places may be zero.
CLOSED = -1.0


@dataclass(frozen=True)
class Scanpath:
    """The k fixations on one view, in order; no pixel is fixated twice.

    `rows` and `columns` (k,), int64, are pixels, `points` and `normals` (k, 3), float64, as the view has
    them, `faces` (k,) int64, `saliency` (k,) of the view's maximum. k is below `asked` if no pixel was left.
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
        """Number of fixations found, k."""
        return len(self.rows)

    @property
    def exhausted(self) -> bool:
        """Whether the view has fewer distinct fixations than were asked for."""
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
    """Find the fixations on a saliency map (h, w), float32, 0 to 1, of a surface as `attend` takes it.

    Among maxima that tie, the largest within one focus of the first, in row order, wins; of values that
    differ by rounding, the first.
    """
    rows, columns, depth = _off_outline(mask)
    pixels = rows * mask.shape[1] + columns
    values = saliency.reshape(-1).take(pixels)
    inward = depth / np.float32(max(float(depth.max(initial=0.0)), 1.0))
    if parameters.inhibition == "surface":
        places = np.take(point.reshape(-1, 3), pixels, axis=0).T / parameters.focus_radius
    else:
        places = np.stack([rows, columns]) / (parameters.focus_fraction * max(mask.shape))
    drive = values + np.float32(INWARD) * inward
    winners = _winners(drive, np.ascontiguousarray(places, dtype=np.float32), parameters)
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


def _winners(drive: Plane, places: Plane, parameters: AttentionParameters) -> NDArray[np.int64]:
    drive = drive.copy()
    winners: list[int] = []
    while len(winners) < parameters.fixations and drive.max(initial=CLOSED) > CLOSED:
        winner = _winner(drive, places)
        distance: Plane = np.sqrt(_squared_distances(places, places[:, winner]))
        near = np.flatnonzero(distance <= 1.0 + parameters.inhibition_falloff)
        distance, faded = distance[near], drive[near]
        closed = (distance <= 1.0) | (faded == CLOSED)
        if parameters.inhibition_falloff > 0.0:
            fade = (distance - np.float32(1.0)) / np.float32(parameters.inhibition_falloff)
            faded *= _release(fade)
        drive[near] = np.where(closed, np.float32(CLOSED), faded)
        winners.append(winner)
    return np.array(winners, dtype=np.int64)


def _winner(drive: Plane, places: Plane) -> int:
    """Give the largest; if others tie with it, the largest within the focus of the first in row order."""
    tied = np.flatnonzero(drive >= drive.max() - TIE)
    near = tied[_squared_distances(places[:, tied], places[:, tied[0]]) <= 1.0]
    largest = drive[near] >= drive[near].max() - np.float32(ROUNDING)
    return int(near[np.argmax(largest)])


def _squared_distances(places: Plane, centre: Plane) -> Plane:
    total = np.zeros(places.shape[1], dtype=np.float32)
    for axis, middle in zip(places, centre, strict=True):
        total += (axis - middle) ** 2
    return total


def _release(progress: Plane) -> Plane:
    step = np.clip(progress, 0.0, 1.0)
    return step * step * (3.0 - 2.0 * step)


def _off_outline(mask: NDArray[np.bool_]) -> tuple[NDArray[np.int64], NDArray[np.int64], Plane]:
    """Give the rows and columns off the outline, near the middle of thin parts, and their distances from it."""
    padded = cv2.copyMakeBorder(mask.view(np.uint8), 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=0)
    depth = cv2.distanceTransform(padded, cv2.DIST_L2, cv2.DIST_MASK_5)
    margin = OUTLINE_MARGIN * max(mask.shape)
    reach = 2 * round(margin) + 1
    window = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (reach, reach))
    middle = cv2.dilate(depth, window, borderType=cv2.BORDER_CONSTANT, borderValue=0)
    kept = (depth > 0.0) & (depth >= np.minimum(margin, THIN_PART * middle))
    rows, columns = np.nonzero(kept)
    return rows - 1, columns - 1, depth[kept]
