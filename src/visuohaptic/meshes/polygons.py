"""Polygons that are not convex, cut into triangles that cover them and no more.

trimesh cuts a polygon into a fan from its first corner, which is right for a convex one. Where a fan
covers more than the polygon, a file's reader puts the triangles of `cuts` in its place.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from visuohaptic.errors import MeshError

MOST_CORNERS_CUT = 2_000
"""Corners of one polygon that is not convex; cutting one that crosses itself takes their square."""

_AREA_TOLERANCE = 1e-6  # relative; text formats hold some six digits, so corners on a line are not
_BLOCK_CORNERS = 1 << 18


def cuts(
    points: NDArray[np.float64], corners: NDArray[np.int64], counts: NDArray[np.int64]
) -> dict[int, NDArray[np.int64]]:
    """Cut each polygon that its fan does not cover exactly, by ear clipping (``mapbox_earcut``).

    A polygon is seen along its area vector (Newell's normal), so one that is not flat is cut as its
    projection. One without an area vector, or that crosses itself so that ear clipping comes no nearer
    to its area, stays a fan.

    Parameters
    ----------
    points : numpy.ndarray
        Shape (v, 3), float64.
    corners : numpy.ndarray
        Shape (c,), int64; rows of `points`, polygon after polygon.
    counts : numpy.ndarray
        Shape (p,), int64; corners of each polygon.

    Returns
    -------
    dict of int to numpy.ndarray
        For each polygon that needs it, triangles of shape (t, 3), int64: places among its own
        corners, in its own winding.

    Raises
    ------
    MeshError
        With the reason alone, if such a polygon has more than `MOST_CORNERS_CUT` corners.
    """
    starts = np.cumsum(counts) - counts
    found = {}
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        for place in _badly_fanned(points, corners, starts, counts):
            polygon = points[corners[starts[place] : starts[place] + counts[place]]]
            triangles = _ear_clipped(polygon)
            if triangles is not None:
                found[place] = triangles
    return found


def fan(count: int) -> NDArray[np.int64]:
    """Give the triangles, shape (count - 2, 3), of a polygon that is cut from its first corner."""
    second = np.arange(1, max(count - 1, 1))
    return np.column_stack([np.zeros_like(second), second, second + 1])


def check_corners(corners: NDArray[np.int64], vertices: int, first: int = 0) -> None:
    """Refuse, with the reason alone, corners that name no vertex; vertices are counted from `first`."""
    wrong = corners[(corners < first) | (corners >= first + vertices)]
    if len(wrong):
        raise MeshError(
            f"a face names vertex {wrong[0]}; {first} to {first + vertices - 1} are there"
        )


def _badly_fanned(
    points: NDArray[np.float64],
    corners: NDArray[np.int64],
    starts: NDArray[np.int64],
    counts: NDArray[np.int64],
) -> Iterator[int]:
    for count in np.unique(counts[counts > 3]):
        places = np.flatnonzero(counts == count)
        for block in np.array_split(places, -(-len(places) * count // _BLOCK_CORNERS)):
            polygons = points[corners[starts[block, None] + np.arange(count)]]
            area, covered = _areas(_fan_crosses(polygons))
            yield from map(int, block[covered - area > _AREA_TOLERANCE * area])


def _fan_crosses(polygons: NDArray[np.float64]) -> NDArray[np.float64]:
    """Give twice the area vectors of fans' triangles, (p, n - 2, 3), of polygons (p, n, 3) of any unit."""
    units = np.abs(polygons).max(axis=(1, 2), keepdims=True)
    arms = polygons[:, 1:] / units - polygons[:, :1] / units
    return np.cross(arms[:, :-1], arms[:, 1:])


def _areas(crosses: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Give the area of each polygon, and that which its triangles cover, both seen along its normal."""
    vectors = crosses.sum(axis=1)
    areas = np.linalg.norm(vectors, axis=1)
    along = np.einsum("ptk,pk->pt", crosses, vectors / areas[:, None])
    return areas, np.abs(along).sum(axis=1)


def _ear_clipped(polygon: NDArray[np.float64]) -> NDArray[np.int64] | None:
    from mapbox_earcut import triangulate_float64

    if len(polygon) > MOST_CORNERS_CUT:
        raise MeshError(
            f"a polygon that is not convex has {len(polygon)} corners; {MOST_CORNERS_CUT} are "
            "allowed: cut it into triangles when exporting"
        )
    crosses = _fan_crosses(polygon[None])
    flat = _projected(polygon, crosses[0].sum(axis=0))
    ring = np.array([len(flat)], dtype=np.uint32)
    triangles = triangulate_float64(flat, ring).reshape(-1, 3).astype(np.int64)
    first, second, third = flat[triangles].transpose(1, 0, 2)
    signed = _cross(second - first, third - first)
    triangles[signed < 0] = triangles[signed < 0][:, ::-1]
    spread = flat - flat[0]
    fanned = _cross(spread[1:-1], spread[2:])
    area = fanned.sum()
    better = abs(np.abs(signed).sum() - area) < np.abs(fanned).sum() - area
    return triangles if better else None


def _projected(polygon: NDArray[np.float64], normal: NDArray[np.float64]) -> NDArray[np.float64]:
    """Project along the normal, then leave out its largest axis; counter-clockwise stays so."""
    unit = normal / np.linalg.norm(normal)
    centred = polygon / np.abs(polygon).max()
    centred = centred - centred[0]
    flat = centred - np.outer(centred @ unit, unit)
    axis = int(np.abs(unit).argmax())
    others = [(axis + 1) % 3, (axis + 2) % 3]
    return np.ascontiguousarray(flat[:, others if unit[axis] > 0 else others[::-1]])


def _cross(first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
    return first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
