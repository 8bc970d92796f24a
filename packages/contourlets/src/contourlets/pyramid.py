"""The Laplacian pyramid of Burt and Adelson, as a frame with biorthogonal filters.

M. N. Do, M. Vetterli, "Framing pyramids", IEEE Trans. Signal Processing 51(9), 2003. One level is
c = ↓(h ∗ x), d = x − g ∗ ↑c; its inverse is the dual frame's, x = d + g ∗ ↑(c − ↓(h ∗ d)).

Arrays here are `(rows, columns, images)`.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from .filters import PyramidFilters
from .images import Array, FloatArray
from .lattice import Extension, Indices


def fold_indices(index: Indices, size: int, extension: Extension, *, odd: bool) -> Indices:
    """Map indices outside `0 … size − 1` into an axis: `symmetric` reflects, other extensions wrap.

    With `odd`, for filters of odd length, the reflection is about the first and the last sample. Otherwise
    it is about the points half a sample outside of them.
    """
    if extension != "symmetric":
        return index % size
    if not odd:
        folded = index % (2 * size)
        return np.minimum(folded, 2 * size - 1 - folded)
    if size == 1:
        return np.zeros_like(index)
    folded = index % (2 * size - 2)
    return np.minimum(folded, 2 * size - 2 - folded)


def analysis_offsets(length: int) -> Indices:
    """Return the offsets of the samples that taps 0, 1, … of a lowpass filter multiply."""
    return length // 2 - np.arange(length)


def synthesis_offsets(length: int) -> Indices:
    """Return the offsets of the upsampled samples; a filter of even length has a delay of one sample."""
    return length // 2 - np.arange(length) - (length + 1) % 2


@lru_cache(maxsize=256)
def _analysis_table(size: int, length: int, extension: Extension) -> Indices:
    offsets = analysis_offsets(length)
    return fold_indices(
        2 * np.arange(size // 2) + offsets[:, None], size, extension, odd=length % 2 == 1
    )


@lru_cache(maxsize=256)
def _synthesis_table(
    size: int, length: int, extension: Extension, parity: int
) -> tuple[Indices, tuple[int, ...]]:
    """Return coarse samples (taps, size / 2) for the fine samples of a parity, and their taps."""
    offsets = synthesis_offsets(length)
    taps = np.flatnonzero((parity + offsets) % 2 == 0)
    fine = 2 * np.arange(size // 2) + parity + offsets[taps, None]
    if length % 2 == 1:
        return fold_indices(fine, size, extension, odd=True) // 2, tuple(taps.tolist())
    return fold_indices(fine // 2, size // 2, extension, odd=False), tuple(taps.tolist())


def _weigh(x: FloatArray, table: Indices, taps: list[float], axis: int) -> FloatArray:
    """Return the sum of weighted samples of `x` along an axis; `table` has one row per tap."""
    total = x.take(table[0], axis=axis)
    total *= x.dtype.type(taps[0])
    for row, tap in zip(table[1:], taps[1:], strict=True):
        term = x.take(row, axis=axis)
        term *= x.dtype.type(tap)
        total += term
    return total


def _weigh_adjoint(
    y: FloatArray, table: Indices, taps: list[float], axis: int, size: int
) -> FloatArray:
    """Apply the adjoint of `_weigh`."""
    shape = list(y.shape)
    shape[axis] = size
    total = np.zeros(shape, y.dtype)
    head: tuple[Any, ...] = (slice(None),) * axis
    for row, tap in zip(table, taps, strict=True):
        np.add.at(total, (*head, row), y.dtype.type(tap) * y)
    return total


def _down(x: FloatArray, taps: Array, extension: Extension) -> FloatArray:
    for axis in (0, 1):
        table = _analysis_table(x.shape[axis], len(taps), extension)
        x = _weigh(x, table, taps.tolist(), axis)
    return x


def _up(c: FloatArray, taps: Array, extension: Extension) -> FloatArray:
    for axis in (0, 1):
        shape = list(c.shape)
        shape[axis] *= 2
        fine = np.zeros(shape, c.dtype)
        head: tuple[Any, ...] = (slice(None),) * axis
        for parity in (0, 1):
            table, chosen = _synthesis_table(shape[axis], len(taps), extension, parity)
            fine[(*head, slice(parity, None, 2))] = _weigh(
                c, table, taps[list(chosen)].tolist(), axis
            )
        c = fine
    return c


def _down_adjoint(c: FloatArray, taps: Array, extension: Extension) -> FloatArray:
    for axis in (1, 0):
        size = 2 * c.shape[axis]
        table = _analysis_table(size, len(taps), extension)
        c = _weigh_adjoint(c, table, taps.tolist(), axis, size)
    return c


def _up_adjoint(x: FloatArray, taps: Array, extension: Extension) -> FloatArray:
    for axis in (1, 0):
        head: tuple[Any, ...] = (slice(None),) * axis
        size = x.shape[axis]
        halves = []
        for parity in (0, 1):
            table, chosen = _synthesis_table(size, len(taps), extension, parity)
            part = x[(*head, slice(parity, None, 2))]
            halves.append(_weigh_adjoint(part, table, taps[list(chosen)].tolist(), axis, size // 2))
        x = halves[0] + halves[1]
    return x


def analyse_pyramid(
    x: FloatArray, filters: PyramidFilters, extension: Extension
) -> tuple[FloatArray, FloatArray]:
    """Split images (rows, columns, images) with even sides into a coarse and a detail image.

    The coarse image has half the rows and columns, the detail image has the size of the image.
    """
    coarse = _down(x, filters.analysis, extension)
    return coarse, x - _up(coarse, filters.synthesis, extension)


def synthesise_pyramid(
    coarse: FloatArray, detail: FloatArray, filters: PyramidFilters, extension: Extension
) -> FloatArray:
    """Invert `analyse_pyramid` with the dual frame; other coefficients are projected on its range."""
    remainder = coarse - _down(detail, filters.analysis, extension)
    return detail + _up(remainder, filters.synthesis, extension)


def adjoin_pyramid(
    coarse: FloatArray, detail: FloatArray, filters: PyramidFilters, extension: Extension
) -> FloatArray:
    """Apply the adjoint (the matrix transpose) of `analyse_pyramid`."""
    remainder = coarse - _up_adjoint(detail, filters.synthesis, extension)
    return detail + _down_adjoint(remainder, filters.analysis, extension)
