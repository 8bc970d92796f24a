"""Polygons as triangles that cover them and no more.

A convex polygon becomes a fan: its first corner joined with each of its other edges. The fan of a
polygon that is not convex may cover more than the polygon; ear clipping cuts such a polygon.
"""

from __future__ import annotations

import numpy as np
from mapbox_earcut import triangulate_float64
from numpy.typing import NDArray

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import MeshError

MOST_CORNERS_CUT = 1_000
"""Corners of one polygon that is not convex; cutting one that crosses itself takes their square."""

_AREA_TOLERANCE = 1e-6  # relative; text formats hold some six digits, so corners on a line are not
_BLOCK_CORNERS = 1 << 14
_BLOCK_POLYGONS = 1 << 12


def cuts(
    points: NDArray[np.floating], corners: NDArray[np.integer], counts: NDArray[np.integer]
) -> dict[int, IntArray]:
    """Cut polygons whose fan covers more than the polygon, by ear clipping (``mapbox_earcut``).

    A polygon is projected along its area vector (Newell's normal) before it is cut. A polygon without
    an area vector stays a fan, and so does a polygon that crosses itself, where ear clipping comes no
    nearer to its area.

    Parameters
    ----------
    points : numpy.ndarray
        Shape (v, 3), in any unit.
    corners : numpy.ndarray
        Shape (c,): rows of `points`, polygon after polygon.
    counts : numpy.ndarray
        Shape (p,): number of corners per polygon.

    Returns
    -------
    dict
        Per index of a polygon that is cut its triangles (t, 3): indices into the polygon's own corners,
        wound as the polygon. Other polygons are no keys.

    Raises
    ------
    MeshError
        If a polygon to be cut has more than `MOST_CORNERS_CUT` corners.
    """
    found: dict[int, IntArray] = {}
    corner = 0
    for first in range(0, len(counts), _BLOCK_POLYGONS):
        block = counts[first : first + _BLOCK_POLYGONS]
        starts = corner + np.cumsum(block, dtype=np.int64) - block
        for place, triangles in _cuts_of_block(points, corners, block, starts).items():
            found[first + place] = triangles
        corner += int(block.sum(dtype=np.int64))
    return found


