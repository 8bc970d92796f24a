"""Reference results by brute force in float64. Nothing here imports the library."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

UNSURE = 1e-12
"""Distance from an edge, in barycentric weights, below which rounding may decide whether a ray hits."""


def first_hits(
    triangles: FloatArray, origins: FloatArray, directions: FloatArray
) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Compute the first hit of each ray by intersecting it with every triangle, by Cramer's rule.

    Parameters
    ----------
    triangles : array (f, 3, 3), float64
        Corners of the faces.
    origins, directions : array (n, 3), float64
        The rays; directions need not have unit length.

    Returns
    -------
    distance : array (n,), float64
        Distance of the nearest hit in units of the direction's length; infinite without a hit.
    unsure : array (n,), bool
        Whether some decision was so close that rounding may have changed it.
    """
    distance = np.full(len(origins), np.inf)
    unsure = np.zeros(len(origins), dtype=bool)
    corner, first, second = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    a, b = first - corner, second - corner
    normal = np.cross(a, b)
    size = np.linalg.norm(normal, axis=1)
    longer = np.maximum(np.linalg.norm(a, axis=1), np.linalg.norm(b, axis=1))
    step = max(1, 2_000_000 // max(len(triangles), 1))
    for start in range(0, len(origins), step):
        rows = slice(start, start + step)
        o, d = origins[rows, None], directions[rows, None]
        length = np.linalg.norm(d, axis=2)
        determinant = -(d * normal).sum(axis=2)
        usable = np.abs(determinant) > 0
        inverse = np.divide(1.0, determinant, out=np.zeros_like(determinant), where=usable)
        s = o - corner
        t = (s * normal).sum(axis=2) * inverse
        q = np.cross(s, d)
        u = (q * b).sum(axis=2) * inverse
        v = -(q * a).sum(axis=2) * inverse
        least = np.minimum(np.minimum(u, v), 1 - u - v)
        ahead = usable & (t >= 0)
        met = ahead & (least >= 0)
        # The rounding error of u and v is about 16 u64 × the product of the lengths over the determinant.
        reach = np.linalg.norm(s, axis=2) * length * longer
        noise = UNSURE + 32 * 2.0**-53 * reach * np.abs(inverse)
        grazing = (size > 0) & (np.abs(determinant) < 1e-12 * size * length)
        doubt = (ahead & (np.abs(least) < noise)) | grazing | (usable & (np.abs(t) < UNSURE))
        distance[rows] = np.where(met, t, np.inf).min(axis=1)
        unsure[rows] = doubt.any(axis=1)
    return distance, unsure
