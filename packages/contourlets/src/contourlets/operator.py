"""The transform as one matrix, for small images of one size.

For images of 16 × 16 pixels, a product with a fixed matrix is about seven times as fast as the ladder;
for 32 × 32, both take about the same time. BLAS may choose another kernel for another number of rows,
which changes the last bits of a row. Products are therefore computed in blocks of `BLOCK_IMAGES` rows,
the last block filled up with zeros. So each image has the same result in any batch.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from .errors import LevelsError
from .images import FloatArray, check_images, exponents, scale
from .transform import Coefficients, Contourlet, gather

BLOCK_IMAGES = 32
"""Number of rows of every matrix product."""

MAX_MATRIX_BYTES = 1 << 25
"""Largest size of a matrix: 32 MiB, enough for 32 × 32 images at any levels."""

_ALIGNMENT = 64


@dataclass(frozen=True, eq=False)
class ContourletOperator:
    """A contourlet transform of one image size and type, written as a matrix.

    Attributes
    ----------
    transform : Contourlet
    image_shape : (int, int)
    matrix : (pixels, coefficients) float32 or float64
        Row vectors of pixels times `matrix` are `Coefficients.ravel()`; read-only.
    """

    transform: Contourlet
    image_shape: tuple[int, int]
    matrix: FloatArray

    def forward(self, images: ArrayLike) -> Coefficients:
        """Transform images (..., rows, columns) of the size of the operator, in its type.

        Equal to `Contourlet.forward` up to rounding. Raises `ImageError` and `LevelsError`.
        """
        array = check_images(images).astype(self.matrix.dtype, copy=False)
        if array.shape[-2:] != self.image_shape:
            raise LevelsError(
                f"This operator transforms images of {self.image_shape[0]} × {self.image_shape[1]} "
                f"pixels, not {array.shape[-2]} × {array.shape[-1]}."
            )
        lead = array.shape[:-2]
        flat = array.reshape(-1, self.matrix.shape[0])
        power = exponents(flat, (1,))
        values = scale(blockwise_product(scale(flat, -power), self.matrix), power)
        sizes = self.transform.band_shapes(self.image_shape)
        flat_sizes = [size for level in sizes for size in level]
        parts = np.split(values, np.cumsum([math.prod(size) for size in flat_sizes])[:-1], axis=1)
        bands = [part.reshape(*lead, *size) for part, size in zip(parts, flat_sizes, strict=True)]
        return gather(bands, sizes, self.image_shape)

    def adjoint(self, coefficients: Coefficients) -> FloatArray:
        """Apply the transposed matrix to coefficients; return images (..., rows, columns)."""
        values = coefficients.ravel()
        flat = values.reshape(-1, self.matrix.shape[1])
        back = blockwise_product(flat, np.ascontiguousarray(self.matrix.T))
        return back.reshape(*values.shape[:-1], *self.image_shape)


def blockwise_product(rows: FloatArray, matrix: FloatArray) -> FloatArray:
    """Multiply row vectors with a matrix; the result of a row depends only on this row, bit for bit."""
    outer = matrix.shape[1]
    width = -(-outer // _ALIGNMENT) * _ALIGNMENT
    if width != outer:
        matrix = np.pad(matrix, ((0, 0), (0, width - outer)))
    count = len(rows)
    rows = np.pad(rows, ((0, -count % BLOCK_IMAGES), (0, 0)))
    result = np.zeros((len(rows), width), matrix.dtype)
    for start in range(0, count, BLOCK_IMAGES):
        run = slice(start, start + BLOCK_IMAGES)
        np.matmul(rows[run], matrix, out=result[run])
    return result[:count, :outer]


@lru_cache(maxsize=8)
def _build(
    transform: Contourlet, image_shape: tuple[int, int], dtype: np.dtype[Any]
) -> ContourletOperator:
    pixels = image_shape[0] * image_shape[1]
    impulses = np.eye(pixels).reshape(pixels, *image_shape)
    matrix = transform.forward(impulses).ravel().astype(dtype)
    matrix.setflags(write=False)
    return ContourletOperator(transform, image_shape, matrix)


def contourlet_operator(
    transform: Contourlet, image_shape: tuple[int, int], dtype: DTypeLike = np.float64
) -> ContourletOperator:
    """Return the operator of a transform in float32 or float64; the last eight operators are cached.

    Raises `LevelsError` if the levels do not allow the size, or the matrix would exceed
    `MAX_MATRIX_BYTES`.
    """
    sizes = transform.band_shapes(image_shape)
    coefficients = sum(rows * columns for level in sizes for rows, columns in level)
    pixels = image_shape[0] * image_shape[1]
    if pixels * coefficients * np.dtype(dtype).itemsize > MAX_MATRIX_BYTES:
        raise LevelsError(
            f"The matrix for {image_shape[0]} × {image_shape[1]} images would exceed "
            f"{MAX_MATRIX_BYTES >> 20} MiB; use Contourlet.forward for images of this size."
        )
    return _build(transform, image_shape, np.dtype(dtype))
