"""Poses of sensors, and ray casting from their sensing points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import BoolArray, FloatArray
from visuohaptic.geometry.layouts import Layout, grid_layout
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


def cast_heights(
    caster: RayCaster,
    poses: Poses,
    sizes: FloatArray,
    lifts: FloatArray,
    layout: Layout,
) -> FloatArray:
    """Cast a ray from each taxel along its direction and return the height of the surface.

    Parameters
    ----------
    caster : RayCaster
        The surface, prepared for rays.
    poses : Poses
        The n sensors.
    sizes : ndarray of shape (n,) or (n, 2)
        Widths of the pads, object radii; for rectangles the edges along `Poses.rows` and `Poses.columns`.
    lifts : ndarray of shape (n,)
        Distances behind the taxels at which the rays start, object radii; in a curved pad at most `Layout.body`.
    layout : Layout
        The taxels.

    Returns
    -------
    ndarray of shape (n, *layout.shape), float64
        Height of the first hit above each taxel, against the taxel's direction, object radii: negative for a gap, minus
        infinity without a hit. The taxels of a flat pad are in the tangent plane.
    """
    edges = sizes if sizes.ndim == 2 else np.column_stack([sizes, sizes])
    heights = np.full((len(poses), len(layout)), -np.inf)
    step = max(1, RAYS_IN_FLIGHT // len(layout))
    for start in range(0, len(poses), step):
        part = slice(start, start + step)
        heights[part] = _cast_part(caster, poses[part], edges[part], lifts[part], layout)
    return heights.reshape(len(poses), *layout.shape)


def _cast_part(
    caster: RayCaster, poses: Poses, edges: FloatArray, lifts: FloatArray, layout: Layout
) -> FloatArray:
    lifts = np.minimum(lifts, 0.5 * edges[:, 1] * layout.body)
    origins, directions = _rays(poses, edges, lifts, layout)
    drop = np.max(CRACK_DEPTH * edges / np.array(layout.counts), axis=1)

    def falls_between(distances: FloatArray) -> BoolArray:
        return _falls_between(distances.reshape(len(poses), -1), drop, layout).ravel()

    distances = caster.first_hits(origins, directions, falls_between).distance
    return lifts[:, None] - distances.reshape(len(poses), -1)


def smooth_normals(caster: RayCaster, poses: Poses, size: float, clearance: float) -> FloatArray:
    """Compute the mean unit normal (n, 3) of the surface under each sensor.

    Rays sample an even grid of the square with the edge `size`. Only hits within `clearance`, the height of the
    sensor's body, above and below the tangent plane count. Their face normals, flipped towards the sensor, and the
    pose's normal have equal weights. So the result is less than 90 degrees from the pose's normal.
    """
    count = len(poses)
    grid = grid_layout(SMOOTHING_RESOLUTION, SMOOTHING_RESOLUTION)
    origins, directions = _rays(poses, np.full((count, 2), size), np.full(count, clearance), grid)
    hits = caster.first_hits(origins, directions)
    normals = caster.surface.face_normals[hits.face]
    towards = np.einsum("ij,ij->i", normals, directions) < 0
    normals = np.where(towards[:, None], normals, -normals)
    normals[~(hits.distance <= 2 * clearance)] = 0.0
    total = poses.normals + normals.reshape(count, -1, 3).sum(axis=1)
    return total / np.linalg.norm(total, axis=1, keepdims=True)


def _rays(
    poses: Poses, edges: FloatArray, lifts: FloatArray, layout: Layout
) -> tuple[FloatArray, FloatArray]:
    """Return origins and directions of the rays from all taxels, (n × taxels, 3) each."""
    # Components are separate arrays, so that NumPy's inner loops run along the rays.
    over_taxels = (..., *[None] * len(layout.shape))
    half = 0.5 * edges
    scales = (half[:, 1], half[:, 0], half[:, 1])
    axes = (poses.columns, poses.rows, poses.normals)
    origins, directions = poses.points.T[over_taxels], []
    # The normal comes first, and rows before columns, because the order of a sum decides its last digit.
    for axis in (2, 1, 0):
        position, direction = layout.coordinates[axis]
        along = axes[axis].T[over_taxels]
        start = scales[axis][over_taxels] * position
        if direction.any():
            start = start - lifts[over_taxels] * direction
            directions.append(direction * along)
        origins = origins + start * along
    shape = (3, len(poses), *layout.shape)
    looking = np.broadcast_to(sum(directions[1:], directions[0]), shape)
    return np.broadcast_to(origins, shape).reshape(3, -1).T, looking.reshape(3, -1).T


def _falls_between(distances: FloatArray, drop: FloatArray, layout: Layout) -> BoolArray:
    """Return whether each ray (n, t) is longer than both neighbours on a line by more than `drop` (n,)."""
    falls = np.zeros(distances.shape, dtype=bool)
    bounds = distances - drop[:, None]
    if len(layout.shape) == 2:
        # Neighbours in a grid are slices, which cost a fiftieth of gathering triples.
        grid = (len(distances), *layout.shape)
        falling, deep, around = falls.reshape(grid), bounds.reshape(grid), distances.reshape(grid)
        inner = slice(1, -1)
        falling[:, :, inner] = deep[:, :, inner] > np.maximum(around[:, :, :-2], around[:, :, 2:])
        falling[:, inner] |= deep[:, inner] > np.maximum(around[:, :-2], around[:, 2:])
        return falls
    taxels, first, second = layout.triples
    deeper = bounds[:, taxels] > np.maximum(distances[:, first], distances[:, second])
    rows, fallen = np.nonzero(deeper)
    falls[rows, taxels[fallen]] = True
    return falls
