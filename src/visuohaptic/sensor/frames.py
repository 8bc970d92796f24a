"""The sensor's frame on the surface: which way is out, and which way the columns run."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from visuohaptic.base.arrays import FloatArray, IntArray

if TYPE_CHECKING:
    from visuohaptic.geometry.raycasting import RayCaster
    from visuohaptic.sensor.parameters import Orientation

# Moves the two directions in which `upright` must break off the exact poles, where
# horizontal faces are, to 14.5 degrees beside them.
_POLE_OFFSET = 0.25


def column_axes(normals: FloatArray, orientation: Orientation = "upright") -> FloatArray:
    """Give the direction (n, 3) in which an imprint's columns count up, from the outward normal alone.

    Seen from outside, columns count to the right and rows downwards (`row_axes`); y is up. No such
    rule is continuous over all normals (the hairy ball theorem), so each says where it breaks:

    - ``upright``: along ``y × n + n_y² x / 4``, made tangent. Columns are
      horizontal on every upright wall, and along +x on level faces. It breaks in the
      two directions 14 degrees off the poles towards -z (near ``(0, ±0.97, -0.24)``), not at
      the poles themselves, so slight tilts of a table top do not turn its imprints.
    - ``transported``: the x axis, turned the shortest way from +y to the normal.
      It breaks at -y alone.
    """
    axes = _transported_x(normals) if orientation == "transported" else _upright_x(normals)
    axes = axes - np.einsum("ij,ij->i", axes, normals)[:, None] * normals
    lengths = np.linalg.norm(axes, axis=1)
    lost = lengths < 1e-9
    if lost.any():
        axes[lost] = _any_perpendicular(normals[lost])
        lengths[lost] = np.linalg.norm(axes[lost], axis=1)
    return axes / lengths[:, None]


def row_axes(normals: FloatArray, columns: FloatArray) -> FloatArray:
    """Give the direction (n, 3) in which an imprint's rows count up: downwards, seen from outside."""
    return np.cross(columns, normals)


def _upright_x(normals: FloatArray) -> FloatArray:
    x, y, z = normals.T
    return np.column_stack([z + _POLE_OFFSET * y**2, np.zeros_like(x), -x])


def _transported_x(normals: FloatArray) -> FloatArray:
    x, y, z = normals.T
    shrink = np.divide(x, 1 + y, out=np.zeros_like(x), where=1 + y > 1e-12)
    return np.column_stack([1 - x * shrink, -x, -z * shrink])


def _any_perpendicular(normals: FloatArray) -> FloatArray:
    least = np.eye(3)[np.argmin(np.abs(normals), axis=1)]
    return np.cross(least, normals)


def touched_normals(caster: RayCaster, normals: FloatArray, faces: IntArray) -> FloatArray:
    """Give the touched faces' own unit normals (n, 3), turned to the side of given ones.

    Where a face has no area, the given one, such as an interpolated one, stays.
    """
    own = caster.surface.face_normals[faces]
    side = np.einsum("ij,ij->i", own, normals)[:, None]
    own = np.where(side < 0, -own, own)
    return np.where(own.any(axis=1, keepdims=True), own, normals)
