"""Find faces that lie on each other, so that rounding decides which of them a ray hits first."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.base.errors import MeshError
from visuohaptic.geometry.surface import Surface
from visuohaptic.geometry.vectors import dot

MOST_OVERLAPS = 2_000_000
"""Largest number of pairs of faces that lie on each other; a ray that hits a face meets all faces that lie on it."""

# Each plane is identified by its point nearest to this one. The vantage lies outside of surfaces of unit size, and in
# general position, so that hardly any plane contains it.
_VANTAGE = np.array([2.31, -2.77, 1.93])
# Size of the grid cells of nearest points: far larger than rounding, far smaller than distances between parts.
_CELL = 0.01
# Hashes the three indices of a cell to one number. Cells with equal hashes only cost needless comparisons.
_MIX = np.array([1.0, 4099.0, 4099.0**2])
# Faces that overlap by less, in units of the surface, only touch at an edge or a vertex.
_LEAST_OVERLAP = 1e-6
# Pairs of faces that are compared at once; limits the memory.
_PAIRS = 1 << 18


def overlapping_faces(surface: Surface, distance: float) -> IntArray:
    """Return the pairs of faces (p, 2), int64, that lie on each other; each pair in both orders, sorted.

    The corners of one face must be within `distance`, in units of the surface, of the plane of the other face. Faces
    that only touch at an edge or a vertex, or that cross at an angle, are no pairs. The surface must have about unit
    size, as prepared surfaces do. Raises `MeshError` if more than `MOST_OVERLAPS` pairs lie on each other.
    """
    pairs, count = [np.zeros((0, 2), np.int64)], 0
    for first, second in _all_candidates(surface):
        pairs.append(_lying_on_each_other(surface, first, second, distance))
        count += len(pairs[-1])
        if count > MOST_OVERLAPS:
            raise MeshError(
                f"The surface has more than {MOST_OVERLAPS:,} pairs of faces that lie on each other, out of "
                f"{len(surface.faces):,} faces; remove repeated faces."
            )
    one_order = np.concatenate(pairs)
    return np.unique(np.concatenate([one_order, one_order[:, ::-1]]), axis=0)


def _all_candidates(surface: Surface) -> Iterator[tuple[IntArray, IntArray]]:
    """Yield blocks of pairs of faces that are in equal cells of either grid, each pair once."""
    cells = _nearest_to_vantage(surface) / _CELL
    whole = np.floor(cells)
    yield from _candidates(surface, whole)
    # Nearest points on both sides of a cell border share a cell in a grid shifted by half a cell.
    for first, second in _candidates(surface, np.floor(cells + 0.5)):
        separate = (whole[first] != whole[second]).any(axis=1)
        yield first[separate], second[separate]


def _nearest_to_vantage(surface: Surface) -> FloatArray:
    """Compute the point of each face's plane nearest to the vantage, relative to it, (f, 3); the same for both windings."""
    normals = surface.face_normals
    heights = np.einsum("fd,fd->f", surface.triangles[:, 0] - _VANTAGE, normals)
    return heights[:, None] * normals


def _candidates(surface: Surface, cells: FloatArray) -> Iterator[tuple[IntArray, IntArray]]:
    """Yield blocks of pairs of faces that are in equal cells and overlap along one axis."""
    solid = np.flatnonzero(surface.face_areas > 0)
    _, group, count = np.unique(
        (cells[solid] * _MIX).sum(axis=1), return_inverse=True, return_counts=True
    )
    shared = count[group] > 1
    faces, group = solid[shared], group[shared]
    if not len(faces):
        return
    _, heads, group = np.unique(group, return_index=True, return_inverse=True)
    # Along an axis across the plane, the intervals of all faces of a group would overlap.
    axis = np.abs(surface.face_normals[faces[heads]]).argmin(axis=1)[group]
    along = np.take_along_axis(surface.triangles[faces], axis[:, None, None], axis=2)[..., 0]
    stride = 2.0 * np.ptp(along) + 1.0
    low, high = (group * stride + end for end in (along.min(axis=1), along.max(axis=1)))
    order = np.argsort(low, kind="stable")
    faces, low, high = faces[order], low[order], high[order]
    follow = np.searchsorted(low, high, side="right") - np.arange(len(low)) - 1
    for block in blocks_by_count(np.arange(len(low)), follow, _PAIRS):
        first, second = repeat_with_ranges(block, block + 1, follow[block])
        yield faces[first], faces[second]


