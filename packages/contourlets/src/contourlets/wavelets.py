"""Band features of a wavelet transform, for comparison."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .errors import FilterError, LevelsError
from .filters import pywavelets
from .images import Array, check_images, exponents, scale

_ORIENTATIONS = ("horizontal", "vertical", "diagonal")


def wavelet_deviations(
    images: ArrayLike, wavelet: str = "db2", levels: int = 3, mode: str = "periodization"
) -> Array:
    """Compute the standard deviation (N − 1) of every detail band of a 2-D wavelet transform.

    Parameters
    ----------
    images : (..., rows, columns) float32 or float64
    wavelet : str
        A discrete wavelet of PyWavelets, such as `db2` or `bior4.4`.
    levels : int
        Depth of the decomposition.
    mode : str
        Border extension of PyWavelets; only `periodization` has no redundancy.

    Returns
    -------
    (..., 3 × levels) float64
        The coarsest level first; per level, details of horizontal, vertical and diagonal structure.
    """
    array = check_images(images).astype(np.float64, copy=False)
    pywt = pywavelets()
    _check(pywt, wavelet, levels, mode)
    stack = array.reshape(-1, *array.shape[-2:])
    power = exponents(stack, (1, 2))
    details = pywt.wavedec2(scale(stack, -power), wavelet, mode, levels, axes=(1, 2))[1:]
    bands: list[Array] = [band for level in details for band in level]
    if min(band.shape[1] * band.shape[2] for band in bands) < 2:
        raise LevelsError(
            f"A standard deviation needs bands of two or more coefficients, and {levels} levels of "
            f"{wavelet} leave one for images of {array.shape[-2]} × {array.shape[-1]}."
        )
    deviations = np.stack([np.std(band, axis=(1, 2), ddof=1) for band in bands], axis=-1)
    return scale(deviations, power).reshape(*array.shape[:-2], -1)


def wavelet_band_names(levels: int = 3) -> list[str]:
    """Return the names of the bands of `wavelet_deviations`; `level1_horizontal` is of the finest level."""
    return [f"level{levels - k}_{name}" for k in range(levels) for name in _ORIENTATIONS]


def _check(pywt: Any, wavelet: Any, levels: Any, mode: Any) -> None:
    if wavelet not in pywt.wavelist(kind="discrete"):
        raise FilterError(
            f"No discrete wavelet is called {wavelet!r}; the names of PyWavelets are allowed, such as "
            "db2 and bior4.4."
        )
    if mode not in pywt.Modes.modes:
        raise FilterError(
            f"No wavelet mode is called {mode!r}; the names are {', '.join(pywt.Modes.modes)}."
        )
    if not isinstance(levels, (int, np.integer)) or levels < 1:
        raise LevelsError(f"Levels of a wavelet transform are an integer from 1, not {levels!r}.")
