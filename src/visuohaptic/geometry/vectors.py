"""Compute products of vectors with a fixed order of sums: the same bits on every processor and in every batch."""

from __future__ import annotations

import numpy as np

from visuohaptic.base.arrays import FloatArray


def dot(first: FloatArray, second: FloatArray) -> FloatArray:
    """Compute dot products of 3-vectors along the last axis: (..., 3) and (..., 3) to (...).

    A BLAS may order the sums by the size of the batch; this function does not.
    """
    return (
        first[..., 0] * second[..., 0]
        + first[..., 1] * second[..., 1]
        + first[..., 2] * second[..., 2]
    )


def dot_rows(first: FloatArray, second: FloatArray) -> FloatArray:
    """Compute the dot products (n,) of the columns of component rows, (3, n) or (3, 1) each.

    The first and the third product are added, then the second: the order of NumPy's `einsum` for vectors
    of three on x86-64. A sum of zeros is positive zero.
    """
    total = first[0] * second[0]
    total += first[2] * second[2]
    total += first[1] * second[1]
    total += 0.0
    return total


def cross(first: FloatArray, second: FloatArray) -> FloatArray:
    """Compute the cross products (..., 3) of vectors (..., 3) that broadcast, bit for bit those of `np.cross`."""
    # np.cross takes longer to check its axes than to multiply some hundred vectors.
    x, y, z = (first[..., axis] for axis in range(3))
    u, v, w = (second[..., axis] for axis in range(3))
    result = np.empty(np.broadcast_shapes(first.shape, second.shape))
    np.subtract(y * w, z * v, out=result[..., 0])
    np.subtract(z * u, x * w, out=result[..., 1])
    np.subtract(x * v, y * u, out=result[..., 2])
    return result


def product(first: FloatArray, second: FloatArray) -> FloatArray:
    """Compute the matrix product of (n, k) and (k, m) without a BLAS; for small k, such as points and frames."""
    result: FloatArray = np.einsum("nk,km->nm", first, second)
    return result
