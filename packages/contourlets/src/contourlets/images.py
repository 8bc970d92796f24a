"""Checks of images, blocks of a batch, and scaling by powers of two."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import ImageError

Array = NDArray[np.float64]
FloatArray = NDArray[np.floating[Any]]
_Real = TypeVar("_Real", bound=np.floating[Any])

BLOCK_ELEMENTS = 1 << 18
"""Largest number of pixels per block of images (a few MB); a larger image has its own block."""


def check_images(images: ArrayLike) -> FloatArray:
    """Return images as a float32 or float64 array.

    Raises `ImageError` for any other type, less than 2 × 2 pixels, values that are not finite, or masked values.
    """
    parts = images if isinstance(images, list | tuple) else (images,)
    if any(np.ma.is_masked(part) for part in parts if isinstance(part, np.ma.MaskedArray)):
        raise ImageError("Images have masked pixels; fill them first, because masks are not read.")
    array = np.asarray(images)
    if array.dtype not in (np.float32, np.float64):
        raise ImageError(f"Images must be real float32 or float64 arrays, not {array.dtype}.")
    if array.ndim < 2 or min(array.shape[-2:]) < 2:
        raise ImageError(
            f"Images must have the shape (..., rows, columns) with at least 2 rows and 2 columns, not "
            f"{array.shape}."
        )
    if not np.isfinite([array.max(initial=0.0), array.min(initial=0.0)]).all():
        raise ImageError("Images must be finite, but there are NaN or infinite pixels.")
    return array


def check_stack(images: ArrayLike) -> FloatArray:
    """Return images of shape (n, rows, columns); raises `ImageError` as `check_images` does."""
    array = check_images(images)
    if array.ndim != 3:
        raise ImageError(f"Images must have the shape (n, rows, columns), not {array.shape}.")
    return array


def blocks(count: int, pixels: int) -> Iterator[slice]:
    """Yield slices of a batch of images, of at most `BLOCK_ELEMENTS` pixels each."""
    run = max(1, BLOCK_ELEMENTS // max(pixels, 1))
    for start in range(0, count, run):
        yield slice(start, min(start + run, count))


def exponents(images: FloatArray, axes: tuple[int, ...]) -> NDArray[np.intc]:
    """Return the exponent e per image, so that arithmetic on images / 2^e keeps the range of the type.

    e is 0 if the largest magnitude is in the middle of the range, where scaling by a power of two changes
    no digit of a result. Near the ends of the range, images / 2^e have the largest magnitude in [½, 1):
    sums do not overflow, and denormal numbers keep their digits. `axes` are the axes of one image.
    """
    limits = np.finfo(images.dtype)
    high, low = images.max(axis=axes, initial=0.0), images.min(axis=axes, initial=0.0)
    exponent = np.frexp(np.maximum(high, -low))[1]
    # Magnitudes within a quarter of the range have sums of squares within half of the range.
    comfortable = (exponent > limits.minexp // 4) & (exponent < limits.maxexp // 4)
    return np.where(comfortable, 0, exponent).astype(np.intc)


def scale(images: NDArray[_Real], powers: NDArray[np.intc]) -> NDArray[_Real]:
    """Multiply each image by 2 to its power."""
    if not powers.any():
        return images
    return np.ldexp(images, powers.reshape(-1, *(1,) * (images.ndim - 1)))
