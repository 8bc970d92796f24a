"""Products of vectors whose sums have one order, on every processor and whatever is in the batch."""

from __future__ import annotations

import numpy as np

from visuohaptic.base.arrays import FloatArray


def dot(first: FloatArray, second: FloatArray) -> FloatArray:
    """Give the dot products of vectors of three, along the last axis; a BLAS may order the sums by the batch."""
    return (
        first[..., 0] * second[..., 0]
        + first[..., 1] * second[..., 1]
        + first[..., 2] * second[..., 2]
    )


def product(first: FloatArray, second: FloatArray) -> FloatArray:
    """Give the product of matrices, (n, k) and (k, m): of points and frames, never of a size that needs a BLAS."""
    found: FloatArray = np.einsum("nk,km->nm", first, second)
    return found
