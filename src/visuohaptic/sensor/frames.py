"""The sensor's frame on the surface: the outward normal, and the axes of the imprint's columns and rows."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from visuohaptic.base.arrays import FloatArray, IntArray

if TYPE_CHECKING:
    from visuohaptic.geometry.raycasting import RayCaster
    from visuohaptic.sensor.parameters import Orientation

# Moves the two discontinuities of `upright` from the poles, the normals of horizontal faces, by 14.5 degrees.
_POLE_OFFSET = 0.25


def column_axes(normals: FloatArray, orientation: Orientation = "upright") -> FloatArray:
    """Compute the unit axis (n, 3) along which an imprint's column index increases, from the outward normal (n, 3).

    Seen from outside, columns increase to the right and rows downwards (`row_axes`); y is up. No rule is continuous
    over all normals (hairy ball theorem):

    - ``upright``: ``y × n + n_y² x / 4``, projected to the tangent plane. Columns are horizontal on vertical walls,
      and along +x on horizontal faces. The discontinuities are at normals 14 degrees from the poles towards -z, near
      ``(0, ±0.97, -0.24)``. So slight tilts of a table top do not turn its imprints.
    - ``transported``: the x axis, turned by the smallest rotation from +y to the normal. The discontinuity is at -y.
    """
    axes = _transported_x(normals) if orientation == "transported" else _upright_x(normals)
    axes = axes - np.einsum("ij,ij->i", axes, normals)[:, None] * normals
    lengths = np.linalg.norm(axes, axis=1)
    undefined = lengths < 1e-9
    if undefined.any():
        axes[undefined] = _any_perpendicular(normals[undefined])
        lengths[undefined] = np.linalg.norm(axes[undefined], axis=1)
    return axes / lengths[:, None]


def row_axes(normals: FloatArray, columns: FloatArray) -> FloatArray:
    """Compute the unit axis (n, 3) along which an imprint's row index increases: downwards, seen from outside."""
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
    """Return the unit normals (n, 3) of faces (n,), flipped to the side of `normals` (n, 3).

    Faces without an area keep their entry of `normals`.
    """
    flat = caster.surface.face_normals[faces]
    side = np.einsum("ij,ij->i", flat, normals)[:, None]
    flat = np.where(side < 0, -flat, flat)
    return np.where(flat.any(axis=1, keepdims=True), flat, normals)
