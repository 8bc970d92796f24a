"""Polygons that are not convex, cut into triangles that cover them and no more.

trimesh cuts a polygon into a fan from its first corner, which is right for a convex one. Where a fan
covers more than the polygon, a file's reader puts the triangles of `cuts` in its place.
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
    """Cut each polygon that its fan does not cover exactly, by ear clipping (``mapbox_earcut``).

    A polygon is seen along its area vector (Newell's normal), so one that is not flat is cut as its
    projection. One without an area vector, or that crosses itself so that ear clipping comes no
    nearer to its area, stays a fan.

    `corners` (c,) are rows of the points (v, 3), polygon after polygon, and `counts` (p,) how many each
    has. Gives by the number of each polygon that needs it triangles (t, 3): places among its own
    corners, in its own winding.
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
    found: dict[int, IntArray] = {}
    for count in map(int, np.unique(counts[counts > 3])):
        alike = np.flatnonzero(counts == count)
        for places in np.array_split(alike, -(-len(alike) * count // _BLOCK_CORNERS)):
            polygons = points[corners[starts[places, None] + np.arange(count)]]
            cut = _cut_polygons(polygons.astype(np.float64, copy=False))
            found |= {int(places[place]): triangles for place, triangles in cut.items()}
    return found


def triangulate(
    points: NDArray[np.floating], corners: NDArray[np.integer], counts: NDArray[np.integer]
) -> tuple[IntArray, NDArray[np.int32]]:
    """Cut polygons into triangles, in their order: each by its fan, or as `cuts` does where that is wrong.

    `points`, `corners` and `counts` are those of `cuts`. Returns triangles (t, 3), indices into
    `corners`, and how many triangles (p,) each polygon has: none if it has fewer than three corners.
    """
    if (counts == 3).all():
        return np.arange(len(corners)).reshape(-1, 3), np.ones(len(counts), dtype=np.int32)
    cut = cuts(points, corners, counts)
    pieces = np.maximum(counts, 2, dtype=np.int32, casting="same_kind")
    pieces -= 2
    for polygon, triangles in cut.items():
        pieces[polygon] = len(triangles)
    found = np.empty((pieces.sum(dtype=np.int64), 3), dtype=np.int64)
    corner = triangle = 0
    numbers = np.array(sorted(cut), dtype=np.int64)
    # Several arrays as large as `found` would be needed at once.
    for first in range(0, len(counts), _BLOCK_POLYGONS):
        block = slice(first, first + _BLOCK_POLYGONS)
        of_block = slice(*np.searchsorted(numbers, [first, first + _BLOCK_POLYGONS]))
        inside = {int(number) - first: cut[int(number)] for number in numbers[of_block]}
        fans = _fans(counts[block], pieces[block], inside)
        np.add(fans, corner, out=found[triangle : triangle + len(fans)])
        triangle, corner = triangle + len(fans), corner + int(counts[block].sum(dtype=np.int64))
    return found, pieces


def _fans(
    counts: NDArray[np.integer], pieces: NDArray[np.int32], cut: dict[int, IntArray]
) -> IntArray:
    """Return triangles (t, 3), indices into the polygons' corners: those of `cut`, else fans."""
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
    """Cut polygons as `triangulate` does, into triangles (t, 3) of rows of `points`.

    Also returns how many triangles (p,) each polygon has.
    """
    if (counts == 3).all():
        ones = np.broadcast_to(np.int32(1), len(counts))
        return corners.reshape(-1, 3).astype(np.int64, copy=False), ones
    triangles, pieces = triangulate(points, corners, counts)
    # A second array of as many triangles would be needed without blocks.
    for start in range(0, len(triangles), _BLOCK_CORNERS):
        block = triangles[start : start + _BLOCK_CORNERS]
        block[:] = corners[block]
    return triangles, pieces


def index_runs(starts: IntArray, counts: IntArray, step: int = 1) -> IntArray:
    """Return indices (sum of `counts`,) that go up from each start (n,) in steps, as many as its count."""
    ends = np.cumsum(counts)
    firsts = np.repeat(starts - step * (ends - counts), counts)
    return firsts + step * np.arange(len(firsts))


def fan(count: int) -> IntArray:
    """Give the triangles, shape (count - 2, 3), of a polygon that is cut from its first corner."""
    second = np.arange(1, max(count - 1, 1))
    return np.column_stack([np.zeros_like(second), second, second + 1])


def check_corners(corners: NDArray[np.integer], vertices: int, first: int = 0) -> None:
    """Refuse, with the reason alone, corners that name no vertex; vertices are counted from `first`."""
    if not len(corners):
        return
    last = first + vertices - 1
    # Masks of all corners take memory, and hardly any file needs them.
    if corners.min() >= first and corners.max() <= last:
        return
    if not vertices:
        raise MeshError(f"a face names vertex {corners.flat[0]}, and no vertices are there")
    wrong = corners[(corners < first) | (corners > last)][0]
    raise MeshError(f"a face names vertex {wrong}; {first} to {last} are there")


def _cut_polygons(polygons: FloatArray) -> dict[int, IntArray]:
    """Cut those of polygons (p, n, 3), in any unit, that their fans do not cover exactly."""
    # A polygon of one point, or with a NaN, has no unit and fails no comparison.
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        units = np.abs(polygons).max(axis=(1, 2), keepdims=True)
        polygons = polygons / units - polygons[:, :1] / units
        crosses = np.cross(polygons[:, 1:-1], polygons[:, 2:])
        vectors = crosses.sum(axis=1)
        areas = np.linalg.norm(vectors, axis=1)
        normals = vectors / areas[:, None]
        covered = np.abs(np.einsum("ptk,pk->pt", crosses, normals)).sum(axis=1)
        bad = np.flatnonzero(covered - areas > _AREA_TOLERANCE * areas)
    if not len(bad):
        return {}
    projected = _projected(polygons[bad], normals[bad])
    found = {int(place): _ear_clipped(flat) for place, flat in zip(bad, projected, strict=True)}
    return {place: triangles for place, triangles in found.items() if triangles is not None}


def _projected(polygons: FloatArray, normals: FloatArray) -> FloatArray:
    """Project (p, n, 3) along normals, then leave out their largest axes; counter-clockwise stays so."""
    along = np.einsum("pnk,pk->pn", polygons, normals)
    flat = polygons - along[..., None] * normals[:, None]
    axes = np.abs(normals).argmax(axis=1)
    others = (axes[:, None] + [1, 2]) % 3
    backwards = np.take_along_axis(normals, axes[:, None], axis=1)[:, 0] < 0
    others[backwards] = others[backwards][:, ::-1]
    return np.ascontiguousarray(np.take_along_axis(flat, others[:, None], axis=2))


def _ear_clipped(flat: FloatArray) -> IntArray | None:
    """Give triangles, if they cover a polygon (n, 2), whose first corner is 0, better than its fan does."""
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
