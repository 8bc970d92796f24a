"""The largest square that does not penetrate the object, in closed form."""

from __future__ import annotations

import numpy as np

from visuohaptic.base.arrays import FloatArray
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.sensor.imprints import RAYS_IN_FLIGHT, Poses, sensing_offsets

PERIMETER_RAYS = 128
# Relative distance by which a square stays clear of what bounds it.
_STAND_CLEAR = 1e-9


def box_heights(caster: RayCaster, poses: Poses) -> FloatArray:
    """Find how far (n,) the object's bounding box reaches above each tangent plane, in object radii."""
    corners = np.where(
        poses.normals > 0, caster.bounds[1] - poses.points, caster.bounds[0] - poses.points
    )
    return (corners * poses.normals).sum(axis=1)


def free_half_sizes(caster: RayCaster, poses: Poses, height: float) -> FloatArray:
    """Find how far (n,) a square can grow before the surface crosses its plane, in object radii.

    The plane is at a height above the tangent plane: the penetration tolerance. The surface that
    penetrates it is bounded by where it crosses it, so rays within the plane, from the centre
    towards `PERIMETER_RAYS` points of the square's perimeter, meet that bound exactly: also sheets
    along the normal, which no ray along the normal sees. It is infinite where none meets anything.
    """
    free = np.full(len(poses), np.inf)
    step = RAYS_IN_FLIGHT // PERIMETER_RAYS
    perimeter = _perimeter_directions()
    for start in range(0, len(poses), step):
        part = poses[start : start + step]
        # Directions are one in the maximum norm, so that distances are half sizes; and component by
        # component, so that NumPy's inner loops run along the rays.
        directions = (
            perimeter[:, 0] * part.columns.T[:, :, None] + perimeter[:, 1] * part.rows.T[:, :, None]
        )
        origins = np.repeat((part.points + height * part.normals).T, PERIMETER_RAYS, axis=1)
        distances = caster.first_hits(origins.T, directions.reshape(3, -1).T).distance
        free[start : start + step] = distances.reshape(-1, PERIMETER_RAYS).min(axis=1)
    return free


def unobstructed_half_sizes(heights: FloatArray, sizes: FloatArray, tolerance: float) -> FloatArray:
    """Find the half edge (n,) of the square within which no sensing point stands above a tolerance.

    It is the distance in the maximum norm from the centre to the nearest penetrated sensing point,
    infinite where there is none. `heights` (n, r, r) are `cast_heights` of squares of the edges
    `sizes` (n,); all lengths are in object radii.
    """
    offsets = np.abs(sensing_offsets(heights.shape[-1]))
    distance = np.maximum(offsets[:, None], offsets[None, :])
    nearest = np.where(heights > tolerance, distance, np.inf).min(axis=(1, 2))
    return 0.5 * sizes * nearest


def approach_distances(caster: RayCaster, poses: Poses, height: float) -> FloatArray:
    """Find how far (n,) above its tangent plane each sensor's centre can be drawn back along its normal.

    The way starts at a height above the plane; it is infinite where it is open. All in object
    radii.
    """
    origins = poses.points + height * poses.normals
    return height + caster.first_hits(origins, poses.normals).distance


def admissible_sizes(half_sizes: FloatArray, smallest: float, largest: float) -> FloatArray:
    """Give the edge of the square from the half size within which nothing penetrates, in object radii."""
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
