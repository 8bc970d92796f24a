"""The largest square that does not penetrate the object, by rays within its plane."""

from __future__ import annotations

import numpy as np

from visuohaptic.base.arrays import FloatArray
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.sensor.imprints import RAYS_IN_FLIGHT, Poses, sensing_offsets

PERIMETER_RAYS = 128
"""Rays from the centre of a square to its perimeter."""

# A square is smaller than its bound by this share, so that rounding can't make it touch the bound.
_STAND_CLEAR = 1e-9


def box_heights(caster: RayCaster, poses: Poses) -> FloatArray:
    """Compute the largest height (n,) of the object's bounding box above each tangent plane, object radii."""
    corners = np.where(
        poses.normals > 0, caster.bounds[1] - poses.points, caster.bounds[0] - poses.points
    )
    return (corners * poses.normals).sum(axis=1)


def free_half_sizes(caster: RayCaster, poses: Poses, height: float) -> FloatArray:
    """Compute the half edge (n,) to which a square can grow before the surface crosses its plane, object radii.

    The plane lies at `height`, the penetration tolerance, above the tangent plane. Rays within this plane, from the
    centre to `PERIMETER_RAYS` points of the perimeter, hit the surface where it crosses the plane. They also hit
    sheets parallel to the normal, which rays along the normal miss. Without a hit the result is infinite.
    """
    free = np.full(len(poses), np.inf)
    step = RAYS_IN_FLIGHT // PERIMETER_RAYS
    perimeter = _perimeter_directions()
    for start in range(0, len(poses), step):
        part = poses[start : start + step]
        # Directions have length 1 in the maximum norm, so that distances are half edges. Components are separate
        # arrays, so that NumPy's inner loops run along the rays.
        directions = (
            perimeter[:, 0] * part.columns.T[:, :, None] + perimeter[:, 1] * part.rows.T[:, :, None]
        )
        origins = np.repeat((part.points + height * part.normals).T, PERIMETER_RAYS, axis=1)
        distances = caster.first_hits(origins.T, directions.reshape(3, -1).T).distance
        free[start : start + step] = distances.reshape(-1, PERIMETER_RAYS).min(axis=1)
    return free


def unobstructed_half_sizes(heights: FloatArray, sizes: FloatArray, tolerance: float) -> FloatArray:
    """Compute the half edge (n,) of the square without sensing points above `tolerance`, object radii.

    The result is the distance in the maximum norm from the centre to the nearest sensing point above the tolerance.
    Without such a point it is infinite. `heights` (n, r, r) are results of `cast_heights` for squares with edges
    `sizes` (n,), object radii.
    """
    offsets = np.abs(sensing_offsets(heights.shape[-1]))
    distance = np.maximum(offsets[:, None], offsets[None, :])
    nearest = np.where(heights > tolerance, distance, np.inf).min(axis=(1, 2))
    return 0.5 * sizes * nearest


def approach_distances(caster: RayCaster, poses: Poses, height: float) -> FloatArray:
    """Compute the height (n,) of the first obstacle above each tangent plane, along the normal, object radii.

    The search starts at `height` above the plane. The result is infinite without an obstacle.
    """
    origins = poses.points + height * poses.normals
    return height + caster.first_hits(origins, poses.normals).distance


def admissible_sizes(half_sizes: FloatArray, smallest: float, largest: float) -> FloatArray:
    """Return the edges (n,) of squares from bounds on their half edges (n,), object radii."""
    return np.clip(2 * half_sizes * (1 - _STAND_CLEAR), smallest, largest)


def _perimeter_directions() -> FloatArray:
    side = PERIMETER_RAYS // 4
    along = -1 + 2 * np.arange(side) / side
    edge = np.ones(side)
    return np.concatenate(
        [
            np.column_stack([along, -edge]),
            np.column_stack([edge, along]),
            np.column_stack([-along, edge]),
            np.column_stack([-edge, -along]),
        ]
    )
