"""Compute rotation matrices."""

from __future__ import annotations

import numpy as np

from meshreaders.base.arrays import FloatArray


def rotation_matrices(quaternions: FloatArray) -> FloatArray:
    """Compute rotation matrices (n, 3, 3) of quaternions (n, 4) in the order x, y, z, w, of any length.

    A quaternion of length 0 gives the identity.
    """
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
