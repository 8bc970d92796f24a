"""Faces that lie on each other, so that rounding decides which of them a ray meets first."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.geometry.surface import Surface
from visuohaptic.geometry.vectors import dot

# Planes are distinguished by their nearest points to this one, outside of surfaces of unit size: in general
# position, so that hardly a plane goes through it.
_VANTAGE = np.array([2.31, -2.77, 1.93])
# Cells of those points: far larger than rounding moves them, far smaller than between two parts of a surface.
_CELL = 0.01
# Makes one whole number of a cell's three; equal ones of different cells are only compared in vain.
_MIX = np.array([1.0, 4099.0, 4099.0**2])
# Faces that overlap by less, in the surface's unit, touch at an edge or a vertex.
_LEAST_OVERLAP = 1e-6
# Pairs of faces at a time, for the memory that they take.
_PAIRS = 1 << 18


def overlapping_faces(surface: Surface, distance: float) -> IntArray:
    """Find the pairs (p, 2), int64, of faces that lie on each other, each in both orders, sorted.

    The corners of one of the two must be within `distance` of the other's plane. Faces that meet in
    an edge or a vertex alone are none, nor are those that cross at an angle. The surface is near
    unit size, as prepared ones are.
    """
    cells = _nearest_to_vantage(surface) / _CELL
    whole = np.floor(cells)
    pairs = [np.zeros((0, 2), np.int64)]
    for first, second in _candidates(surface, whole):
        pairs.append(_lying_on_each_other(surface, first, second, distance))
    # Planes that a border between two cells parts are in one cell of a grid that lies between.
    for first, second in _candidates(surface, np.floor(cells + 0.5)):
        parted = (whole[first] != whole[second]).any(axis=1)
        pairs.append(_lying_on_each_other(surface, first[parted], second[parted], distance))
    found = np.concatenate(pairs)
    return np.unique(np.concatenate([found, found[:, ::-1]]), axis=0)


def _nearest_to_vantage(surface: Surface) -> FloatArray:
    """Give, seen from the vantage, the nearest point of each face's plane, shape (f, 3); either winding has the same."""
    normals = surface.face_normals
    heights = np.einsum("fd,fd->f", surface.triangles[:, 0] - _VANTAGE, normals)
    return heights[:, None] * normals


def _candidates(surface: Surface, cells: FloatArray) -> Iterator[tuple[IntArray, IntArray]]:
    """Give pairs of faces in equal cells whose extents overlap along an axis, some at a time."""
    solid = np.flatnonzero(surface.face_areas > 0)
    _, group, count = np.unique(
        (cells[solid] * _MIX).sum(axis=1), return_inverse=True, return_counts=True
    )
    shared = count[group] > 1
    faces, group = solid[shared], group[shared]
    if not len(faces):
        return
    _, heads, group = np.unique(group, return_index=True, return_inverse=True)
    # Along the axis to which the group's plane is most nearly parallel.
    axis = np.abs(surface.face_normals[faces[heads]]).argmin(axis=1)[group]
    along = np.take_along_axis(surface.triangles[faces], axis[:, None, None], axis=2)[..., 0]
    stride = 2.0 * np.ptp(along) + 1.0
    low, high = (group * stride + end for end in (along.min(axis=1), along.max(axis=1)))
    order = np.argsort(low, kind="stable")
    faces, low, high = faces[order], low[order], high[order]
    follow = np.searchsorted(low, high, side="right") - np.arange(len(low)) - 1
    for part in in_parts(np.arange(len(low)), follow, _PAIRS):
        first, second = paired(part, part + 1, follow[part])
        yield faces[first], faces[second]


def in_parts(rows: IntArray, counts: IntArray, most: int) -> list[IntArray]:
    """Divide rows wherever their counts, added up, pass a multiple of `most`."""
    ends = np.cumsum(counts, dtype=np.int64) // most
    return np.split(rows, np.flatnonzero(np.diff(ends)) + 1)


def paired(rows: IntArray, starts: IntArray, counts: IntArray) -> tuple[IntArray, IntArray]:
    """Give each row as often as it counts, beside whole numbers from its start on."""
    firsts = np.repeat(starts - np.cumsum(counts) + counts, counts)
    return np.repeat(rows, counts), firsts + np.arange(len(firsts))


def _lying_on_each_other(
    surface: Surface, first: IntArray, second: IntArray, distance: float
) -> IntArray:
    """Keep the pairs of faces that lie in one plane and overlap, shape (k, 2)."""
    near = _extents_meet(surface, first, second, distance)
    pairs = np.column_stack([first[near], second[near]])
    for edge in range(6):
        one, other = pairs.T if edge < 3 else pairs.T[::-1]
        pairs = pairs[_overlaps_along(surface, one, other, edge % 3) > _LEAST_OVERLAP]
    one, other = pairs.T
    apart = np.minimum(_heights(surface, one, other), _heights(surface, other, one))
    return pairs[apart <= distance]


def _extents_meet(
    surface: Surface, first: IntArray, second: IntArray, distance: float
) -> BoolArray:
    """Tell whether the boxes around two faces meet."""
    meet = np.ones(len(first), dtype=bool)
    for corners in np.moveaxis(surface.triangles, 2, 0):
        low = np.minimum(np.minimum(corners[:, 0], corners[:, 1]), corners[:, 2])
        high = np.maximum(np.maximum(corners[:, 0], corners[:, 1]), corners[:, 2]) + distance
        meet &= (low[first] <= high[second]) & (low[second] <= high[first])
    return meet


def _overlaps_along(surface: Surface, one: IntArray, other: IntArray, edge: int) -> FloatArray:
    """Give how far two triangles of a plane overlap across an edge of the first, shape (p,)."""
    # By the separating axis theorem they overlap if they do across each edge of both.
    start, end, across = (surface.triangles[one, (edge + step) % 3] for step in range(3))
    inwards = np.cross(surface.face_normals[one], end - start)
    inwards /= np.sqrt(dot(inwards, inwards))[:, None]
    height = dot(inwards, across - start)
    there = [dot(inwards, surface.triangles[other, corner] - start) for corner in range(3)]
    highest = np.maximum(np.maximum(there[0], there[1]), there[2])
    lowest = np.minimum(np.minimum(there[0], there[1]), there[2])
    return np.minimum(height, highest) - np.maximum(0.0, lowest)


def _heights(surface: Surface, one: IntArray, other: IntArray) -> FloatArray:
    """Give the largest distance of the first faces' corners from the planes of the others, shape (p,)."""
    origins, normals = surface.triangles[other, 0], surface.face_normals[other]
    heights = [
        np.abs(dot(surface.triangles[one, corner] - origins, normals)) for corner in range(3)
    ]
    return np.maximum(np.maximum(heights[0], heights[1]), heights[2])
