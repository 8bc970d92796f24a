"""What is kept of a touch: its imprint's contourlet deviations and shape, its place and normal."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from visuohaptic.errors import ParameterError
from visuohaptic.imprint_shape import describe_imprint_shape
from visuohaptic.tables import (
    CONTOURLET_FEATURES,
    FEATURES,
    IMPRINT_FEATURES,
    KINESTHETIC_FEATURES,
    TOUCHES,
    build_table,
    images,
    read_table,
    write_table,
)

_KEPT = (*FEATURES.keys, *KINESTHETIC_FEATURES, "sensor_size", "contact_state")


class FeatureParameters(BaseModel):
    """Section `features` of `params.yaml`."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    pyramid_filter: Literal["9-7", "5-3", "haar"] = Field(
        "9-7", description="filters of the Laplacian pyramid"
    )
    directional_filter: Literal["pkva6", "pkva8", "pkva12", "haar"] = Field(
        "pkva12", description="ladder filter of the directional filter bank"
    )
    extension: Literal["periodic", "symmetric", "circular"] = Field(
        "periodic",
        description="how an imprint goes on beyond its borders; `periodic` as in the authors' toolbox",
    )


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


def make_features(
    touches: str | Path | Sequence[str | Path], output: str | Path, parameters: FeatureParameters
) -> None:
    """Make the feature table of a touch table.

    Parameters
    ----------
    touches : path or sequence of path
        Where the touches lie.
    output : path
        The Parquet file to write.
    parameters : FeatureParameters
        Section `features`.
    """
    table = describe_touches(read_table(TOUCHES, touches), parameters)
    write_table(FEATURES, table, output)
