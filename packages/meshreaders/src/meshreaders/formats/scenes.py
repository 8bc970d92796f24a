"""Functions for readers of scenes: transforms of parts, skins, triangle strips and fans."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from meshreaders.base.arrays import FloatArray, IntArray
from meshreaders.base.errors import MeshError
from meshreaders.parts import Paint, Part

_BLOCK_ROWS = 1 << 16


def placed(part: Part, matrices: FloatArray) -> Iterator[Part]:
    """Yield copies of a part, transformed by matrices (n, 4, 4), joined to one or two parts.

    Faces of mirrored copies are reversed, so that their normals still point outwards.
    """
    mirrored = np.linalg.det(matrices[:, :3, :3]) < 0
    if not mirrored.all():
        yield _repeated(part, matrices[~mirrored])
    if mirrored.any():
        reversed_part = replace(
            part,
            faces=part.faces[:, ::-1],
            paint=_with_corners(part.paint, lambda corners: corners[:, ::-1]),
        )
        yield _repeated(reversed_part, matrices[mirrored])


def skinned(
    vertices: FloatArray,
    rows: IntArray,
    joints: IntArray,
    weights: FloatArray,
    matrices: FloatArray,
) -> FloatArray:
    """Move vertices (v, 3) by the weighted mean of the matrices (j, 4, 4) of their joints.

    Vertex `rows[i]` follows joint `joints[i]` with `weights[i]`; all three have the shape (n,). Weights are divided by
    their sum per vertex. Vertices without weights stay unchanged. Raises `MeshError` with the reason if a vertex or
    joint does not exist.
    """
    for kind, numbers, allowed in (("vertex", rows, vertices), ("joint", joints, matrices)):
        wrong = numbers[(numbers < 0) | (numbers >= len(allowed))]
        if len(wrong):
            raise MeshError(f"its skin names {kind} {wrong[0]}; 0 to {len(allowed) - 1} are there")
    weighted = np.zeros_like(vertices)
    for start in range(0, len(rows), _BLOCK_ROWS):
        block = slice(start, start + _BLOCK_ROWS)
        joint_matrices, share = matrices[joints[block]], weights[block, None]
        points = np.einsum("nij,nj->ni", joint_matrices[:, :3, :3], vertices[rows[block]])
        points = share * (points + joint_matrices[:, :3, 3])
        for axis in range(3):
            weighted[:, axis] += np.bincount(rows[block], points[:, axis], len(vertices))
    sums = np.bincount(rows, weights, len(vertices))[:, None]
    return np.divide(weighted, sums, out=vertices.copy(), where=sums > 0)


def strip_faces(corners: IntArray) -> IntArray:
    """Return the triangles (n - 2, 3) of a strip of corners (n,), all with the same orientation."""
    faces = np.column_stack([corners[:-2], corners[1:-1], corners[2:]])
    faces[1::2] = faces[1::2, [1, 0, 2]]
    return faces


def fan_faces(corners: IntArray) -> IntArray:
    """Return the triangles (n - 2, 3) of a fan of corners (n,)."""
    return np.column_stack([np.full(len(corners[2:]), corners[0]), corners[1:-1], corners[2:]])


def _repeated(part: Part, matrices: FloatArray) -> Part:
    count = len(matrices)
    vertices = np.einsum("nij,vj->nvi", matrices[:, :3, :3], part.vertices)
    vertices += matrices[:, None, :3, 3]
    if count == 1:
        return replace(part, vertices=vertices[0])
    starts = len(part.vertices) * np.arange(count)
    return Part(
        vertices.reshape(-1, 3),
        (part.faces[None] + starts[:, None, None]).reshape(-1, 3),
        None if part.colours is None else np.tile(part.colours, (count, 1)),
        _with_corners(part.paint, lambda corners: np.tile(corners, (count, 1, 1))),
    )


def _with_corners(paint: Paint | None, change: Callable[[FloatArray], FloatArray]) -> Paint | None:
    return None if paint is None else replace(paint, corners=change(paint.corners))
