"""Band features: one number for every directional band of an image."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import ImageError, LevelsError
from .images import check_images, exponents, scale
from .lattice import Extension
from .operator import (
    BLOCK_IMAGES,
    contourlet_operator,
    fits_operator,
)
from .transform import Contourlet

Array = NDArray[np.float64]
Floats = NDArray[np.floating[Any]]


def directional_deviations(
    images: ArrayLike,
    directions_log2: int = 4,
    pyramid_filter: str = "9-7",
    directional_filter: str = "pkva",
    extension: Extension = "periodic",
) -> Array:
    """Take the standard deviation of every band of a one-level contourlet transform.

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
        In the images' unit; each with N − 1 in the denominator, as Matlab's `std`. An image's
        values do not depend on what else is in the batch, bit for bit.

    Raises
    ------
    ContourletError
        On images, levels or filters that are not allowed.
    """
    array = check_images(images)
    if array.ndim != 3:
        raise ImageError(f"Images must have the shape (n, rows, columns), not {array.shape}.")
    transform = Contourlet((directions_log2,), pyramid_filter, directional_filter, extension)
    return band_deviations(array, transform)


def band_deviations(images: ArrayLike, transform: Contourlet) -> Array:
    """Take the standard deviation (N − 1) of every directional band, the coarsest level first.

    Parameters
    ----------
    images : (..., rows, columns) float32 or float64
    transform : Contourlet

    Returns
    -------
    (..., bands) float64

    Raises
    ------
    ContourletError
    """
    array = check_images(images).astype(np.float64, copy=False)
    sizes = _sizes(transform, array)
    if min(sizes) < 2:
        raise LevelsError(
            f"A standard deviation needs bands of two or more coefficients, and the levels "
            f"{transform.levels} leave one for images of {array.shape[-2]} × {array.shape[-1]}."
        )
    stack = array.reshape(-1, *array.shape[-2:])
    power = exponents(stack, (1, 2))
    squares = _squares(scale(stack, -power), transform, centred=True)
    deviations = scale(np.sqrt(squares / (sizes - 1)), power)
    return deviations.reshape(*array.shape[:-2], len(sizes))


def band_energies(images: ArrayLike, transform: Contourlet) -> Array:
    """Sum the squared coefficients of every directional band, the coarsest level first.

    Parameters
    ----------
    images : (..., rows, columns) float32 or float64
    transform : Contourlet

    Returns
    -------
    (..., bands) float64
        In the square of the images' unit; magnitudes beyond 1e±150 leave the range of the type.

    Raises
    ------
    ContourletError
    """
    array = check_images(images).astype(np.float64, copy=False)
    stack = array.reshape(-1, *array.shape[-2:])
    power = exponents(stack, (1, 2))
    squares = _squares(scale(stack, -power), transform, centred=False)
    return scale(squares, 2 * power).reshape(*array.shape[:-2], squares.shape[1])


def band_names(transform: Contourlet) -> list[str]:
    """Name every directional band: `level1_band01` is the first band of the finest level."""
    depth = len(transform.levels)
    return [
        f"level{depth - k}_band{number:02d}"
        for k, level in enumerate(transform.levels)
        for number in range(1, 2**level + 1)
    ]


def _sizes(transform: Contourlet, images: Floats) -> Array:
    levels = transform.band_shapes((images.shape[-2], images.shape[-1]))[1:]
    return np.array([rows * columns for level in levels for rows, columns in level], np.float64)


def _squares(stack: Array, transform: Contourlet, *, centred: bool) -> Array:
    """Sum the squared coefficients of every band, about the band's mean or about zero."""
    shape = (stack.shape[1], stack.shape[2])
    if fits_operator(transform, shape, np.float64):
        return _kernel(transform, shape).squares(stack, centred=centred)
    levels = transform.forward(stack).levels
    bands = [band.reshape(len(stack), -1) for level in levels for band in level]
    return np.stack([_sum_of_squares(band, centred=centred) for band in bands], axis=-1)


def _sum_of_squares(values: Floats, *, centred: bool) -> Floats:
    if centred:
        values = values - values.mean(axis=-1, keepdims=True)
    return np.square(values).sum(axis=-1)


@dataclass(frozen=True, eq=False)
class _Kernel:
    """What gives the sums of squares of small images of one size, group of bands by group.

    Attributes
    ----------
    groups : tuple
    run : int
        Images in every product: few, so that short batches waste little, but more for a large matrix,
        which is read anew in every product.
    """

    groups: tuple[_Dense | _Circulant, ...]
    run: int

    def squares(self, stack: Array, *, centred: bool) -> Array:
        found = np.zeros((len(stack), sum(group.bands for group in self.groups)))
        for start in range(0, len(stack), self.run):
            block = stack[start : start + self.run]
            present = len(block)
            if present < self.run:
                empty = np.zeros((self.run - present, *stack.shape[1:]))
                block = np.concatenate([block, empty])
            parts = [group.squares(block, centred=centred) for group in self.groups]
            found[start : start + present] = np.concatenate(parts)[:, :present].T
        return found


