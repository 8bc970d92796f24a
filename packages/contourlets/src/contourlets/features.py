"""Band features: one number per directional band of an image."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from .errors import LevelsError
from .images import Array, FloatArray, blocks, check_images, check_stack, exponents, scale
from .lattice import Extension
from .transform import Contourlet


def directional_deviations(
    images: ArrayLike,
    directions_log2: int = 4,
    pyramid_filter: str = "9-7",
    directional_filter: str = "pkva",
    extension: Extension = "periodic",
) -> Array:
    """Compute the standard deviation of every band of a one-level contourlet transform.

    Parameters
    ----------
    images : (n, rows, columns) float32 or float64
    directions_log2 : int
        l, for 2^l bands.
    pyramid_filter, directional_filter, extension
        See `Contourlet`.

    Returns
    -------
    (n, 2^l) float64
        In the unit of the images, with N − 1 in the denominator, as Matlab's `std`. The result of an
        image is the same, bit for bit, in every batch.

    Raises
    ------
    ContourletError
        If images, levels or filters are not allowed.
    """
    transform = Contourlet((directions_log2,), pyramid_filter, directional_filter, extension)
    return band_deviations(check_stack(images), transform)


def band_deviations(images: ArrayLike, transform: Contourlet) -> Array:
    """Compute the standard deviation (N − 1) of every directional band, the coarsest level first.

    `images` are (..., rows, columns), float32 or float64; the result is (..., bands), float64. Raises
    `ImageError`, and `LevelsError` if the levels do not allow the size or leave bands of one coefficient.
    """
    array = check_images(images)
    if min(_band_sizes(transform, array)) < 2:
        raise LevelsError(
            f"A standard deviation needs bands of two or more coefficients, and the levels "
            f"{transform.levels} leave one for images of {array.shape[-2]} × {array.shape[-1]}."
        )
    return _describe_bands(array, transform, lambda band: band.std(axis=1, ddof=1), degree=1)


def band_energies(images: ArrayLike, transform: Contourlet) -> Array:
    """Compute the sum of squared coefficients of every directional band, the coarsest level first.

    `images` are (..., rows, columns), float32 or float64; the result is (..., bands), float64, in the
    square of the unit of the images. Squares of magnitudes beyond 1e±150 overflow or underflow.
    """
    array = check_images(images)
    return _describe_bands(array, transform, lambda band: np.square(band).sum(axis=1), degree=2)


def band_names(transform: Contourlet) -> list[str]:
    """Return the names of all directional bands; `level1_band01` is the first band of the finest level."""
    depth = len(transform.levels)
    return [
        f"level{depth - k}_band{number:02d}"
        for k, level in enumerate(transform.levels)
        for number in range(1, 2**level + 1)
    ]


def _band_sizes(transform: Contourlet, images: FloatArray) -> list[int]:
    levels = transform.band_shapes((images.shape[-2], images.shape[-1]))[1:]
    return [rows * columns for level in levels for rows, columns in level]


def _describe_bands(
    images: FloatArray,
    transform: Contourlet,
    statistic: Callable[[FloatArray], FloatArray],
    *,
    degree: int,
) -> Array:
    """Compute `statistic` (n, coefficients) → (n,) of all bands; a factor a of a band changes it by a^degree."""
    stack = images.reshape(-1, *images.shape[-2:])
    result = np.zeros((len(stack), len(_band_sizes(transform, images))))
    for run in blocks(len(stack), images.shape[-2] * images.shape[-1]):
        block = stack[run].astype(np.float64, copy=False)
        power = exponents(block, (1, 2))
        levels = transform.forward(scale(block, -power)).levels
        bands = [band.reshape(len(block), -1) for level in levels for band in level]
        values = np.stack([statistic(band) for band in bands], axis=1)
        result[run] = scale(values, degree * power)
    return result.reshape(*images.shape[:-2], result.shape[1])
