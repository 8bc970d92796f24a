"""Which side of a surface is outside."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from visuohaptic.geometry.raycasting import RayCaster

_STAND_OFF = 1e-5


def orient_outwards(
    caster: RayCaster, points: NDArray[np.float64], normals: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Turn normals to the side from which a sensor can come.

    A ray is sent off each side. The side with the longer free way is outside; a ray that
    leaves the object has an endless one. Where both sides are equally free (a single sheet), outside is
    the side that faces away from the object's centre, independent of the face's winding.

    Parameters
    ----------
    caster : RayCaster
        The object.
    points : numpy.ndarray
        Shape (n, 3), float64, on the surface, object frame.
    normals : numpy.ndarray
        Shape (n, 3), float64, unit normals of either sign.

    Returns
    -------
    numpy.ndarray
        Shape (n, 3), float64: each the given normal or its opposite.
    """
    facing_away = np.einsum("ij,ij->i", points, normals) >= 0
    normals = np.where(facing_away[:, None], normals, -normals)
    outside = caster.first_hits(points + _STAND_OFF * normals, normals).distance
    inside = caster.first_hits(points - _STAND_OFF * normals, -normals).distance
    return np.where((inside > outside)[:, None], -normals, normals)