def _cuts_of_block(
    points: NDArray[np.floating],
    corners: NDArray[np.integer],
    counts: NDArray[np.integer],
    starts: IntArray,
) -> dict[int, IntArray]:
    """Return what `cuts` does for polygons whose corners begin at `starts` (p,)."""
    found: dict[int, IntArray] = {}
    for count in map(int, np.unique(counts[counts > 3])):
        alike = np.flatnonzero(counts == count)
        blocks = -(-len(alike) * count // _BLOCK_CORNERS)
        for indices in np.array_split(alike, blocks):
            polygons = points[corners[starts[indices, None] + np.arange(count)]]
            cut = _cut_polygons(polygons.astype(np.float64, copy=False))
            found |= {int(indices[index]): triangles for index, triangles in cut.items()}
    return found


def triangulate(
    points: NDArray[np.floating], corners: NDArray[np.integer], counts: NDArray[np.integer]
) -> tuple[IntArray, NDArray[np.int32]]:
    """Cut polygons into triangles, polygon after polygon.

    Parameters
    ----------
    points, corners, counts : numpy.ndarray
        Polygons as `cuts` takes them.

    Returns
    -------
    triangles : numpy.ndarray
        Shape (t, 3): indices into `corners`.
    pieces : numpy.ndarray
        Shape (p,), int32: number of triangles per polygon, 0 if it has fewer than three corners.
    """
    if (counts == 3).all():
        return np.arange(len(corners)).reshape(-1, 3), np.ones(len(counts), dtype=np.int32)
    cut = cuts(points, corners, counts)
    pieces = np.maximum(counts, 2, dtype=np.int32, casting="same_kind")
    pieces -= 2
    for polygon, triangles in cut.items():
        pieces[polygon] = len(triangles)
    return _all_triangles(counts, pieces, cut), pieces


def _all_triangles(
    counts: NDArray[np.integer], pieces: NDArray[np.int32], cut: dict[int, IntArray]
) -> IntArray:
    """Return triangles (t, 3) of all polygons, indices into their corners."""
    found = np.empty((pieces.sum(dtype=np.int64), 3), dtype=np.int64)
    numbers = np.array(sorted(cut), dtype=np.int64)
    corner = triangle = 0
    # Without blocks, several arrays as large as `found` would be needed at once.
    for first in range(0, len(counts), _BLOCK_POLYGONS):
        last = first + _BLOCK_POLYGONS
        here = numbers[slice(*np.searchsorted(numbers, [first, last]))].tolist()
        inside = {number - first: cut[number] for number in here}
        fans = _fans(counts[first:last], pieces[first:last], inside)
        np.add(fans, corner, out=found[triangle : triangle + len(fans)])
        triangle += len(fans)
        corner += int(counts[first:last].sum(dtype=np.int64))
    return found


def _fans(
    counts: NDArray[np.integer], pieces: NDArray[np.int32], cut: dict[int, IntArray]
) -> IntArray:
    """Return triangles (t, 3), indices into the polygons' corners: of `cut` where it has them, else fans."""
    owners = np.repeat(np.arange(len(counts)), pieces)
    starts = np.cumsum(counts, dtype=np.int64) - counts
    begins = np.cumsum(pieces, dtype=np.int64) - pieces
    first, second = starts[owners], np.arange(len(owners)) - begins[owners] + 1
    triangles = np.column_stack([first, first + second, first + second + 1])
    for polygon, inner in cut.items():
        triangles[begins[polygon] : begins[polygon] + len(inner)] = starts[polygon] + inner
    return triangles


def named_triangles(
    points: NDArray[np.floating], corners: NDArray[np.integer], counts: NDArray[np.integer]
) -> tuple[IntArray, NDArray[np.int32]]:
    """Cut polygons as `triangulate` does; the triangles (t, 3), int64, are rows of `points`.

    Also returns the number of triangles (p,) per polygon.
    """
    if (counts == 3).all():
        ones = np.broadcast_to(np.int32(1), len(counts))
        return corners.reshape(-1, 3).astype(np.int64, copy=False), ones
    triangles, pieces = triangulate(points, corners, counts)
    # Without blocks, a second array as large as `triangles` would be needed.
    for start in range(0, len(triangles), _BLOCK_CORNERS):
        block = triangles[start : start + _BLOCK_CORNERS]
        block[:] = corners[block]
    return triangles, pieces


def index_runs(starts: IntArray, counts: IntArray, step: int = 1) -> IntArray:
    """Return runs of indices, one after another.

    Run i begins at `starts[i]` and has `counts[i]` indices, each `step` above the one before it. Of
    starts (n,) and counts (n,) the result has the shape (sum of counts,).
    """
    ends = np.cumsum(counts)
    firsts = np.repeat(starts - step * (ends - counts), counts)
    return firsts + step * np.arange(len(firsts))


def check_corners(corners: NDArray[np.integer], vertices: int, first: int = 0) -> None:
    """Check that corners, of any shape, name vertices; these are counted from `first`.

    Raises `MeshError`, with the reason only, that names the first corner that is wrong.
    """
    if not len(corners):
        return
    last = first + vertices - 1
    # Masks of all corners take memory, and only a broken file needs them.
    if corners.min() >= first and corners.max() <= last:
        return
    if not vertices:
        raise MeshError(f"a face names vertex {corners.flat[0]}, and no vertices are there")
    wrong = corners[(corners < first) | (corners > last)][0]
    raise MeshError(f"a face names vertex {wrong}; {first} to {last} are there")


def _cut_polygons(polygons: FloatArray) -> dict[int, IntArray]:
    """Cut polygons (p, n, 3), in any unit, whose fan covers more than the polygon; return as `cuts` does."""
    # A polygon of one point, or with a NaN, becomes NaN throughout: no comparison below is true of it.
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        units = np.abs(polygons).max(axis=(1, 2), keepdims=True)
        polygons = polygons / units - polygons[:, :1] / units
        crosses = np.cross(polygons[:, 1:-1], polygons[:, 2:])
        vectors = crosses.sum(axis=1)
        areas = np.linalg.norm(vectors, axis=1)
        normals = vectors / areas[:, None]
        covered = np.abs(np.einsum("ptk,pk->pt", crosses, normals)).sum(axis=1)
        wrong = np.flatnonzero(covered - areas > _AREA_TOLERANCE * areas)
    if not len(wrong):
        return {}
    found = {}
    for index, flat in zip(
        wrong.tolist(), _projected(polygons[wrong], normals[wrong]), strict=True
    ):
        triangles = _ear_clipped(flat)
        if triangles is not None:
            found[index] = triangles
    return found


def _projected(polygons: FloatArray, normals: FloatArray) -> FloatArray:
    """Project polygons (p, n, 3) along the longest axis of their normals (p, 3), keeping their sense: (p, n, 2)."""
    along = np.einsum("pnk,pk->pn", polygons, normals)
    flat = polygons - along[..., None] * normals[:, None]
    axes = np.abs(normals).argmax(axis=1)
    others = (axes[:, None] + [1, 2]) % 3
    backwards = np.take_along_axis(normals, axes[:, None], axis=1)[:, 0] < 0
    others[backwards] = others[backwards][:, ::-1]
    return np.ascontiguousarray(np.take_along_axis(flat, others[:, None], axis=2))


def _ear_clipped(flat: FloatArray) -> IntArray | None:
    """Cut a counter-clockwise polygon (n, 2) into triangles (t, 3); None where its fan is at least as near to its area."""
    if len(flat) > MOST_CORNERS_CUT:
        raise MeshError(
            f"a polygon that is not convex has {len(flat)} corners; {MOST_CORNERS_CUT} are allowed: cut "
            "it into triangles when exporting"
        )
    found = triangulate_float64(flat, np.array([len(flat)], dtype=np.uint32))
    triangles = found.reshape(-1, 3).astype(np.int64)
    first, second, third = flat[triangles].transpose(1, 0, 2)
    signed = _cross(second - first, third - first)
    triangles[signed < 0] = triangles[signed < 0][:, ::-1]
    fanned = _cross(flat[1:-1], flat[2:])
    excess = np.abs(fanned).sum() - fanned.sum()
    return triangles if np.abs(np.abs(signed).sum() - fanned.sum()) < excess else None


def _cross(first: FloatArray, second: FloatArray) -> FloatArray:
    return first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]
