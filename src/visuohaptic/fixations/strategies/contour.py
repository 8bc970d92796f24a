"""Places along an object's outline, as a hand that follows the contour would touch them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from skimage.measure import find_contours

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.attention.scanpath import Scanpath
from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.fixations.attended_views import AttendedView

_BETWEEN_PIXELS = 0.5


def choose(one: AttendedView, attention: AttentionParameters, *_: object) -> Scanpath:
    """Follow the object's outline from its most salient place, a focus radius a step."""
    seen, place, saliency = one.seen, one.place, one.attended.saliency
    rows, columns = follow_outline(
        seen.mask[place],
        seen.point[place],
        saliency,
        attention.focus_radius,
        attention.fixations,
    )
    return Scanpath(
        rows=rows,
        columns=columns,
        points=seen.point[place][rows, columns],
        normals=seen.normal[place][rows, columns],
        faces=seen.face[place][rows, columns],
        saliency=saliency[rows, columns].astype("float64"),
        asked=attention.fixations,
    )


def follow_outline(
    mask: BoolArray, point: FloatArray, saliency: NDArray[np.float32], step: float, count: int
) -> tuple[IntArray, IntArray]:
    """Find places along the longest outline of what a view shows, just inside it: rows and columns.

    The first is its most salient one; each next one is the first, in one direction, that is a step (in the
    points' units) away from the one before, until the outline was followed once.
    """
    rows, columns = outline_pixels(mask)
    if not len(rows):
        return rows, columns
    start = int(np.argmax(saliency[rows, columns]))
    rows, columns = np.roll(rows, -start), np.roll(columns, -start)
    points = point[rows, columns]
    chosen = [0]
    while len(chosen) < count:
        rest = points[chosen[-1] + 1 :]
        away = np.linalg.norm(rest - points[chosen[-1]], axis=1) >= step
        if not away.any():
            break
        chosen.append(chosen[-1] + 1 + int(np.argmax(away)))
    return rows[chosen], columns[chosen]


def outline_pixels(mask: BoolArray) -> tuple[IntArray, IntArray]:
    """Give the object's pixels along its longest outline, in order, each once: rows and columns."""
    curves = find_contours(np.pad(mask, 1).astype(np.float64), _BETWEEN_PIXELS)
    if not curves:
        return np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64)
    curve = max(curves, key=len) - 1.0
    # Each vertex lies between a pixel of the object and one of the background.
    ends = np.stack([np.floor(curve), np.ceil(curve)]).astype(np.int64)
    height, width = mask.shape
    inside = (ends >= 0).all(axis=2) & (ends < (height, width)).all(axis=2)
    held = np.zeros(inside.shape, dtype=bool)
    held[inside] = mask[tuple(ends[inside].T)]
    pixels = np.where(held[0][:, None], ends[0], ends[1])
    _, first = np.unique(pixels, axis=0, return_index=True)
    rows, columns = pixels[np.sort(first)].T
    return rows, columns
