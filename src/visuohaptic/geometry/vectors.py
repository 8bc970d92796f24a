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


def product(first: FloatArray, second: FloatArray) -> FloatArray:
    """Compute the matrix product of (n, k) and (k, m) without a BLAS; for small k, such as points and frames."""
    result: FloatArray = np.einsum("nk,km->nm", first, second)
    return result
