"""Which side of a surface is outside."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from visuohaptic.base.arrays import FloatArray

if TYPE_CHECKING:
    from visuohaptic.geometry.raycasting import RayCaster

_STAND_OFF = 1e-5


def orient_outwards(caster: RayCaster, points: FloatArray, normals: FloatArray) -> FloatArray:
    """Turn unit normals (n, 3) at points (n, 3) of the surface to the side from which a sensor can come.

    The side with the longer free way is outside. Where both ways end, as in a gap, a side that lies
    in no solid, by the winding of the faces that its ray crosses, is outside if the other lies in
    one. Where both are equally free (a single sheet), it is the side away from the object's centre.
    """
    facing_away = np.einsum("ij,ij->i", points, normals) >= 0
    normals = np.where(facing_away[:, None], normals, -normals)
    before, behind = points + _STAND_OFF * normals, points - _STAND_OFF * normals
    outside = caster.first_hits(before, normals).distance
    inside = caster.first_hits(behind, -normals).distance
    turned = inside > outside
    # What lies across a gap may be nearer than the far side of the solid behind the point.
    shut = np.flatnonzero(np.isfinite(outside) & np.isfinite(inside))
    free = caster.winding_numbers(before[shut], normals[shut]) == 0
    free_behind = caster.winding_numbers(behind[shut], -normals[shut]) == 0
    turned[shut] = np.where(free == free_behind, turned[shut], free_behind)
    return np.where(turned[:, None], -normals, normals)
