"""Convert colours of model files to sRGB, uint8."""

from __future__ import annotations

from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from meshreaders.base.arrays import FloatArray, IntArray

_BLOCK_ROWS = 1 << 14


def as_bytes(colours: NDArray[Any]) -> NDArray[np.uint8]:
    """Return colours (n, 3) as uint8; the largest number decides their range.

    Floating-point numbers up to 1 are fractions of full brightness. Other numbers up to 255 are bytes, and larger
    numbers have 16 bits.
    """
    if colours.dtype == np.uint8:
        return colours
    blocks = [slice(start, start + _BLOCK_ROWS) for start in range(0, len(colours), _BLOCK_ROWS)]
    largest = max((_as_float(colours[block]).max() for block in blocks), default=0.0)
    fractions = colours.dtype.kind == "f"
    scale = 255.0 if fractions and largest <= 1.0 else 1.0 if largest <= 255.0 else 255.0 / 65535.0
    as_uint8 = np.empty(colours.shape, dtype=np.uint8)
    for block in blocks:
        as_uint8[block] = np.rint(np.clip(scale * _as_float(colours[block]), 0.0, 255.0))
    return as_uint8


def _as_float(colours: NDArray[Any]) -> FloatArray:
    return np.nan_to_num(colours.astype(np.float64), posinf=np.inf, neginf=0.0)


@overload
def mean_of_corners(colours: None, faces: IntArray) -> None: ...
@overload
def mean_of_corners(colours: NDArray[np.uint8], faces: IntArray) -> NDArray[np.uint8]: ...
def mean_of_corners(colours: NDArray[np.uint8] | None, faces: IntArray) -> NDArray[np.uint8] | None:
    """Compute the mean colour (f, 3) of the corners of faces (f, 3) from colours of vertices (v, 3); None stays None."""
    if colours is None:
        return None
    means = np.empty((len(faces), 3), dtype=np.uint8)
    for start in range(0, len(faces), _BLOCK_ROWS):
        block = slice(start, start + _BLOCK_ROWS)
        means[block] = np.rint(colours[faces[block]].mean(axis=1))
    return means