@dataclass(frozen=True, eq=False)
class _Dense:
    """Bands of one shape as one product.

    Attributes
    ----------
    bands : int
    matrix : (bands × coefficients, pixels) float64
    """

    bands: int
    matrix: Array

    def squares(self, block: Array, *, centred: bool) -> Array:
        """Give `(bands, images)` of a block of images."""
        pixels = np.ascontiguousarray(block.reshape(len(block), -1).T)
        values = (self.matrix @ pixels).reshape(self.bands, -1, len(block))
        if centred:
            values -= values.mean(axis=1, keepdims=True)
        return np.square(values, out=values).sum(axis=1)


@dataclass(frozen=True, eq=False)
class _Circulant:
    """Bands that turn by one coefficient where the image turns by two pixels along an axis.

    In a real Fourier basis along that axis the product falls apart into one small product a
    frequency; sums of squares are the same in any orthonormal basis. With 16 bands of 32 × 32 pixels
    that is a seventh of the work.

    Attributes
    ----------
    bands : int
    axis : int
        0 where rows turn, 1 where columns do.
    basis : (n, n) float64
        Mean, highest frequency, then pairs of cosine and sine.
    single : (2, coefficients, pixels) float64
        Products of the first two.
    paired : (n / 2 − 1, 2 × coefficients, 2 × pixels) float64
        Products of the pairs.
    """

    bands: int
    axis: int
    basis: Array
    single: Array
    paired: Array

    def squares(self, block: Array, *, centred: bool) -> Array:
        """Give `(bands, images)` of a block of images."""
        pixels = np.ascontiguousarray(block.transpose((1, 2, 0) if self.axis == 0 else (2, 1, 0)))
        spectrum = self.basis @ pixels.reshape(len(self.basis), -1)
        cells, count = self.single.shape[2], len(block)
        single = self.single @ spectrum[:2].reshape(2, cells, count)
        single = single.reshape(2, self.bands, -1, count)
        paired = self.paired @ spectrum[2:].reshape(len(self.paired), 2 * cells, count)
        paired = paired.reshape(2 * len(self.paired), self.bands, -1, count)
        if centred:
            single[0] -= single[0].mean(axis=1, keepdims=True)
        return sum(np.square(part, out=part).sum(axis=(0, 2)) for part in (single, paired))


@lru_cache(maxsize=8)
def _kernel(transform: Contourlet, shape: tuple[int, int]) -> _Kernel:
    matrix = contourlet_operator(transform, shape).matrix
    sizes = transform.band_shapes(shape)
    start = sizes[0][0][0] * sizes[0][0][1]
    groups: list[_Dense | _Circulant] = []
    for level in sizes[1:]:
        for size in dict.fromkeys(level):
            bands = level.count(size)
            stop = start + bands * size[0] * size[1]
            groups.append(_group(matrix[:, start:stop].reshape(*shape, bands, *size)))
            start = stop
    dense = any(isinstance(group, _Dense) for group in groups)
    return _Kernel(tuple(groups), 4 * BLOCK_IMAGES if dense else BLOCK_IMAGES)


def _group(cells: Floats) -> _Dense | _Circulant:
    """Choose how to compute bands from `(rows, columns, bands, band rows, band columns)`."""
    for axis in (0, 1):
        turning = cells.shape[axis + 3]
        if 2 * turning == cells.shape[axis] and turning % 2 == 0 and turning > 2:
            found = _circulant(cells, axis)
            if found is not None:
                return found
    pixels, bands = cells.shape[0] * cells.shape[1], cells.shape[2]
    return _Dense(bands, np.ascontiguousarray(cells.reshape(pixels, -1).T))


def _circulant(cells: Floats, axis: int) -> _Circulant | None:
    """Take the matrix apart by frequency, or give None where frequencies mix."""
    # To (turns, other pixels, turns, bands × other coefficients).
    order = (0, 1, 3, 2, 4) if axis == 0 else (1, 0, 4, 2, 3)
    ordered = cells.transpose(order)
    turns, bands = ordered.shape[2], ordered.shape[3]
    ordered = ordered.reshape(turns, -1, turns, bands * ordered.shape[4])
    basis = _fourier_basis(turns)
    turned = np.einsum("fq,qpro,gr->fpgo", basis, ordered, basis, optimize=True)
    kept = np.zeros_like(turned)
    pairs = [slice(k, k + 2) for k in range(2, turns, 2)]
    for part in (slice(0, 1), slice(1, 2), *pairs):
        kept[part, :, part] = turned[part, :, part]
    if np.abs(turned - kept).max() > 1e-13 * np.abs(turned).max():
        return None
    single = np.stack([turned[k, :, k].T for k in (0, 1)])
    paired = np.stack([turned[part, :, part].reshape(2 * turned.shape[1], -1).T for part in pairs])
    return _Circulant(
        bands, axis, basis, np.ascontiguousarray(single), np.ascontiguousarray(paired)
    )


def _fourier_basis(size: int) -> Array:
    """Orthonormal rows: the mean, the highest frequency, then cosine and sine of each other one."""
    places = np.arange(size)
    rows = [np.full(size, np.sqrt(0.5)), np.sqrt(0.5) * (-1.0) ** places]
    for frequency in range(1, size // 2):
        angle = 2 * np.pi * (frequency * places % size) / size
        rows += [np.cos(angle), np.sin(angle)]
    return np.sqrt(2 / size) * np.stack(rows)
