"""What is kept of a touch: 16 contourlet deviations of its imprint, its place and its normal."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from visuohaptic.tables import (
    CONTOURLET_FEATURES,
    FEATURES,
    KINESTHETIC_FEATURES,
    TOUCHES,
    build_table,
    images,
    read_table,
    write_table,
)


class FeatureParameters(BaseModel):
    """Section `features` of `params.yaml`."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    pyramid_filter: Literal["9-7", "5-3", "haar"] = Field(
        "9-7", description="filters of the Laplacian pyramid"
    )
    directional_filter: Literal["pkva6", "pkva8", "pkva12", "haar"] = Field(
        "pkva12", description="ladder filter of the directional filter bank"
    )
    extension: Literal["periodic", "symmetric"] = Field(
        "periodic", description="how an imprint goes on beyond its borders"
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
    """
    from visuohaptic.contourlet import directional_deviations

    return directional_deviations(
        imprints,
        directions_log2=4,
        pyramid_filter=parameters.pyramid_filter,
        directional_filter=parameters.directional_filter,
        extension=parameters.extension,
    )


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
    table = read_table(TOUCHES, touches)
    deviations = describe_imprints(images(table), parameters)
    columns = {name: table.column(name) for name in (*FEATURES.keys, *KINESTHETIC_FEATURES)}
    columns |= dict(zip(CONTOURLET_FEATURES, deviations.T, strict=True))
    write_table(FEATURES, build_table(FEATURES, columns), output)
