"""The nonsubsampled contourlet transform: shift-invariant, with every band at full size.

A. L. da Cunha, J. Zhou, M. N. Do, "The nonsubsampled contourlet transform: theory, design, and
applications", IEEE Trans. Image Processing 15(10), 2006. This implementation uses the filters of the
decimated transform. Every ladder step of `directional` is applied to all pixels instead of one coset.
The filters of the pyramid are dilated from level to level instead of halving the image.

With the zero-phase filter B of a ladder, its channels are y0 = (1 + B) x / 2 and
y1 = −(1 − B (1 + B) / 2) x, and x = (1 + B/2 − B²/2) y0 − (1 − B) y1 / 2. All of these are polynomials
of one linear map, so that the identity holds with any border extension.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .filters import ladder_steps, pyramid_filters
from .images import Array, FloatArray
from .lattice import Extension, Indices, in_order, ladder_geometry
from .pyramid import analysis_offsets, fold_indices, synthesis_offsets
from .transform import Parts, PyramidalTransform, Shapes

_WHOLE = np.eye(2, dtype=np.intp)
Spans = list[tuple[int, int]]
"""First index, and index after the last, of the rows and columns that an array covers."""


@dataclass(frozen=True)
class NonsubsampledContourlet(PyramidalTransform):
    """A nonsubsampled contourlet transform.

    Parameters
    ----------
    levels : tuple of int
        l of every pyramid level, the coarsest first; a level has 2^l bands, l from 0 to 5.
    pyramid_filter, directional_filter : str
        See `Contourlet`.
    extension : {"periodic", "symmetric", "circular"}
        `periodic` and `circular` are equal here: both commute with circular shifts. `symmetric` reflects.

    Notes
    -----
    Images may have any size and are not padded. Bands have the same order as in `Contourlet`. Multiplied by
    √2^l and sampled at the same pixels, they are the bands of the same detail image in the directional
    bank of `Contourlet` with circular extension.

    Examples
    --------
    >>> import numpy as np
    >>> transform = NonsubsampledContourlet(levels=(3,))
    >>> coefficients = transform.forward(np.random.default_rng(0).random((24, 31)))
    >>> len(coefficients.levels[0]), coefficients.levels[0][5].shape
    (8, (24, 31))
    """

    def padded_shape(self, shape: tuple[int, int]) -> tuple[int, int]:
        """Return rows and columns unchanged."""
        return shape

    def band_shapes(self, shape: tuple[int, int]) -> Shapes:
        """Return the shape of the image for the coarse image and for each band of every level."""
        return ((shape,), *((shape,) * 2**level for level in self.levels))

    def _analyse(self, block: FloatArray) -> list[FloatArray]:
        bands: list[FloatArray] = []
        for scale, level in enumerate(reversed(self.levels)):
            coarse = self._lower(block, scale)
            detail = block - self._raise(coarse, scale)
            bands = _second_half_reversed(self._split(detail, level)) + bands
            block = coarse
        return [block, *bands]

    def _synthesise(self, parts: Parts) -> FloatArray:
        block = parts[0][0]
        depth = len(self.levels)
        for index, bands in enumerate(parts[1:]):
            detail = self._join(_second_half_reversed(bands))
            block = detail + self._raise(block, depth - 1 - index)
        return block

    def _lower(self, x: FloatArray, scale: int) -> FloatArray:
        taps = pyramid_filters(self.pyramid_filter).analysis
        return self._separable(x, taps, analysis_offsets(len(taps)) << scale)

    def _raise(self, x: FloatArray, scale: int) -> FloatArray:
        taps = pyramid_filters(self.pyramid_filter).synthesis
        return self._separable(x, taps, synthesis_offsets(len(taps)) << scale)

    def _separable(self, x: FloatArray, taps: Array, offsets: Indices) -> FloatArray:
        """Filter along both axes, with gain 1 at frequency zero."""
        odd = len(taps) % 2 == 1
        for axis in (0, 1):
            size = x.shape[axis]
            positions = np.arange(size) + offsets[:, None]
            total = np.zeros_like(x)
            for tap, row in zip(taps / np.sqrt(2), positions, strict=True):
                indices = fold_indices(row, size, self.extension, odd=odd)
                total += x.dtype.type(tap) * x.take(indices, axis=axis)
            x = total
        return x

    def _split(
        self, x: FloatArray, level: int, depth: int = 1, number: int = 0, parent: Indices = _WHOLE
    ) -> list[FloatArray]:
        """Split a channel of the tree, given by depth and number, down to `level`."""
        if depth > level:
            return [x]
        ladder = self._ladder(parent, depth, number)
        parts = in_order(ladder.split(x), depth, number % 2, self.directional_filter)
        return [
            band
            for k, part in enumerate(parts)
            for band in self._split(part, level, depth + 1, 2 * number + k, ladder.matrix)
        ]

    def _join(
        self, bands: list[FloatArray], depth: int = 1, number: int = 0, parent: Indices = _WHOLE
    ) -> FloatArray:
        """Invert `_split`."""
        if len(bands) == 1:
            return bands[0]
        ladder, half = self._ladder(parent, depth, number), len(bands) // 2
        first, second = (
            self._join(some, depth + 1, 2 * number + k, ladder.matrix)
            for k, some in enumerate((bands[:half], bands[half:]))
        )
        return ladder.join(*in_order((first, second), depth, number % 2, self.directional_filter))

    def _ladder(self, parent: Indices, depth: int, number: int) -> _Ladder:
        haar = self.directional_filter == "haar"
        matrix, neighbour = ladder_geometry(parent, depth, number % 2, haar=haar)
        turned = depth > 2 and number >= 2 ** (depth - 2)
        return _Ladder(self.directional_filter, matrix, neighbour, turned, self.extension)


def _second_half_reversed(bands: list[FloatArray]) -> list[FloatArray]:
    half = (len(bands) + 1) // 2
    return bands[:half] + bands[half:][::-1]


@dataclass(frozen=True, eq=False)
class _Ladder:
    """A two-channel ladder on all pixels; `turned` exchanges rows and columns."""

    filter_name: str
    matrix: Indices
    neighbour: Indices
    turned: bool
    extension: Extension

    def split(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the first and the second channel."""
        half = x.dtype.type(0.5)
        if self.filter_name == "haar":
            difference = half * (self._filter(x, 1) - x)
            return x - self._filter(difference, 0), difference
        first = half * (x - self._filter(x, 0))
        return first, -x - self._filter(first, 1)

    def join(self, first: FloatArray, second: FloatArray) -> FloatArray:
        """Invert `split`."""
        if self.filter_name == "haar":
            return first + self._filter(second, 0)
        residue = -self._filter(first, 0) - second
        return first + residue.dtype.type(0.5) * (residue + self._filter(residue, 0))

    def _filter(self, x: FloatArray, target: int) -> FloatArray:
        """Apply the filter F of the ladder step that replaces `target`, 0 or 1."""
        if self.turned:
            return self._run(x.swapaxes(0, 1), target).swapaxes(0, 1)
        return self._run(x, target)

    def _run(self, x: FloatArray, target: int) -> FloatArray:
        step = next(s for s in ladder_steps(self.filter_name) if s.target == target)
        reach = step.after - np.arange(len(step.taps))
        shift = self.neighbour if target == 0 else -self.neighbour
        along_rows = shift[:, None] + self.matrix[:, :1] * reach
        along_columns = self.matrix[:, 1:] * reach
        whole = [(0, x.shape[0]), (0, x.shape[1])]
        inner = _reached(whole, along_rows)
        # If the first pass moves only along rows, the second pass extends the rows.
        first = inner if self.matrix[0, 1] else [whole[0], inner[1]]
        outer = _reached(first, along_columns)
        x = self._extend(self._extend(x, 1, outer[1]), 0, outer[0])
        y = _displaced_sum(x, step.taps, along_columns, outer, first)
        if first is not inner:
            y = self._extend(y, 0, inner[0])
        return _displaced_sum(y, step.taps, along_rows, inner, whole)

    def _extend(self, x: FloatArray, axis: int, span: tuple[int, int]) -> FloatArray:
        indices = fold_indices(np.arange(*span), x.shape[axis], self.extension, odd=True)
        return x.take(indices, axis=axis)


def _reached(spans: Spans, displacements: Indices) -> Spans:
    """Widen spans by all displacements, (2, taps)."""
    return [
        (low + int(along.min()), high + int(along.max()))
        for (low, high), along in zip(spans, displacements, strict=True)
    ]


def _displaced_sum(
    x: FloatArray, taps: tuple[float, ...], displacements: Indices, given: Spans, wanted: Spans
) -> FloatArray:
    """Sum displaced copies of `x`, which covers `given`, times taps; return the sum over `wanted`."""

    def copy(k: int) -> FloatArray:
        spans = (
            slice(w[0] - g[0] + int(d), w[1] - g[0] + int(d))
            for w, g, d in zip(wanted, given, displacements[:, k], strict=True)
        )
        return x[tuple(spans)]

    total = x.dtype.type(taps[0]) * copy(0)
    for k in range(1, len(taps)):
        total += x.dtype.type(taps[k]) * copy(k)
    return total
