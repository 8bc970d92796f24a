"""Section `features` of `params.yaml`."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field


class FeatureParameters(BaseModel):
    """The contourlet transform of an imprint."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    descriptor: Literal["contourlet", "nonsubsampled_contourlet", "wavelet", "image_statistics"] = (
        Field(
            "contourlet",
            description="What describes an imprint: deviations of 16 contourlet bands, of 16 bands of a "
            "nonsubsampled contourlet, of 9 bands of a wavelet (db2, three levels), or 13 statistics of the imprint",
        )
    )
    pyramid_filter: Literal["9-7", "5-3", "haar"] = Field(
        "9-7", description="Filters of the Laplacian pyramid"
    )
    directional_filter: Literal["pkva6", "pkva8", "pkva12", "haar"] = Field(
        "pkva12", description="Ladder filter of the directional filter bank"
    )
    extension: Literal["periodic", "symmetric", "circular"] = Field(
        "periodic",
        description="How an imprint continues beyond its borders; the authors' toolbox has `periodic`",
    )
