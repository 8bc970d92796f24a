"""The decimated contourlet transform of Do and Vetterli.

M. N. Do, M. Vetterli, "The contourlet transform: an efficient directional multiresolution image
representation", IEEE Trans. Image Processing 14(12), 2005.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from .directional import adjoin_directions, analyse_directions, synthesise_directions
from .errors import CoefficientsError, LevelsError
from .filters import ladder_steps, pyramid_filters
from .images import FloatArray, blocks, check_images, exponents, scale
from .lattice import (
    Extension,
    band_shapes,
    check_directions,
    check_extension,
    directional_tables,
    side_multiple,
)
from .pyramid import adjoin_pyramid, analyse_pyramid, synthesise_pyramid

Parts = list[list[FloatArray]]
Shapes = tuple[tuple[tuple[int, int], ...], ...]


@dataclass(frozen=True, eq=False)
class Coefficients:
    """Coefficients of a contourlet transform of images.

    Attributes
    ----------
    coarse : (..., rows, columns)
        Output of the last lowpass filter.
    levels : tuple of tuple of (..., rows, columns)
        Directional bands of every pyramid level, the coarsest level first, as in the toolbox.
    image_shape : (int, int)
        Rows and columns of the images, before any padding.
    """

    coarse: FloatArray
    levels: tuple[tuple[FloatArray, ...], ...]
    image_shape: tuple[int, int]

    @property
    def bands(self) -> tuple[FloatArray, ...]:
        """The coarse image and all bands, the coarsest level first."""
        return (self.coarse, *(band for level in self.levels for band in level))

    def ravel(self) -> FloatArray:
        """Return all coefficients of an image in one row: `(..., coefficients)`."""
        flat = [band.reshape(*band.shape[:-2], math.prod(band.shape[-2:])) for band in self.bands]
        return np.concatenate(flat, axis=-1)

    def map(self, function: Callable[[FloatArray], FloatArray]) -> Self:
        """Apply a function to every directional band; the coarse image is unchanged."""
        levels = tuple(tuple(function(band) for band in level) for level in self.levels)
        return type(self)(self.coarse, levels, self.image_shape)


@dataclass(frozen=True)
class PyramidalTransform(ABC):
    """Base class of the decimated and the nonsubsampled transform: parameters, batches, checks."""

    levels: tuple[int, ...] = (4,)
    pyramid_filter: str = "9-7"
    directional_filter: str = "pkva"
    extension: Extension = "periodic"

    def __post_init__(self) -> None:
        """Check every parameter."""
        if not isinstance(self.levels, tuple) or not self.levels:
            raise LevelsError(
                f"Levels must be a tuple of one or more integers, not {self.levels!r}."
            )
        for level in self.levels:
            check_directions(level)
        pyramid_filters(self.pyramid_filter)
        ladder_steps(self.directional_filter)
        check_extension(self.extension)

    @abstractmethod
    def padded_shape(self, shape: tuple[int, int]) -> tuple[int, int]:
        """Return rows and columns after padding; raise `LevelsError` if the levels do not allow the size."""

    @abstractmethod
    def band_shapes(self, shape: tuple[int, int]) -> Shapes:
        """Return the shapes of the coarse image and of the bands of every level, the coarsest first."""

    @abstractmethod
    def _analyse(self, block: FloatArray) -> list[FloatArray]:
        """Transform images (rows, columns, images); return the coarse image, then all bands."""

    @abstractmethod
    def _synthesise(self, parts: Parts) -> FloatArray:
        """Invert `_analyse`."""

    def forward(self, images: ArrayLike) -> Coefficients:
        """Transform images (..., rows, columns), float32 or float64, to coefficients of the same type.

        The coefficients of an image do not depend on the rest of the batch. Raises `ImageError` and
        `LevelsError`.
        """
        array = check_images(images)
        shape = (array.shape[-2], array.shape[-1])
        rows, columns = self.padded_shape(shape)
        sizes = self.band_shapes(shape)
        stack = array.reshape(-1, *shape)
        outputs = [np.zeros((len(stack), *s), array.dtype) for level in sizes for s in level]
        power = exponents(stack, (1, 2))
        grow = ((0, rows - shape[0]), (0, columns - shape[1]), (0, 0))
        for run in blocks(len(stack), rows * columns):
            block = np.moveaxis(scale(stack[run], -power[run]), 0, -1)
            block = np.pad(block, grow, mode="symmetric")
            for output, part in zip(outputs, self._analyse(block), strict=True):
                output[run] = scale(np.moveaxis(part, -1, 0), power[run])
        bands = [output.reshape(*array.shape[:-2], *output.shape[1:]) for output in outputs]
        return gather(bands, sizes, shape)

    def inverse(self, coefficients: Coefficients) -> FloatArray:
        """Reconstruct images (..., rows, columns) from their coefficients.

        Raises `CoefficientsError` if shapes or type differ from the result of `forward`.
        """
        rows, columns = coefficients.image_shape
        return self._backward(coefficients, self._synthesise)[..., :rows, :columns]

    def _backward(
        self, coefficients: Coefficients, rebuild: Callable[[Parts], FloatArray]
    ) -> FloatArray:
        sizes = self.band_shapes(coefficients.image_shape)
        _check_coefficients(coefficients, sizes)
        bands = [band.reshape(-1, *band.shape[-2:]) for band in coefficients.bands]
        rows, columns = self.padded_shape(coefficients.image_shape)
        images = np.zeros((len(bands[0]), rows, columns), bands[0].dtype)
        peaks = np.stack([np.abs(band).max(axis=(1, 2), initial=0.0) for band in bands], axis=1)
        power = exponents(peaks, (1,))
        for run in blocks(len(images), rows * columns):
            parts = [np.moveaxis(scale(band[run], -power[run]), 0, -1) for band in bands]
            images[run] = scale(np.moveaxis(rebuild(_nest(parts, sizes)), -1, 0), power[run])
        return images.reshape(*coefficients.coarse.shape[:-2], rows, columns)


def _nest(parts: list[FloatArray], sizes: Shapes) -> Parts:
    """Group a flat list of bands by pyramid level, the coarse image first."""
    remaining = iter(parts)
    return [[next(remaining) for _ in level] for level in sizes]


def gather(bands: list[FloatArray], sizes: Shapes, shape: tuple[int, int]) -> Coefficients:
    """Return a flat list of bands, the coarse image first, as coefficients of images of a shape."""
    (coarse,), *levels = _nest(bands, sizes)
    return Coefficients(coarse, tuple(map(tuple, levels)), shape)


def _check_coefficients(coefficients: Coefficients, sizes: Shapes) -> None:
    lead = coefficients.coarse.shape[:-2]
    needed = [(*lead, *size) for level in sizes for size in level]
    actual = [band.shape for band in coefficients.bands]
    if actual != needed:
        rows, columns = coefficients.image_shape
        raise CoefficientsError(
            f"Coefficients of images of {rows} × {columns} must have the shapes {needed}, not {actual}."
        )
    types = {band.dtype for band in coefficients.bands}
    if types not in ({np.dtype(np.float32)}, {np.dtype(np.float64)}):
        raise CoefficientsError(
            f"Coefficients must be all float32 or all float64, not {sorted(map(str, types))}."
        )


@dataclass(frozen=True)
class Contourlet(PyramidalTransform):
    """A contourlet transform: Laplacian pyramid, then a directional filter bank on every detail image.

    Parameters
    ----------
    levels : tuple of int
        l of every pyramid level, the coarsest first (`nlevs` of the toolbox); a level has 2^l bands, l from 0
        to 5. With l = 0, the detail image is not split, whereas `pdfbdec` of the toolbox has a critically
        sampled wavelet step.
    pyramid_filter : str
        `9-7`, `5-3`, `haar`, or any biorthogonal wavelet of PyWavelets.
    directional_filter : str
        `pkva` (12 taps), `pkva12`, `pkva8`, `pkva6` or `haar`.
    extension : {"periodic", "symmetric", "circular"}
        Extension of images beyond their borders. `periodic` has the numbers of the reference toolbox.
        `symmetric` reflects, so that opposite edges are not neighbours. `circular` wraps without the seams
        that the sheared arrays of the toolbox have from l = 3 on, so it commutes with circular shifts by the
        full decimation step.

    Notes
    -----
    Order and sizes of bands are as in the toolbox. Of 2^l bands, the first half has the shape
    `(rows / 2^(l−1), columns / 2)`, the second half `(rows / 2, columns / 2^(l−1))`. The direction turns
    steadily with the band number. A side must be even and, at every level, a multiple of 2^(l−1). An odd
    side is padded at its end, by half-sample reflection, to the next allowed side, and `inverse` crops it.

    Examples
    --------
    >>> import numpy as np
    >>> transform = Contourlet(levels=(4,))
    >>> coefficients = transform.forward(np.random.default_rng(0).random((32, 32)))
    >>> [band.shape for band in coefficients.levels[0]][7:9]
    [(4, 16), (16, 4)]
    """

    def padded_shape(self, shape: tuple[int, int]) -> tuple[int, int]:
        """Return rows and columns after padding of odd sides."""
        depth = len(self.levels)
        multiple = max(
            max(2, side_multiple(level)) << (depth - 1 - k) for k, level in enumerate(self.levels)
        )
        padded = tuple(-(-side // multiple) * multiple if side % 2 else side for side in shape)
        if min(shape) < 2 or any(side % multiple for side in padded):
            raise LevelsError(
                f"The levels {self.levels} need sides that are multiples of {multiple} (odd sides are "
                f"padded), not {shape[0]} × {shape[1]}."
            )
        return padded[0], padded[1]

    def band_shapes(self, shape: tuple[int, int]) -> Shapes:
        """Return the shapes of the coarse image and of the bands of every level, the coarsest first."""
        rows, columns = self.padded_shape(shape)
        depth = len(self.levels)
        coarse = ((rows >> depth, columns >> depth),)
        fine = (
            band_shapes((rows >> (depth - 1 - k), columns >> (depth - 1 - k)), level)
            for k, level in enumerate(self.levels)
        )
        return (coarse, *fine)

    def adjoint(self, coefficients: Coefficients) -> FloatArray:
        """Apply the transposed matrix of `forward`; raises `LevelsError` for images that are padded."""
        if self.padded_shape(coefficients.image_shape) != coefficients.image_shape:
            raise LevelsError(
                f"The adjoint needs images that are not padded; images of {coefficients.image_shape[0]} × "
                f"{coefficients.image_shape[1]} are padded."
            )
        return self._backward(coefficients, self._adjoin)

    def _analyse(self, block: FloatArray) -> list[FloatArray]:
        filters = pyramid_filters(self.pyramid_filter)
        bands: list[FloatArray] = []
        for level in reversed(self.levels):
            size = (block.shape[0], block.shape[1])
            block, detail = analyse_pyramid(block, filters, self.extension)
            tables = directional_tables(size, level, self.directional_filter, self.extension)
            bands = analyse_directions(detail.reshape(-1, detail.shape[-1]), tables) + bands
        return [block, *bands]

    def _synthesise(self, parts: Parts) -> FloatArray:
        return self._back(parts, synthesise_directions, synthesise_pyramid)

    def _adjoin(self, parts: Parts) -> FloatArray:
        return self._back(parts, adjoin_directions, adjoin_pyramid)

    def _back(
        self,
        parts: Parts,
        directions: Callable[..., FloatArray],
        pyramid: Callable[..., FloatArray],
    ) -> FloatArray:
        """Compute images from the coarsest level on, with the inverse or the adjoint of each step."""
        filters = pyramid_filters(self.pyramid_filter)
        block = parts[0][0]
        for level, bands in zip(self.levels, parts[1:], strict=True):
            size = (2 * block.shape[0], 2 * block.shape[1])
            tables = directional_tables(size, level, self.directional_filter, self.extension)
            detail = directions(bands, tables).reshape(*size, -1)
            block = pyramid(block, detail, filters, self.extension)
        return block
