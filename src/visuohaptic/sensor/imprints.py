"""Poses of sensors, and ray casting from their sensing points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import BoolArray, FloatArray
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.sensor.frames import column_axes, row_axes
from visuohaptic.sensor.parameters import Orientation

RAYS_IN_FLIGHT = 1 << 15
"""Rays per cast: bounds the memory, and keeps the arrays within the cache."""

CRACK_DEPTH = 4.0
"""A ray that falls deeper than both its neighbours by this many spacings may have passed a crack of the mesh."""

SMOOTHING_RESOLUTION = 8
"""Rows and columns of the samples for smoothed normals."""


@dataclass(frozen=True)
class Poses:
    """Frames of n sensors, object frame.

    Attributes
    ----------
    points : ndarray of shape (n, 3)
        Centres of the squares.
    normals : ndarray of shape (n, 3)
        Unit normals, away from the object.
    columns, rows : ndarray of shape (n, 3)
        Unit axes along which the imprint's column and row index increase, perpendicular to the normals.
    """

    points: FloatArray
    normals: FloatArray
    columns: FloatArray
    rows: FloatArray

    def __len__(self) -> int:
        return len(self.points)

    def __getitem__(self, selection: slice | NDArray[np.generic]) -> Poses:
        return Poses(
            self.points[selection],
            self.normals[selection],
            self.columns[selection],
            self.rows[selection],
        )


def make_poses(
    points: FloatArray, normals: FloatArray, orientation: Orientation = "upright"
) -> Poses:
    """Return poses at points (n, 3) with outward unit normals (n, 3) and the axes of `column_axes`."""
    columns = column_axes(normals, orientation)
    return Poses(points, normals, columns, row_axes(normals, columns))


def sensing_offsets(resolution: int) -> FloatArray:
    """Return the sensing points (r,) along an axis of the square, the centres of equal cells, in half edges."""
    return (2 * np.arange(resolution) + 1 - resolution) / resolution


def cast_heights(
    caster: RayCaster,
    poses: Poses,
    sizes: FloatArray,
    lifts: FloatArray,
    resolution: int | tuple[int, int],
) -> FloatArray:
    """Cast rays from the sensing points against the normals and return the height of the surface.

    Parameters
    ----------
    caster : RayCaster
        The surface, prepared for rays.
    poses : Poses
        The n sensors.
    sizes : ndarray of shape (n,) or (n, 2)
        Edges of the squares, object radii; for rectangles the edges along `Poses.rows` and `Poses.columns`.
    lifts : ndarray of shape (n,)
        Heights above the tangent plane at which the rays start, object radii.
    resolution : int or tuple of int
        Rows and columns of sensing points.

    Returns
    -------
    ndarray of shape (n, r, c), float64
        Height of the first hit above the tangent plane, object radii: negative below the plane, minus infinity
        without a hit.
    """
    grid = (resolution, resolution) if isinstance(resolution, int) else resolution
    edges = sizes if sizes.ndim == 2 else np.column_stack([sizes, sizes])
    heights = np.full((len(poses), *grid), -np.inf)
    step = max(1, RAYS_IN_FLIGHT // (grid[0] * grid[1]))
    for start in range(0, len(poses), step):
        part = slice(start, start + step)
        heights[part] = _cast_part(caster, poses[part], edges[part], lifts[part], grid)
    return heights


def _cast_part(
    caster: RayCaster, poses: Poses, edges: FloatArray, lifts: FloatArray, grid: tuple[int, int]
) -> FloatArray:
    origins, directions = _rays(poses, edges, lifts, grid)
    drop = np.max(CRACK_DEPTH * edges / np.array(grid), axis=1)

    def falls_between(distances: FloatArray) -> BoolArray:
        return _falls_between(distances.reshape(-1, *grid), drop).ravel()

    distances = caster.first_hits(origins, directions, falls_between).distance
    return lifts[:, None, None] - distances.reshape(-1, *grid)


def smooth_normals(caster: RayCaster, poses: Poses, size: float, clearance: float) -> FloatArray:
    """Compute the mean unit normal (n, 3) of the surface under each sensor.

    Rays sample an even grid of the square with the edge `size`. Only hits within `clearance`, the height of the
    sensor's body, above and below the tangent plane count. Their face normals, flipped towards the sensor, and the
    pose's normal have equal weights. So the result is less than 90 degrees from the pose's normal.
    """
    count = len(poses)
    origins, directions = _rays(
        poses, np.full((count, 2), size), np.full(count, clearance), (SMOOTHING_RESOLUTION,) * 2
    )
    hits = caster.first_hits(origins, directions)
    normals = caster.surface.face_normals[hits.face]
    towards = np.einsum("ij,ij->i", normals, directions) < 0
    normals = np.where(towards[:, None], normals, -normals)
    normals[~(hits.distance <= 2 * clearance)] = 0.0
    total = poses.normals + normals.reshape(count, -1, 3).sum(axis=1)
    return total / np.linalg.norm(total, axis=1, keepdims=True)


def _rays(
    poses: Poses, edges: FloatArray, lifts: FloatArray, grid: tuple[int, int]
) -> tuple[FloatArray, FloatArray]:
    """Return origins and directions of the rays from all sensing points, (n × rows × columns, 3) each."""
    # Components are separate arrays, so that NumPy's inner loops run along the rays.
    down, aside = (
        0.5 * edges[:, [axis]] * sensing_offsets(count) for axis, count in enumerate(grid)
    )
    centres = (poses.points + lifts[:, None] * poses.normals).T
    along_rows = centres[:, :, None] + down * poses.rows.T[:, :, None]
    along_columns = aside * poses.columns.T[:, :, None]
    origins = along_rows[:, :, :, None] + along_columns[:, :, None, :]
    directions = np.repeat(-poses.normals.T, grid[0] * grid[1], axis=1)
    return origins.reshape(3, -1).T, directions.T


def _falls_between(distances: FloatArray, drop: FloatArray) -> BoolArray:
    """Return whether each ray (n, r, c) is longer than both its neighbours along an axis by more than `drop` (n,)."""
    falls = np.zeros(distances.shape, dtype=bool)
    bounds = distances - drop[:, None, None]
    inner = slice(1, -1)
    falls[:, :, inner] = bounds[:, :, inner] > np.maximum(distances[:, :, :-2], distances[:, :, 2:])
    falls[:, inner] |= bounds[:, inner] > np.maximum(distances[:, :-2], distances[:, 2:])
    return falls
