"""The functions of `descriptors`: imprints (n, r, r), float32, in [0, 1], to numbers (n, k), float64."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import contourlets
from contourlets import (
    Contourlet,
    LevelsError,
    NonsubsampledContourlet,
    band_deviations,
)
from visuohaptic.base.errors import ParameterError
from visuohaptic.features.imprint_shape import describe_imprint_shape


def contourlet_deviations(imprints: NDArray[np.float32], parameters: Any) -> NDArray[np.float64]:
    """Return the deviations (N - 1) of a contourlet's bands, shape (n, bands)."""
    try:
        transform = Contourlet(
            parameters.levels,
            parameters.pyramid_filter,
            parameters.directional_filter,
            parameters.extension,
        )
        return band_deviations(imprints, transform)
    except LevelsError:
        if parameters.levels != (4,):
            raise
        raise ParameterError(
            f"sensor.resolution is {imprints.shape[1]}; multiples of 8, and odd numbers from 3 on, "
            "are allowed, as a contourlet divides the imprint into 16 bands."
        ) from None


def nonsubsampled_deviations(imprints: NDArray[np.float32], _: object) -> NDArray[np.float64]:
    """Return the deviations (N - 1) of a nonsubsampled contourlet's 16 bands, shape (n, 16)."""
    bands = NonsubsampledContourlet(levels=(4,)).forward(imprints.astype(np.float64)).levels[0]
    return np.stack([band.std(axis=(1, 2), ddof=1) for band in bands], axis=1)


def wavelet_deviations(imprints: NDArray[np.float32], parameters: Any) -> NDArray[np.float64]:
    """Return the deviations of the bands of wavelet db2, shape (n, 3 * levels)."""
    return contourlets.wavelet_deviations(imprints, "db2", parameters.wavelet_levels)


def image_statistics(imprints: NDArray[np.float32], _: object) -> NDArray[np.float64]:
    """Return 13 statistics of each imprint, shape (n, 13)."""
    return describe_imprint_shape(imprints)
