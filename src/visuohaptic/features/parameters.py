"""Section `features` of `params.yaml`."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, field_validator

from visuohaptic.base.section import Section
from visuohaptic.features.descriptors import DESCRIPTORS

BANDS = 16
"""Number of columns ``contourlet_…`` in a table of features."""


class FeatureParameters(Section):
    """The contourlet transform of an imprint."""

    descriptor: Annotated[str, DESCRIPTORS] = Field(
        "contourlet",
        description="Description of an imprint: standard deviations of 16 contourlet bands, of 16 bands of a "
        "nonsubsampled contourlet, or of wavelet bands (db2, three per level), or 13 statistics of the imprint",
    )
    wavelet_levels: int = Field(
        3, ge=1, le=3, description="Levels of the wavelet, for `wavelet` only"
    )
    levels: tuple[Annotated[int, Field(ge=0, le=4)], ...] = Field(
        (4,),
        min_length=1,
        description="Directions of each pyramid level as exponents of 2, the coarsest level first, such as 2, 2, 3; "
        "together at most 16 bands; for `contourlet` only",
    )
    pyramid_filter: Literal["9-7", "5-3", "haar"] = Field(
        "9-7", description="Filters of the Laplacian pyramid"
    )
    directional_filter: Literal["pkva6", "pkva8", "pkva12", "haar"] = Field(
        "pkva12", description="Ladder filter of the directional filter bank"
    )
    extension: Literal["periodic", "symmetric", "circular"] = Field(
        "periodic",
        description="Extension of an imprint beyond its borders; the authors' toolbox has `periodic`",
    )

    @field_validator("levels")
    @classmethod
    def _check_bands(cls, levels: tuple[int, ...]) -> tuple[int, ...]:
        bands = sum(2**level for level in levels)
        if bands > BANDS:
            raise ValueError(f"levels give {bands} bands; at most {BANDS} are allowed")
        return levels
