"""Image pyramids with averages over the object only.

A plane is stored multiplied by its certainty, 1 on the object and 0 outside. Plane and certainty are smoothed
and then divided: normalised convolution (Knutsson & Westin 1993). So no plane has a step at the outline.

The grids of all levels have the same centre. Keeping every other pixel would instead move the image by half a
pixel per level.
"""

from __future__ import annotations

import cv2
import numpy as np

from .levels import WORKING_SIZE
from .planes import Plane

EMPTY = 1e-4
"""Certainty up to which a pixel counts as empty; far above the rounding of float32 averages."""

BORDER_ZERO = cv2.BORDER_CONSTANT
"""Pixels outside the image are 0: for planes that are multiplied by their certainty."""

BORDER_REPEATED = cv2.BORDER_REPLICATE
"""Pixels outside the image equal the nearest border pixel: for images without a background."""

_BINOMIAL = np.array([0.25, 0.5, 0.25], dtype=np.float32)


def to_working_size(plane: Plane) -> Plane:
    """Resample planes (h, w) or (h, w, k), multiplied by the certainty, to the square working image.

    A view that is not square is padded with zeros. A [1 2 1] kernel then smooths the result.
    """
    square = _padded_to_square(plane)
    size = (WORKING_SIZE, WORKING_SIZE)
    method = cv2.INTER_AREA if square.shape[0] > WORKING_SIZE else cv2.INTER_LINEAR
    return blur(cv2.resize(square, size, interpolation=method))


def blur(plane: Plane, border: int = BORDER_ZERO) -> Plane:
    """Smooth with the kernel [1 2 1] / 4 along rows and columns."""
    return cv2.sepFilter2D(plane, -1, _BINOMIAL, _BINOMIAL, borderType=border)


def reduce(plane: Plane, border: int = BORDER_ZERO) -> Plane:
    """Halve both sides of planes (2n, 2n[, k]) with the kernel [1 3 3 1] / 8, centred on the new pixel."""
    half = plane.shape[0] // 2
    return cv2.resize(blur(plane, border), (half, half), interpolation=cv2.INTER_AREA)


def enlarge(plane: Plane, size: int) -> Plane:
    """Interpolate a square plane linearly to `size` rows and columns with the same centre."""
    if plane.shape[0] == size:
        return plane
    return cv2.resize(plane, (size, size), interpolation=cv2.INTER_LINEAR)


def build_pyramid(plane: Plane, count: int, border: int = BORDER_ZERO) -> list[Plane]:
    """Return a plane and `count` coarser levels, each of half the size."""
    levels = [plane]
    for _ in range(count):
        levels.append(reduce(levels[-1], border))
    return levels


def reciprocal(certainty: Plane) -> Plane:
    """Return 1 / certainty, and 0 at empty pixels; a smoothed plane times this is an average over the object."""
    return np.divide(1.0, certainty, out=np.zeros_like(certainty), where=certainty > EMPTY)


def fill_background(plane: Plane, certainty: Plane) -> Plane:
    """Extend a plane (n, n), multiplied by the certainty, beyond the object, so that filters see no outline.

    The background becomes averages of the nearest parts over larger and larger neighbourhoods (pull-push,
    Gortler et al. 1996, "The Lumigraph"). n is a multiple of 4.
    """
    planes, certainties = [plane], [certainty]
    for _ in range((plane.shape[0] // 5).bit_length()):
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
