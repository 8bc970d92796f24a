"""Strategy `contour`: locations along an object's outline, as in contour following with a hand."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from skimage.measure import find_contours

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.attention.scanpath import Scanpath
from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.fixations.attended_views import AttendedView

_BETWEEN_PIXELS = 0.5


def choose(view: AttendedView, attention: AttentionParameters, *_: object) -> Scanpath:
    """Follow the object's outline from its most salient pixel, with steps of a focus radius."""
    views, index, saliency = view.views, view.index, view.attended.saliency
    rows, columns = follow_outline(
        views.mask[index],
        views.point[index],
        saliency,
        attention.focus_radius,
        attention.fixations,
    )
    return Scanpath(
        rows=rows,
        columns=columns,
        points=views.point[index][rows, columns],
        normals=views.normal[index][rows, columns],
        faces=views.face[index][rows, columns],
        saliency=saliency[rows, columns].astype("float64"),
        asked=attention.fixations,
    )


def follow_outline(
    mask: BoolArray, point: FloatArray, saliency: NDArray[np.float32], step: float, count: int
) -> tuple[IntArray, IntArray]:
    """Return rows and columns of at most `count` pixels along the object's longest outline, just inside.

    The path starts at the most salient pixel and follows the outline once, in one direction. The next location is
    the first pixel at a distance of at least `step` from the last location, in the unit of the points.
    """
    rows, columns = outline_pixels(mask)
    if not len(rows):
        return rows, columns
    start = int(np.argmax(saliency[rows, columns]))
    rows, columns = np.roll(rows, -start), np.roll(columns, -start)
    points = point[rows, columns]
    chosen = [0]
    while len(chosen) < count:
        last = chosen[-1]
        is_far = np.linalg.norm(points[last + 1 :] - points[last], axis=1) >= step
        if not is_far.any():
            break
        chosen.append(last + 1 + int(np.argmax(is_far)))
    return rows[chosen], columns[chosen]


def outline_pixels(mask: BoolArray) -> tuple[IntArray, IntArray]:
    """Return rows and columns of the object's pixels along its longest outline, in order, each pixel once."""
    curves = find_contours(np.pad(mask, 1).astype(np.float64), _BETWEEN_PIXELS)
    if not curves:
        return np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64)
    curve = max(curves, key=len) - 1.0
    # Each vertex lies between a pixel of the object and a pixel of the background.
    neighbours = np.stack([np.floor(curve), np.ceil(curve)]).astype(np.int64)
    height, width = mask.shape
    in_image = (neighbours >= 0).all(axis=2) & (neighbours < (height, width)).all(axis=2)
    on_object = np.zeros(in_image.shape, dtype=bool)
    on_object[in_image] = mask[tuple(neighbours[in_image].T)]
    pixels = np.where(on_object[0][:, None], neighbours[0], neighbours[1])
    _, first = np.unique(pixels, axis=0, return_index=True)
    rows, columns = pixels[np.sort(first)].T
    return rows, columns
