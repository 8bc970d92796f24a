"""Compute descriptors of imprints that do not change when the sensor rolls about its normal.

The descriptors are exactly equal after a roll by a multiple of the angle between bands, or by a quarter turn. Other rolls
change them a little, because of the shape of the bands and the square imprint.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import RecognitionError
from visuohaptic.tables.phases import CONTOURLET_FEATURES

DIRECTIONS = len(CONTOURLET_FEATURES)

ROLL_FREE_IMPRINT = (
    "imprint_mean",
    "imprint_deviation",
    "imprint_skewness",
    "imprint_empty",
    "imprint_contact",
    "imprint_bending",
    "imprint_saddle",
    "imprint_roughness",
)
"""Statistics of the imprint that have no direction."""

DIRECTED_IMPRINT = (
    ("imprint_tilt_columns", "imprint_tilt_rows"),
    ("imprint_step_columns", "imprint_step_rows"),
)
"""Statistics along columns and along rows: the root of the sum of their squares has no direction."""


def roll_free_bands(bands: FloatArray) -> FloatArray:
    """Compute the magnitudes of the Fourier series over direction of 16 bands: (s, t, 16) to (s, t, 9).

    The bands cover half a turn. A roll of the sensor shifts them cyclically, which changes only the phases of the
    series. Without bands, (s, t, 0), the result is empty. Raises `RecognitionError` for other than 0 or 16 bands.
    """
    if not bands.shape[-1]:
        return bands
    check_directions(bands.shape[-1])
    return np.abs(np.fft.rfft(bands, axis=-1)) / DIRECTIONS


def check_directions(count: int) -> None:
    """Raise `RecognitionError` if the number of bands is not `DIRECTIONS`."""
    if count != DIRECTIONS:
        raise RecognitionError(
            f"recognition.frame none and centre need the {DIRECTIONS} directional bands "
            f"{CONTOURLET_FEATURES[0]} to {CONTOURLET_FEATURES[-1]}; the features have {count}."
        )


def roll_free_imprint(values: FloatArray, names: Sequence[str]) -> FloatArray:
    """Compute the statistics of imprints that do not change by a roll: (s, t, k) to (s, t, m).

    `names` are the names of the k columns. Columns that are neither in `ROLL_FREE_IMPRINT` nor part of a pair in
    `DIRECTED_IMPRINT` are left out.
    """
    index = {name: position for position, name in enumerate(names)}
    kept = [values[..., index[name]] for name in ROLL_FREE_IMPRINT if name in index]
    kept += [
        np.hypot(values[..., index[columns]], values[..., index[rows]])
        for columns, rows in DIRECTED_IMPRINT
        if columns in index and rows in index
    ]
    return np.stack(kept, axis=-1) if kept else values[..., :0]
