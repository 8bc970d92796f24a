"""Casting the sensing points of many sensors at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import BoolArray, FloatArray
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.sensor.frames import column_axes, row_axes
from visuohaptic.sensor.parameters import Orientation

# Rays in flight at a time: bounds the memory, and keeps the arrays of a step within the cache.
RAYS_IN_FLIGHT = 1 << 15
# A ray that falls deeper than both its neighbours by this many of their spacings may have
# slipped through a crack of the mesh.
CRACK_DEPTH = 4.0
SMOOTHING_RESOLUTION = 8


@dataclass(frozen=True)
class Poses:
    """Frames of n sensors, (n, 3) each.

    `points` are the squares' centres, object frame. The other three are right-angled unit axes:
    `normals` point away from the object, `columns` and `rows` are the imprint's axes.
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


def stand_on(
    points: FloatArray, normals: FloatArray, orientation: Orientation = "upright"
) -> Poses:
    """Place sensors on points (n, 3) with outward unit normals (n, 3), turned as `column_axes` says."""
    columns = column_axes(normals, orientation)
    return Poses(points, normals, columns, row_axes(normals, columns))


def sensing_offsets(resolution: int) -> FloatArray:
    """Give the sensing points along one axis of the square, in half its edges: centres of equal cells."""
    return (2 * np.arange(resolution) + 1 - resolution) / resolution


def cast_heights(
    caster: RayCaster,
    poses: Poses,
    sizes: FloatArray,
    lifts: FloatArray,
    resolution: int | tuple[int, int],
) -> FloatArray:
    """Cast the sensing points along the normals and give the surface's height at each, object radii.

    Heights (n, r, r) are those of the first surface met above the tangent plane, negative below it,
    minus infinity where nothing is met; row and column index run along `Poses.rows` and
    `Poses.columns`. `sizes` (n,) are the squares' edges, and `lifts` (n,) the heights above the
    tangent plane at which rays start. Rectangles have sizes (n, 2), along the rows' axis and along
    the columns', and a resolution of rows and columns.
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
    """Give the mean unit normal (n, 3) of the surface under each sensor, within 90 degrees of the pose's own.

    The surface within the clearance, the height of the sensor's body, above and below the plane is
    sampled on an even grid of the square. Samples have equal weights; their normals are flipped
    towards the sensor, and the pose's own normal is one more sample.
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
    # Component by component, so that NumPy's inner loops run along the rays.
    down, aside = (
        0.5 * edges[:, [place]] * sensing_offsets(count) for place, count in enumerate(grid)
    )
    centres = (poses.points + lifts[:, None] * poses.normals).T
    along_rows = centres[:, :, None] + down * poses.rows.T[:, :, None]
    along_columns = aside * poses.columns.T[:, :, None]
    origins = along_rows[:, :, :, None] + along_columns[:, :, None, :]
    directions = np.repeat(-poses.normals.T, grid[0] * grid[1], axis=1)
    return origins.reshape(3, -1).T, directions.T


def _falls_between(distances: FloatArray, drop: FloatArray) -> BoolArray:
    falls = np.zeros(distances.shape, dtype=bool)
    bounds = distances - drop[:, None, None]
    inner = slice(1, -1)
    falls[:, :, inner] = bounds[:, :, inner] > np.maximum(distances[:, :, :-2], distances[:, :, 2:])
    falls[:, inner] |= bounds[:, inner] > np.maximum(distances[:, :-2], distances[:, 2:])
    return falls
