"""Compute the points of triangles that are nearest to other points."""

from __future__ import annotations

import numpy as np

from visuohaptic.base.arrays import FloatArray
from visuohaptic.geometry.vectors import dot


def nearest_on(triangles: FloatArray, points: FloatArray) -> FloatArray:
    """Compute the point (n, 3) of each triangle (n, 3, 3), inside or on an edge, that is nearest to each point (n, 3)."""
    edges = np.roll(triangles, -1, axis=1) - triangles
    offsets = points[:, None] - triangles
    squares = dot(edges, edges)
    along = np.divide(dot(offsets, edges), squares, out=np.zeros_like(squares), where=squares > 0)
    on_edges = triangles + np.clip(along, 0.0, 1.0)[..., None] * edges
    edge_offsets = on_edges - points[:, None]
    rows = np.arange(len(points))
    nearest_on_edges = on_edges[rows, dot(edge_offsets, edge_offsets).argmin(axis=1)]
    crosses = np.cross(edges[:, 0], edges[:, 1])
    sides = dot(np.cross(edges, offsets), crosses[:, None])
    above = (sides >= 0).all(axis=1) & (dot(crosses, crosses) > 0)
    squares = np.where(above, dot(crosses, crosses), 1.0)
    projected = points - (dot(offsets[:, 0], crosses) / squares)[:, None] * crosses
    return np.where(above[:, None], projected, nearest_on_edges)
