"""Phase `features`: describe each touch by its imprint, location and normal."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from contourlets import ContourletError
from visuohaptic.base.arrays import masked_fault
from visuohaptic.base.errors import ParameterError
from visuohaptic.features.descriptors import DESCRIPTORS, any_layout_names
from visuohaptic.features.imprint_shape import describe_imprint_shape
from visuohaptic.features.parameters import BANDS, FeatureParameters
from visuohaptic.geometry.layouts import Layout
from visuohaptic.geometry.pads import Taxels, layout_of
from visuohaptic.tables.phases import (
    CONTOURLET_FEATURES,
    FEATURES,
    IMPRINT_FEATURES,
    KINESTHETIC_FEATURES,
)
from visuohaptic.tables.schema import build_table, images, readings

_COPIED_COLUMNS = (*FEATURES.keys, *KINESTHETIC_FEATURES, "sensor_size", "contact_state")


def describe_imprints(
    imprints: NDArray[np.float32], parameters: FeatureParameters, layout: Layout | None = None
) -> NDArray[np.float64]:
    """Describe imprints by the descriptor of the parameters.

    Parameters
    ----------
    imprints : ndarray of shape (n, r, r) or (n, taxels), float32
        Imprints, 0 to 1.
    parameters : FeatureParameters
        The descriptor and its settings.
    layout : Layout, optional
        The taxels. Imprints of shape (n, r, r) are those of the square.

    Returns
    -------
    ndarray of shape (n, k), float64
        One row per imprint, by default the standard deviations of 16 directional bands; k is at most 16. Each row
        depends only on its own imprint.

    Raises
    ------
    ParameterError
        If the descriptor needs a square grid and the layout is another, if it does not accept the resolution of the
        imprints, or returns another shape.
    """
    entry = DESCRIPTORS[parameters.descriptor]
    if fault := masked_fault(imprints):
        raise ParameterError(f"imprints has {fault}.")
    if imprints.ndim == 2 and not entry.any_layout:
        raise ParameterError(
            f"features.descriptor is {entry.name}, which needs a square grid, and sensor.layout has {imprints.shape[1]} taxels; "
            f"{' or '.join(any_layout_names())} works on any layout."
        )
    try:
        descriptions = (
            entry.describe(imprints, parameters, layout)
            if entry.any_layout
            else entry.describe(imprints, parameters)
        )
    except ContourletError as error:
        raise ParameterError(
            f"sensor.resolution is {imprints.shape[1]}, which descriptor {entry.name} refuses with the "
            f"settings of `features`: {error}"
        ) from error
    if fault := masked_fault(descriptions):
        raise ParameterError(f"descriptor {entry.name} returned numbers with {fault}.")
    shape = descriptions.shape
    if len(shape) != 2 or shape[0] != len(imprints) or shape[1] > BANDS:
        raise ParameterError(
            f"descriptor {entry.name} returned an array of shape {shape} for {len(imprints)} imprints; "
            f"one row per imprint with at most {BANDS} numbers is needed."
        )
    return descriptions


def describe_touches(
    touches: pa.Table, parameters: FeatureParameters, layout: str | Taxels = "square"
) -> pa.Table:
    """Describe touches, rows of `tables.TOUCHES`: return one row of `tables.FEATURES` per touch.

    `layout` is parameter `sensor.layout`. Each row depends only on its own touch. If the descriptor has fewer than 16 numbers, the remaining columns
    ``contourlet_…`` are 0.
    """
    if not touches.num_rows:
        return FEATURES.arrow.empty_table()
    if layout == "square":
        imprints, taxels = images(touches), None
    else:
        imprints, taxels = readings(touches), layout_of(layout, 2)
    columns: dict[str, object] = {name: touches.column(name) for name in _COPIED_COLUMNS}
    descriptions = describe_imprints(imprints, parameters, taxels)
    padding = ((0, 0), (0, len(CONTOURLET_FEATURES) - descriptions.shape[1]))
    columns |= dict(zip(CONTOURLET_FEATURES, np.pad(descriptions, padding).T, strict=True))
    columns |= dict(zip(IMPRINT_FEATURES, describe_imprint_shape(imprints, taxels).T, strict=True))
    return build_table(FEATURES, columns)


class Described(NamedTuple):
    """The table of phase `features`."""

    features: pa.Table


def describe(
    _: object, touches: pa.Table, features: FeatureParameters, layout: str | Taxels
) -> Described:
    """Run phase `features` on an object's touches; the object itself is not used."""
    return Described(describe_touches(touches, features, layout))
