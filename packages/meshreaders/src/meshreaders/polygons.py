"""Cut polygons into triangles that cover exactly the polygon.

A convex polygon becomes a fan: its first corner with each of its opposite edges. The fan of a polygon that is not
convex may cover more than the polygon, so such a polygon is cut by ear clipping.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from mapbox_earcut import triangulate_float64
from numpy.typing import NDArray

from meshreaders.base.arrays import FloatArray, IntArray
from meshreaders.base.errors import MeshError

MOST_CORNERS_CUT = 1_000
"""Largest number of corners of a polygon that is not convex; the time of ear clipping may grow with their square."""

_AREA_TOLERANCE = (
    1e-6  # relative; text formats have some six digits, so corners are not exactly on a line
)
_BLOCK_CORNERS = 1 << 14
_BLOCK_POLYGONS = 1 << 12


def cuts(
    points: NDArray[np.floating],
    corners: NDArray[np.integer],
    counts: NDArray[np.integer],
    *,
    keep_corners: bool = True,
) -> dict[int, IntArray]:
    """Cut polygons whose fan covers more than the polygon, by ear clipping (``mapbox_earcut``).

    A polygon is projected along its area vector (Newell's normal) before it is cut. A polygon stays a fan if it has
    no area vector, or if ear clipping does not come closer to its area. Either way a polygon of n corners has n - 2
    triangles with all its corners and edges, so that a closed surface stays closed.

    Parameters
    ----------
    points : numpy.ndarray
        Shape (v, 3), in any unit.
    corners : numpy.ndarray
        Shape (c,): rows of `points`, polygon after polygon.
    counts : numpy.ndarray
        Shape (p,): number of corners per polygon.
    keep_corners : bool
        False drops corners as `mapbox_earcut` does, for models of the catalogue: their surfaces are pinned.

    Returns
    -------
    dict
        Triangles (t, 3) per index of a polygon that is cut: indices into the corners of the polygon, in the
        orientation of the polygon. Polygons that stay fans are no keys.

    Raises
    ------
    MeshError
        If a polygon to be cut has more than `MOST_CORNERS_CUT` corners.
    """
    triangles_of: dict[int, IntArray] = {}
    corner = 0
    for first in range(0, len(counts), _BLOCK_POLYGONS):
        block = counts[first : first + _BLOCK_POLYGONS]
        starts = corner + np.cumsum(block, dtype=np.int64) - block
        for index, triangles in _cuts_of_block(
            points, corners, block, starts, keep_corners=keep_corners
        ).items():
            triangles_of[first + index] = triangles
        corner += int(block.sum(dtype=np.int64))
    return triangles_of


def _cuts_of_block(
    points: NDArray[np.floating],
    corners: NDArray[np.integer],
    counts: NDArray[np.integer],
    starts: IntArray,
    *,
    keep_corners: bool,
) -> dict[int, IntArray]:
    """Return the result of `cuts` for a block of polygons whose corners begin at `starts` (p,)."""
    triangles_of: dict[int, IntArray] = {}
    for count in map(int, np.unique(counts[counts > 3])):
        same_count = np.flatnonzero(counts == count)
        blocks = -(-len(same_count) * count // _BLOCK_CORNERS)
        for indices in np.array_split(same_count, blocks):
            polygons = points[corners[starts[indices, None] + np.arange(count)]]
            cut = _cut_polygons(polygons.astype(np.float64, copy=False), keep_corners=keep_corners)
            triangles_of |= {int(indices[index]): triangles for index, triangles in cut.items()}
    return triangles_of


def triangulate(
    points: NDArray[np.floating], corners: NDArray[np.integer], counts: NDArray[np.integer]
) -> tuple[IntArray, NDArray[np.int32]]:
    """Cut polygons into triangles, polygon after polygon.

    Parameters
    ----------
    points, corners, counts : numpy.ndarray
        Polygons, as for `cuts`.

    Returns
    -------
    triangles : numpy.ndarray
        Shape (t, 3): indices into `corners`.
    pieces : numpy.ndarray
        Shape (p,), int32: number of triangles per polygon; 0 for fewer than three corners.
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
    """Return triangles (t, 3) of all polygons, as indices into their corners."""
    all_triangles = np.empty((pieces.sum(dtype=np.int64), 3), dtype=np.int64)
    cut_polygons = np.array(sorted(cut), dtype=np.int64)
    corner = triangle = 0
    # Blocks avoid several arrays as large as `all_triangles`.
    for first in range(0, len(counts), _BLOCK_POLYGONS):
        last = first + _BLOCK_POLYGONS
        in_block = cut_polygons[slice(*np.searchsorted(cut_polygons, [first, last]))].tolist()
        cut_in_block = {number - first: cut[number] for number in in_block}
        fans = _fans(counts[first:last], pieces[first:last], cut_in_block)
        np.add(fans, corner, out=all_triangles[triangle : triangle + len(fans)])
        triangle += len(fans)
        corner += int(counts[first:last].sum(dtype=np.int64))
    return all_triangles


def _fans(
    counts: NDArray[np.integer], pieces: NDArray[np.int32], cut: dict[int, IntArray]
) -> IntArray:
    """Return triangles (t, 3) as indices into the corners of polygons: those in `cut`, and fans of all other polygons."""
    owners = np.repeat(np.arange(len(counts)), pieces)
    starts = np.cumsum(counts, dtype=np.int64) - counts
    begins = np.cumsum(pieces, dtype=np.int64) - pieces
    first, second = starts[owners], np.arange(len(owners)) - begins[owners] + 1
    triangles = np.column_stack([first, first + second, first + second + 1])
    for polygon, pieces_of_polygon in cut.items():
        triangles[begins[polygon] : begins[polygon] + len(pieces_of_polygon)] = (
            starts[polygon] + pieces_of_polygon
        )
    return triangles


def triangulate_points(
    points: NDArray[np.floating], corners: NDArray[np.integer], counts: NDArray[np.integer]
) -> tuple[IntArray, NDArray[np.int32]]:
    """Cut polygons into triangles as rows of `points`.

    Takes the arguments of `triangulate`. Returns the triangles (t, 3), int64, and the number of triangles (p,) per
    polygon.
    """
    if (counts == 3).all():
        ones = np.broadcast_to(np.int32(1), len(counts))
        return corners.reshape(-1, 3).astype(np.int64, copy=False), ones
    triangles, pieces = triangulate(points, corners, counts)
    # Blocks avoid a second array as large as `triangles`.
    for start in range(0, len(triangles), _BLOCK_CORNERS):
        block = triangles[start : start + _BLOCK_CORNERS]
        block[:] = corners[block]
    return triangles, pieces


def index_runs(starts: IntArray, counts: IntArray, step: int = 1) -> IntArray:
    """Return concatenated runs of indices, shape (sum of `counts`,).

    Run i begins at `starts[i]` and has `counts[i]` indices with steps of `step`. Starts and counts have the shape
    (n,).
    """
    ends = np.cumsum(counts)
    firsts = np.repeat(starts - step * (ends - counts), counts)
    return firsts + step * np.arange(len(firsts))


def check_corners(corners: NDArray[np.integer], vertices: int, first: int = 0) -> None:
    """Check that corners, of any shape, are indices of vertices, which begin at `first`.

    Raises `MeshError` with the first wrong corner and the allowed range.
    """
    if not len(corners):
        return
    last = first + vertices - 1
    # Masks of all corners take memory, so they are made only for broken files.
    if corners.min() >= first and corners.max() <= last:
        return
    if not vertices:
        raise MeshError(f"a face names vertex {corners.flat[0]}, and no vertices are there")
    wrong = corners[(corners < first) | (corners > last)][0]
    raise MeshError(f"a face names vertex {wrong}; {first} to {last} are there")


def _cut_polygons(polygons: FloatArray, *, keep_corners: bool) -> dict[int, IntArray]:
    """Cut polygons (p, n, 3), in any unit, if their fan covers more than the polygon; return triangles per index."""
    # A polygon of a single point, or with NaN, becomes NaN, so all comparisons below are false.
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        units = np.abs(polygons).max(axis=(1, 2), keepdims=True)
        polygons = polygons / units - polygons[:, :1] / units
        crosses = np.cross(polygons[:, 1:-1], polygons[:, 2:])
        vectors = crosses.sum(axis=1)
        areas = np.linalg.norm(vectors, axis=1)
        normals = vectors / areas[:, None]
        covered = np.abs(np.einsum("ptk,pk->pt", crosses, normals)).sum(axis=1)
        not_convex = np.flatnonzero(covered - areas > _AREA_TOLERANCE * areas)
    if not len(not_convex):
        return {}
    triangles_of = {}
    for index, flat in zip(
        not_convex.tolist(), _projected(polygons[not_convex], normals[not_convex]), strict=True
    ):
        triangles = _ear_clipped(flat, keep_corners=keep_corners)
        if triangles is not None:
            triangles_of[index] = triangles
    return triangles_of


def _projected(polygons: FloatArray, normals: FloatArray) -> FloatArray:
    """Project polygons (p, n, 3) along the largest component of their normals (p, 3); keep their orientation: (p, n, 2)."""
    along = np.einsum("pnk,pk->pn", polygons, normals)
    flat = polygons - along[..., None] * normals[:, None]
    axes = np.abs(normals).argmax(axis=1)
    kept_axes = (axes[:, None] + [1, 2]) % 3
    backwards = np.take_along_axis(normals, axes[:, None], axis=1)[:, 0] < 0
    kept_axes[backwards] = kept_axes[backwards][:, ::-1]
    return np.ascontiguousarray(np.take_along_axis(flat, kept_axes[:, None], axis=2))


def _ear_clipped(flat: FloatArray, *, keep_corners: bool) -> IntArray | None:
    """Cut a counter-clockwise polygon (n, 2) into triangles (t, 3); None if the fan is at least as close to its area."""
    if len(flat) > MOST_CORNERS_CUT:
        raise MeshError(
            f"a polygon that is not convex has {len(flat)} corners; {MOST_CORNERS_CUT} are allowed: cut "
            "it into triangles when exporting"
        )
    corners = triangulate_float64(flat, np.array([len(flat)], dtype=np.uint32))
    triangles = corners.reshape(-1, 3).astype(np.int64)
    signed_areas = _signed_areas(flat, triangles)
    if keep_corners and len(triangles) < len(flat) - 2:
        # `mapbox_earcut` drops corners on a line between their neighbours, and where edges cross. In space there would be holes.
        if signed_areas.sum() < 0:
            triangles = triangles[:, ::-1]
        triangles = _with_all_corners(flat, triangles)
        if len(triangles) != len(flat) - 2:
            return None
        signed_areas = _signed_areas(flat, triangles)
    triangles[signed_areas < 0] = triangles[signed_areas < 0][:, ::-1]
    fan_areas = _cross(flat[1:-1], flat[2:])
    excess = np.abs(fan_areas).sum() - fan_areas.sum()
    return triangles if np.abs(np.abs(signed_areas).sum() - fan_areas.sum()) < excess else None


def _with_all_corners(flat: FloatArray, triangles: IntArray) -> IntArray:
    """Insert the corners and edges of a polygon (n, 2) that its triangles (t, 3) lack; return triangles (n - 2, 3)."""
    # The edges that are left over, of triangles and reversed of the polygon, form rings along which triangles and
    # polygon are apart. The triangle at the longest edge of a ring is cut at the other corners of the ring.
    apart: dict[int, list[int]] = {}
    for start, end in _unpaired(triangles, len(flat)):
        apart.setdefault(start, []).append(end)
    pieces = triangles.tolist()
    owners = {edge: index for index, piece in enumerate(pieces) for edge in _edges(piece)}
    for ring in _rings(apart):
        lengths = np.linalg.norm(flat[ring] - flat[ring[1:] + ring[:1]], axis=1)
        for place in np.argsort(-lengths, kind="stable").tolist():
            # From the start of the edge to its end, the other way round.
            path = (ring[place + 1 :] + ring[: place + 1])[::-1]
            owner = owners.get((path[0], path[-1]))
            if owner is None:
                continue
            (opposite,) = set(pieces[owner]) - {path[0], path[-1]}
            if opposite not in path:
                break
        else:
            # No triangle is beside the ring.
            opposite, path, owner = ring[0], ring[:0:-1], None
        cut = [[first, second, opposite] for first, second in pairwise(path)]
        if owner is not None:
            pieces[owner] = cut.pop()
            owners |= dict.fromkeys(_edges(pieces[owner]), owner)
        for piece in cut:
            owners |= dict.fromkeys(_edges(piece), len(pieces))
            pieces.append(piece)
    return np.array(pieces, dtype=np.int64).reshape(-1, 3)


def _edges(corners: list[int]) -> Iterator[tuple[int, int]]:
    return zip(corners, corners[1:] + corners[:1], strict=True)


def _unpaired(triangles: IntArray, count: int) -> Iterator[tuple[int, int]]:
    """Yield directed edges of triangles, and reversed edges of the polygon of `count` corners, without their opposite."""
    polygon = list(range(count))
    edges = Counter(edge for triangle in triangles.tolist() for edge in _edges(triangle))
    edges.update(_edges(polygon[::-1]))
    for (start, end), number in edges.items():
        yield from [(start, end)] * (number - edges.get((end, start), 0))


def _rings(following: dict[int, list[int]]) -> Iterator[list[int]]:
    """Yield rings of corners, each once in a ring, until all edges are used; every corner has as many edges in as out."""
    for start in list(following):
        path = [start]
        places = {start: 0}
        while following[path[-1]]:
            corner = following[path[-1]].pop()
            if corner in places:
                ring = path[places[corner] :]
                yield ring
                for passed in ring[1:]:
                    del places[passed]
                del path[places[corner] + 1 :]
            else:
                places[corner] = len(path)
                path.append(corner)


def _signed_areas(flat: FloatArray, triangles: IntArray) -> FloatArray:
    first, second, third = flat[triangles].transpose(1, 0, 2)
    return _cross(second - first, third - first)


def _cross(first: FloatArray, second: FloatArray) -> FloatArray:
    return first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]
