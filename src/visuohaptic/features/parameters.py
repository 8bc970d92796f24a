"""Section `features` of `params.yaml`."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field


class FeatureParameters(BaseModel):
    """Section `features` of `params.yaml`."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    descriptor: Literal["contourlet", "nonsubsampled_contourlet", "wavelet", "image_statistics"] = (
        Field(
            "contourlet",
            description="what describes an imprint: deviations of 16 contourlet bands, of 16 bands of a "
            "nonsubsampled contourlet, of 9 bands of a wavelet (db2, three levels), or 13 statistics of the imprint",
        )
    )
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
