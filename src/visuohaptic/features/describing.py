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
    """Give the standard deviation of each of the 16 directional sub-bands of each imprint.

    Parameters
    ----------
    imprints : numpy.ndarray
        Shape (n, r, r), float32, in [0, 1].
    parameters : FeatureParameters
        Filters and extension.

    Returns
    -------
    numpy.ndarray
        Shape (n, 16), float64; each row depends on its own imprint alone.

    Raises
    ------
    ParameterError
        If imprints of this resolution can't be divided into 16 bands.
    """
    from visuohaptic.contourlet import LevelsError, directional_deviations

    try:
        return directional_deviations(
            imprints,
            directions_log2=4,
            pyramid_filter=parameters.pyramid_filter,
            directional_filter=parameters.directional_filter,
            extension=parameters.extension,
        )
    except LevelsError:
        raise ParameterError(
            f"sensor.resolution is {imprints.shape[1]}; multiples of 8, and odd numbers from 3 on, "
            "are allowed, as a contourlet divides the imprint into 16 bands."
        ) from None


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
        Rows of `tables.FEATURES`, in the same order; each depends on its own touch alone.
    """
    imprints = images(touches)
    columns: dict[str, object] = {name: touches.column(name) for name in _KEPT}
    deviations = describe_imprints(imprints, parameters)
    columns |= dict(zip(CONTOURLET_FEATURES, deviations.T, strict=True))
    columns |= dict(zip(IMPRINT_FEATURES, describe_imprint_shape(imprints).T, strict=True))
    return build_table(FEATURES, columns)
