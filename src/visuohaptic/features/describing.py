"""What is kept of a touch: its imprint's contourlet deviations and shape, its place and normal."""

from __future__ import annotations

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.errors import ParameterError
from visuohaptic.features.imprint_shape import describe_imprint_shape
from visuohaptic.features.parameters import FeatureParameters
from visuohaptic.tables.phases import (
    CONTOURLET_FEATURES,
    FEATURES,
    IMPRINT_FEATURES,
    KINESTHETIC_FEATURES,
)
from visuohaptic.tables.schema import build_table, images

_KEPT = (*FEATURES.keys, *KINESTHETIC_FEATURES, "sensor_size", "contact_state")


def describe_imprints(
    imprints: NDArray[np.float32], parameters: FeatureParameters
) -> NDArray[np.float64]:
    """Describe imprints: by default the deviation of each of 16 directional sub-bands.

    Parameters
    ----------
    imprints : numpy.ndarray
        Shape (n, r, r), float32, in [0, 1].
    parameters : FeatureParameters
        Descriptor, filters and extension.

    Returns
    -------
    numpy.ndarray
        Shape (n, k), float64, k at most 16; each row depends on its own imprint alone.

    Raises
    ------
    ParameterError
        If imprints of this resolution can't be divided into 16 bands.
    """
    from contourlets import Contourlet, LevelsError, band_deviations, wavelet_deviations

    if parameters.descriptor == "image_statistics":
        return describe_imprint_shape(imprints)
    if parameters.descriptor == "wavelet":
        return wavelet_deviations(imprints, "db2", parameters.wavelet_levels)
    if parameters.descriptor == "nonsubsampled_contourlet":
        return nonsubsampled_deviations(imprints)
    try:
        transform = Contourlet(
            parameters.levels,
            parameters.pyramid_filter,
            parameters.directional_filter,
            parameters.extension,
        )
        return band_deviations(imprints, transform)
    except LevelsError as error:
        if parameters.levels != (4,):
            raise ParameterError(f"sensor.resolution or features.levels: {error}") from None
        raise ParameterError(
            f"sensor.resolution is {imprints.shape[1]}; multiples of 8, and odd numbers from 3 on, "
            "are allowed, as a contourlet divides the imprint into 16 bands."
        ) from None


def nonsubsampled_deviations(imprints: NDArray[np.float32]) -> NDArray[np.float64]:
    """Give the deviations (N - 1) of a nonsubsampled contourlet's 16 bands: (n, r, r) to (n, 16)."""
    from contourlets import NonsubsampledContourlet

    bands = NonsubsampledContourlet(levels=(4,)).forward(imprints.astype(np.float64)).levels[0]
    return np.stack([band.std(axis=(1, 2), ddof=1) for band in bands], axis=1)


def describe_touches(touches: pa.Table, parameters: FeatureParameters) -> pa.Table:
    """Give the features of touches.

    Parameters
    ----------
    touches : pyarrow.Table
        Rows of `tables.TOUCHES`.
    parameters : FeatureParameters
        Section `features`.

    Returns
    -------
    pyarrow.Table
        Rows of `tables.FEATURES`, in the same order; each depends on its own touch alone. Where the
        descriptor has fewer than 16 numbers, the rest of the columns ``contourlet_…`` are 0.
    """
    if not touches.num_rows:
        return FEATURES.arrow.empty_table()
    imprints = images(touches)
    columns: dict[str, object] = {name: touches.column(name) for name in _KEPT}
    deviations = describe_imprints(imprints, parameters)
    padding = ((0, 0), (0, len(CONTOURLET_FEATURES) - deviations.shape[1]))
    columns |= dict(zip(CONTOURLET_FEATURES, np.pad(deviations, padding).T, strict=True))
    columns |= dict(zip(IMPRINT_FEATURES, describe_imprint_shape(imprints).T, strict=True))
    return build_table(FEATURES, columns)
