"""The largest pad that does not penetrate the object, by rays within the plane of a flat pad."""

from __future__ import annotations

import numpy as np

from visuohaptic.base.arrays import FloatArray
from visuohaptic.geometry.layouts import Layout
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.sensor.imprints import RAYS_IN_FLIGHT, Poses

# A pad is smaller than its bound by this share, so that rounding can't make it touch the bound.
_STAND_CLEAR = 1e-9


def box_heights(caster: RayCaster, poses: Poses) -> FloatArray:
    """Compute the largest height (n,) of the object's bounding box above each tangent plane, object radii."""
    corners = np.where(
        poses.normals > 0, caster.bounds[1] - poses.points, caster.bounds[0] - poses.points
    )
    return (corners * poses.normals).sum(axis=1)


def free_half_sizes(caster: RayCaster, poses: Poses, height: float, layout: Layout) -> FloatArray:
    """Compute the half width (n,) to which a flat pad can grow before the surface crosses its plane, object radii.

    The plane lies at `height`, the penetration tolerance, above the tangent plane. Rays within this plane, from the
    centre to the points of `layout.outline`, hit the surface where it crosses the plane. They also hit sheets parallel
    to the normal, which rays along the normal miss. Without a hit, and for a pad that is not flat, the result is infinite.
    """
    free = np.full(len(poses), np.inf)
    outline = layout.outline
    if not len(outline):
        return free
    step = RAYS_IN_FLIGHT // len(outline)
    for start in range(0, len(poses), step):
        part = poses[start : start + step]
        # Directions reach to the outline of the pad with the half width 1, so that distances are half widths. Components
        # are separate arrays, so that NumPy's inner loops run along the rays.
        directions = (
            outline[:, 0] * part.columns.T[:, :, None] + outline[:, 1] * part.rows.T[:, :, None]
        )
        origins = np.repeat((part.points + height * part.normals).T, len(outline), axis=1)
        distances = caster.first_hits(origins.T, directions.reshape(3, -1).T).distance
        free[start : start + step] = distances.reshape(-1, len(outline)).min(axis=1)
    return free


def unobstructed_half_sizes(
    heights: FloatArray, sizes: FloatArray, tolerance: float, layout: Layout
) -> FloatArray:
    """Compute the half width (n,) of the pad without taxels below a surface higher than `tolerance`, object radii.

    The result is the half width at which the outline crosses the nearest such taxel. Without such a taxel it is infinite.
    `heights` (n, *layout.shape) are results of `cast_heights` for pads of `sizes` (n,), object radii.
    """
    above = heights.reshape(-1, len(layout)) > tolerance
    nearest = np.where(above, layout.norms, np.inf).min(axis=1)
    return 0.5 * sizes * nearest


def approach_distances(caster: RayCaster, poses: Poses, height: float) -> FloatArray:
    """Compute the height (n,) of the first obstacle above each tangent plane, along the normal, object radii.

    The search starts at `height` above the plane. The result is infinite without an obstacle.
    """
    origins = poses.points + height * poses.normals
    return height + caster.first_hits(origins, poses.normals).distance


def admissible_sizes(half_sizes: FloatArray, smallest: float, largest: float) -> FloatArray:
    """Return the sizes (n,) of pads from bounds on their half widths (n,), object radii."""
    return np.clip(2 * half_sizes * (1 - _STAND_CLEAR), smallest, largest)
