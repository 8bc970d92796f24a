"""What readers of scenes share: parts put in their places, joints of a skeleton, rotations, strips and fans."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import MeshError
from visuohaptic.meshes.parts import Paint, Part

_AT_ONCE = 1 << 16


def placed(part: Part, matrices: FloatArray) -> Iterator[Part]:
    """Return a part where each of the matrices (n, 4, 4) puts it.

    Matrices that mirror the part turn its faces over, so that their front stays in front.
    """
    mirrored = np.linalg.det(matrices[:, :3, :3]) < 0
    if not mirrored.all():
        yield _repeated(part, matrices[~mirrored])
    if mirrored.any():
        turned = replace(
            part,
            faces=part.faces[:, ::-1],
            paint=_with_corners(part.paint, lambda corners: corners[:, ::-1]),
        )
        yield _repeated(turned, matrices[mirrored])


def skinned(
    vertices: FloatArray,
    rows: IntArray,
    joints: IntArray,
    weights: FloatArray,
    matrices: FloatArray,
) -> FloatArray:
    """Move vertices (v, 3) by the weighted mean of the matrices (j, 4, 4) of their joints.

    `rows`, `joints` and `weights`, each of shape (n,), say by how much a vertex follows a joint;
    weights are divided by their sum per vertex. Vertices without weights stay where they are. Raises
    `MeshError`, with the reason only, if a vertex or joint is not there.
    """
    for what, numbers, there in (("vertex", rows, vertices), ("joint", joints, matrices)):
        wrong = numbers[(numbers < 0) | (numbers >= len(there))]
        if len(wrong):
            raise MeshError(f"its skin names {what} {wrong[0]}; 0 to {len(there) - 1} are there")
    moved = np.zeros_like(vertices)
    for start in range(0, len(rows), _AT_ONCE):
        block = slice(start, start + _AT_ONCE)
        of_joint, share = matrices[joints[block]], weights[block, None]
        points = np.einsum("nij,nj->ni", of_joint[:, :3, :3], vertices[rows[block]])
        points = share * (points + of_joint[:, :3, 3])
        for axis in range(3):
            moved[:, axis] += np.bincount(rows[block], points[:, axis], len(vertices))
    sums = np.bincount(rows, weights, len(vertices))[:, None]
    return np.divide(moved, sums, out=vertices.copy(), where=sums > 0)


def strip_faces(corners: IntArray) -> IntArray:
    """Return the triangles (n - 2, 3) of a strip of corners (n,), all wound alike."""
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
