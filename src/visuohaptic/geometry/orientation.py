"""Turn normals of a surface to the outside."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from visuohaptic.base.arrays import FloatArray

if TYPE_CHECKING:
    from visuohaptic.geometry.raycasting import RayCaster

_STAND_OFF = 1e-5


def orient_outwards(caster: RayCaster, points: FloatArray, normals: FloatArray) -> FloatArray:
    """Return unit normals (n, 3) at points (n, 3) of the surface, turned to the side from which a sensor can approach.

    Rays along both directions of the normal decide. The direction with the longer free path is outside. If both rays
    hit the surface, as in a gap, winding numbers decide: a side outside of all solids wins against a side inside a
    solid. If both paths are equal, as on a single sheet, outside is away from the origin, the object's centre.
    """
    facing_away = np.einsum("ij,ij->i", points, normals) >= 0
    normals = np.where(facing_away[:, None], normals, -normals)
    before, behind = points + _STAND_OFF * normals, points - _STAND_OFF * normals
    distance_before = caster.first_hits(before, normals).distance
    distance_behind = caster.first_hits(behind, -normals).distance
    is_turned = distance_behind > distance_before
    # Across a gap, the opposite wall may be nearer than the far side of the solid behind the point.
    blocked = np.flatnonzero(np.isfinite(distance_before) & np.isfinite(distance_behind))
    free_before = caster.winding_numbers(before[blocked], normals[blocked]) == 0
    free_behind = caster.winding_numbers(behind[blocked], -normals[blocked]) == 0
    is_turned[blocked] = np.where(free_before == free_behind, is_turned[blocked], free_behind)
    return np.where(is_turned[:, None], -normals, normals)
