"""What is kept of a touch: its imprint's contourlet deviations and shape, its place and normal."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from contourlets import ContourletError
from visuohaptic.base.errors import ParameterError
from visuohaptic.features.descriptors import DESCRIPTORS
from visuohaptic.features.imprint_shape import describe_imprint_shape
from visuohaptic.features.parameters import BANDS, FeatureParameters
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
    """Describe imprints (n, r, r), float32, in [0, 1]: k numbers each, (n, k).

    By default these are the deviations of 16 directional sub-bands, the most that k may be; each
    row depends only on its own imprint. Raises `ParameterError` if imprints of this resolution
    can't be divided into 16 bands, or a descriptor gives other than a row for each.
    """
    entry = DESCRIPTORS[parameters.descriptor]
    try:
        found = entry.describe(imprints, parameters)
    except ContourletError as error:
        raise ParameterError(
            f"sensor.resolution is {imprints.shape[1]}, and descriptor {entry.name} refuses it with the "
            f"settings of `features`: {error}"
        ) from error
    if found.ndim != 2 or len(found) != len(imprints) or found.shape[1] > BANDS:
        raise ParameterError(
            f"descriptor {entry.name} gave an array of shape {found.shape} for {len(imprints)} imprints; "
            f"a row each, of at most {BANDS} numbers, is needed."
        )
    return found


def describe_touches(touches: pa.Table, parameters: FeatureParameters) -> pa.Table:
    """Turn rows of `tables.TOUCHES` into rows of `tables.FEATURES`, each only from its own touch.

    Where the descriptor has fewer than 16 numbers, the rest of the columns ``contourlet_…`` are 0.
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


class Described(NamedTuple):
    """The table of the third phase."""

    features: pa.Table


def describe(_: object, touches: pa.Table, features: FeatureParameters) -> Described:
    """Describe an object's touches, of whatever object."""
    return Described(describe_touches(touches, features))