def blocks_by_count(rows: IntArray, counts: IntArray, most: int) -> list[IntArray]:
    """Divide rows (n,) into consecutive blocks with counts (n,) of about `most` in sum.

    A block ends where the cumulative sum of the counts passes a multiple of `most`.
    """
    ends = np.cumsum(counts, dtype=np.int64) // most
    return np.split(rows, np.flatnonzero(np.diff(ends)) + 1)


def repeat_with_ranges(
    rows: IntArray, starts: IntArray, counts: IntArray
) -> tuple[IntArray, IntArray]:
    """Return each row `counts` times, paired with start, start + 1, … of that row.

    All arrays have the shape (n,); the two results have the shape (sum of `counts`,).
    """
    firsts = np.repeat(starts - np.cumsum(counts) + counts, counts)
    return np.repeat(rows, counts), firsts + np.arange(len(firsts))


def _lying_on_each_other(
    surface: Surface, first: IntArray, second: IntArray, distance: float
) -> IntArray:
    """Return the pairs of faces that overlap, one of them within `distance` of the plane of the other, (k, 2)."""
    near = _extents_meet(surface, first, second, distance)
    pairs = np.column_stack([first[near], second[near]])
    # By the separating axis theorem, two triangles of a plane overlap if they do so for each of their six edges.
    for edge in range(6):
        first, second = pairs.T if edge < 3 else pairs.T[::-1]
        pairs = pairs[_overlaps_along(surface, first, second, edge % 3) > _LEAST_OVERLAP]
    first, second = pairs.T
    heights = np.minimum(_heights(surface, first, second), _heights(surface, second, first))
    return pairs[heights <= distance]


def _extents_meet(
    surface: Surface, first: IntArray, second: IntArray, distance: float
) -> BoolArray:
    """Return whether the bounding boxes of two faces, enlarged by `distance`, overlap, (p,)."""
    meet = np.ones(len(first), dtype=bool)
    for corners in np.moveaxis(surface.triangles, 2, 0):
        low = np.minimum(np.minimum(corners[:, 0], corners[:, 1]), corners[:, 2])
        high = np.maximum(np.maximum(corners[:, 0], corners[:, 1]), corners[:, 2]) + distance
        meet &= (low[first] <= high[second]) & (low[second] <= high[first])
    return meet


def _overlaps_along(surface: Surface, first: IntArray, second: IntArray, edge: int) -> FloatArray:
    """Compute how far two triangles of a plane overlap perpendicular to an edge of the first, (p,)."""
    start, end, across = (surface.triangles[first, (edge + step) % 3] for step in range(3))
    inwards = np.cross(surface.face_normals[first], end - start)
    inwards /= np.sqrt(dot(inwards, inwards))[:, None]
    height = dot(inwards, across - start)
    heights = [dot(inwards, surface.triangles[second, corner] - start) for corner in range(3)]
    highest = np.maximum(np.maximum(heights[0], heights[1]), heights[2])
    lowest = np.minimum(np.minimum(heights[0], heights[1]), heights[2])
    return np.minimum(height, highest) - np.maximum(0.0, lowest)


def _heights(surface: Surface, first: IntArray, second: IntArray) -> FloatArray:
    """Compute the largest distance of the corners of the first face from the plane of the second, (p,)."""
    origins, normals = surface.triangles[second, 0], surface.face_normals[second]
    heights = [
        np.abs(dot(surface.triangles[first, corner] - origins, normals)) for corner in range(3)
    ]
    return np.maximum(np.maximum(heights[0], heights[1]), heights[2])
