"""Turn a model upright by its up and front axes; choose the up axis by how steadily the object stands."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Literal, get_args

import numpy as np

from visuohaptic.base.arrays import FloatArray
from visuohaptic.geometry.surface import Surface

Axis = Literal["x", "-x", "y", "-y", "z", "-z"]
"""An axis of a file, with its sign."""

AXES = get_args(Axis)
"""All axes of a file."""

_FRONTS = {"x": "z", "-x": "z", "y": "z", "-y": "z", "z": "-y", "-z": "y"}
"""Front axis per up axis, if no front axis is given."""

_TIPS_OVER = math.radians(10.0)
"""Tipping angle (radians) that separates objects that hardly stand from objects that stand.

If the angle with y up is smaller, and with z up larger by this amount, then z is probably up. This is so for one of 142
upright models of the catalogue, and for 108 of them after a quarter turn."""

_FOOT = 0.02
"""Vertices within this share of the height above the lowest vertex are the base of an object: feet differ in length."""


def are_perpendicular(up: str, front: str) -> bool:
    """Return whether two axes, such as ``z`` and ``-x``, are perpendicular."""
    return up[-1] != front[-1]


def rotation_upright(up: str, front: str | None = None) -> FloatArray:
    """Return the rotation matrix (3, 3) that turns axis `up` to y and axis `front` to z.

    `front` must be perpendicular to `up`. Without `front`, the front is z, for `up` z it is -y, and for -z it is y.
    """
    upward, forward = (_unit_vector(axis) for axis in (up, front or _FRONTS[up]))
    # Adding 0 makes -0 to 0, which counts for the bits of products.
    rotation: FloatArray = np.array([np.cross(upward, forward), upward, forward]) + 0.0
    return rotation


def named_axis(vector: FloatArray) -> str:
    """Return the axis nearest to a vector (3,), with its sign, such as ``-x``."""
    index = int(np.abs(vector).argmax())
    return ("-" if vector[index] < 0 else "") + "xyz"[index]


def _unit_vector(axis: str) -> FloatArray:
    vector = np.zeros(3)
    vector["xyz".index(axis[-1])] = -1.0 if axis.startswith("-") else 1.0
    return vector


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
