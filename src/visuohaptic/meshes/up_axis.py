"""Choose the up axis of a model if the file has none: the axis on which the object stands most steadily."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from visuohaptic.base.arrays import FloatArray
from visuohaptic.geometry.surface import Surface

_TIPS_OVER = math.radians(10.0)
"""Tipping angle (radians) that separates objects that hardly stand from objects that stand.

If the angle with y up is smaller, and with z up larger by this amount, then z is probably up. This is so for one of 142
upright models of the catalogue, and for 108 of them after a quarter turn."""

_FOOT = 0.02
"""Vertices within this share of the height above the lowest vertex are the base of an object: feet differ in length."""


def steadiest_axis(surface: Surface, rotations: Mapping[str, FloatArray]) -> str:
    """Return the axis with the largest tipping angle when it points up; of equal angles the first.

    `rotations` has the rotation matrix (3, 3) per axis that turns the axis to y.
    """
    if not surface.face_areas.sum() > 0:
        return next(iter(rotations))  # no area: a later check raises the error
    offsets = surface.vertices[np.unique(surface.faces)] - surface.centroid
    angles = {
        axis: tipping_angle(np.einsum("nd,kd->nk", offsets, rotation))
        for axis, rotation in rotations.items()
    }
    return max(angles, key=angles.__getitem__)


def leans_on_y(surface: Surface, rotation: FloatArray) -> bool:
    """Return whether an object hardly stands with y up, and stands after the rotation (3, 3)."""
    if not surface.face_areas.sum() > 0:
        return False
    offsets = surface.vertices[np.unique(surface.faces)] - surface.centroid
    angle = tipping_angle(offsets)
    if angle >= _TIPS_OVER:
        return False
    return tipping_angle(np.einsum("nd,kd->nk", offsets, rotation)) > angle + _TIPS_OVER


def tipping_angle(offsets: FloatArray) -> float:
    """Return the angle (radians) by which an object can lean in its least steady direction before it tips over.

    `offsets` (n, 3) are vertices relative to the centre of mass, y up. The angle is negative if the centre is not
    above the base of the object, and 0 if the base is a line or a point.
    """
    from scipy.spatial import ConvexHull, QhullError

    height = float(np.ptp(offsets[:, 1]))
    lowest = float(offsets[:, 1].min())
    foot = offsets[offsets[:, 1] <= lowest + _FOOT * height][:, [0, 2]]
    try:
        edges = ConvexHull(foot).equations
    except (QhullError, ValueError):  # fewer than three points, or all on a line
        return 0.0
    # Offset of an edge: signed distance of the projected centre, negative inside.
    return math.atan2(-float(edges[:, 2].max()), -lowest)
