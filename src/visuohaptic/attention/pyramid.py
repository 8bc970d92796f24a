"""Image pyramids in which every average is taken over the object only.

A plane is stored multiplied by its certainty, 1 on the object and 0 outside; smoothing both and dividing
is normalised convolution (Knutsson & Westin 1993), so an outline makes no step in any plane. All grids
are centred: keeping every other pixel would move the image by half a pixel a level.
"""

from __future__ import annotations

import cv2
import numpy as np

from .levels import WORKING_SIZE
from .planes import Plane

# Share of a pixel below which it counts as empty; rounding of float32 averages stays below.
EMPTY = 1e-4

NOTHING_BEYOND = cv2.BORDER_CONSTANT
GOES_ON = cv2.BORDER_REPLICATE

_BINOMIAL = np.array([0.25, 0.5, 0.25], dtype=np.float32)


def to_working_size(plane: Plane) -> Plane:
    """Resample planes (h, w) or (h, w, k), multiplied by the certainty, to the square working image.

    A view that is not square is padded with zeros; a [1 2 1] kernel limits the bandwidth.
    """
    square = _padded_to_square(plane)
    size = (WORKING_SIZE, WORKING_SIZE)
    method = cv2.INTER_AREA if square.shape[0] > WORKING_SIZE else cv2.INTER_LINEAR
    return blur(cv2.resize(square, size, interpolation=method))


def blur(plane: Plane, border: int = NOTHING_BEYOND) -> Plane:
    """Smooth with the kernel [1 2 1] / 4 in rows and columns."""
    return cv2.sepFilter2D(plane, -1, _BINOMIAL, _BINOMIAL, borderType=border)


def reduce(plane: Plane, border: int = NOTHING_BEYOND) -> Plane:
    """Halve both sides of (2n, 2n[, k]) with the kernel [1 3 3 1] / 8, which is centred on the new pixel.

    The border `GOES_ON` is for an image that fills its grid.
    """
    half = plane.shape[0] // 2
    return cv2.resize(blur(plane, border), (half, half), interpolation=cv2.INTER_AREA)


def enlarge(plane: Plane, size: int) -> Plane:
    """Interpolate a square plane linearly at `size` rows and columns, both grids centred."""
    if plane.shape[0] == size:
        return plane
    return cv2.resize(plane, (size, size), interpolation=cv2.INTER_LINEAR)


def reductions(plane: Plane, count: int, border: int = NOTHING_BEYOND) -> list[Plane]:
    """Give a plane and `count` further levels, each of half the size."""
    levels = [plane]
    for _ in range(count):
        levels.append(reduce(levels[-1], border))
    return levels


def reciprocal(certainty: Plane) -> Plane:
    """Give 1 over the certainty, and zero where nothing is certain; a smoothed plane times this is an average."""
    return np.divide(1.0, certainty, out=np.zeros_like(certainty), where=certainty > EMPTY)


def filled(plane: Plane, certainty: Plane) -> Plane:
    """Extend a plane (n, n), multiplied by the certainty, beyond the object, so that filters find no outline.

    Outside are averages of its nearest parts over increasingly large neighbourhoods (pull-push, Gortler et
    al. 1996, "The Lumigraph"); n is a multiple of 4.
    """
    planes, certainties = [plane], [certainty]
    while planes[-1].shape[0] > 4:
        planes.append(reduce(planes[-1]))
        certainties.append(reduce(certainties[-1]))
    mass = float(certainties[-1].sum())
    fill = np.full_like(planes[-1], float(planes[-1].sum()) / mass if mass > 0 else 0.0)
    for level, share in zip(reversed(planes), reversed(certainties), strict=True):
        fill = level + (1.0 - share) * enlarge(fill, level.shape[0])
    return fill


def _padded_to_square(plane: Plane) -> Plane:
    rows, columns = plane.shape[:2]
    if rows == columns:
        return plane
    side = max(rows, columns)
    top, left = (side - rows) // 2, (side - columns) // 2
    margins = [(top, side - rows - top), (left, side - columns - left), (0, 0)]
    return np.pad(plane, margins[: plane.ndim])
