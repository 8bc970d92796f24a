"""Vertices that follow the joints of a skeleton, and matrices of rotations by quaternions."""

from __future__ import annotations

import numpy as np

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import MeshError

_AT_ONCE = 1 << 16


def skinned(
    vertices: FloatArray, joints: IntArray, weights: FloatArray, matrices: FloatArray
) -> FloatArray:
    """Move vertices (v, 3) by the weighted mean of the matrices (j, 4, 4) of their joints.

    `joints` (v, k) are rows of `matrices`, and `weights` (v, k) their weights, which are divided by
    their sum per vertex. A vertex without weights follows its first joint. Raises `MeshError`, with the
    reason only, if a joint is not there.
    """
    if joints.size and (joints.min() < 0 or joints.max() >= len(matrices)):
        raise MeshError(
            f"a vertex follows joint {joints.max()}; 0 to {len(matrices) - 1} are there"
        )
    sums = weights.sum(axis=1, keepdims=True)
    first = np.eye(1, weights.shape[1])
    shares = np.divide(weights, sums, out=np.tile(first, (len(weights), 1)), where=sums > 0)
    moved = np.zeros_like(vertices)
    for start in range(0, len(vertices), _AT_ONCE):
        block = slice(start, start + _AT_ONCE)
        for joint, share in zip(joints[block].T, shares[block].T, strict=True):
            of_joint = matrices[joint]
            points = np.einsum("vij,vj->vi", of_joint[:, :3, :3], vertices[block])
            moved[block] += share[:, None] * (points + of_joint[:, :3, 3])
    return moved


def rotation_matrices(quaternions: FloatArray) -> FloatArray:
    """Compute the matrices (n, 3, 3) of quaternions (n, 4), x, y, z, w, of any length; of zero it is the unit matrix."""
    lengths = np.linalg.norm(quaternions, axis=1, keepdims=True)
    x, y, z, w = np.divide(
        quaternions, lengths, out=np.tile([0.0, 0, 0, 1], (len(quaternions), 1)), where=lengths > 0
    ).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), -1, 0)


def strip_faces(corners: IntArray) -> IntArray:
    """Return the triangles (n - 2, 3) of a strip of corners (n,), all wound alike."""
    faces = np.column_stack([corners[:-2], corners[1:-1], corners[2:]])
    faces[1::2] = faces[1::2, [1, 0, 2]]
    return faces


def fan_faces(corners: IntArray) -> IntArray:
    """Return the triangles (n - 2, 3) of a fan of corners (n,)."""
    return np.column_stack([np.full(len(corners) - 2, corners[0]), corners[1:-1], corners[2:]])
