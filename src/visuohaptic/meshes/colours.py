"""Colours as model files have them, as bytes of sRGB."""

from __future__ import annotations

from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import FloatArray, IntArray

_AT_ONCE = 1 << 14  # rows


def as_bytes(colours: NDArray[Any]) -> NDArray[np.uint8]:
    """Return colours (n, 3) as uint8, by the range that their largest number tells.

    Fractions of which none is above 1 are shares; numbers up to 255 stay; larger ones are of 16 bits.
    """
    if colours.dtype == np.uint8:
        return colours
    blocks = [slice(start, start + _AT_ONCE) for start in range(0, len(colours), _AT_ONCE)]
    largest = max((_as_float(colours[block]).max() for block in blocks), default=0.0)
    fractions = colours.dtype.kind == "f"
    scale = 255.0 if fractions and largest <= 1.0 else 1.0 if largest <= 255.0 else 255.0 / 65535.0
    found = np.empty(colours.shape, dtype=np.uint8)
    for block in blocks:
        found[block] = np.rint(np.clip(scale * _as_float(colours[block]), 0.0, 255.0))
    return found


def _as_float(colours: NDArray[Any]) -> FloatArray:
    return np.nan_to_num(colours.astype(np.float64), posinf=np.inf, neginf=0.0)


@overload
def mean_of_corners(colours: None, faces: IntArray) -> None: ...
@overload
def mean_of_corners(colours: NDArray[np.uint8], faces: IntArray) -> NDArray[np.uint8]: ...
def mean_of_corners(colours: NDArray[np.uint8] | None, faces: IntArray) -> NDArray[np.uint8] | None:
    """Compute colours (f, 3) of faces (f, 3) from those of vertices (v, 3); None stays None."""
    if colours is None:
        return None
    means = np.empty((len(faces), 3), dtype=np.uint8)
    for start in range(0, len(faces), _AT_ONCE):
        block = slice(start, start + _AT_ONCE)
        means[block] = np.rint(colours[faces[block]].mean(axis=1))
    return means
