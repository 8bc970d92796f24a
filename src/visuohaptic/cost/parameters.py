"""Section `cost` of `params.yaml`: what is tried when accuracy is weighed against time."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field


class CostParameters(BaseModel):
    """The settings that are tried beside the run's own, and how they are timed."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    touches: tuple[int, ...] = Field(
        (1, 2, 3, 4, 5, 6, 8, 10, 12, 16), min_length=1, description="touches from one viewpoint"
    )
    viewpoints: tuple[int, ...] = Field(
        (1, 2, 4, 8, 16), min_length=1, description="viewpoints that vote for an object"
    )
    imprint_resolutions: tuple[int, ...] = Field(
        (8, 16, 32, 64), min_length=1, description="sensing points along each edge of the sensor"
    )
    view_resolutions: tuple[int, ...] = Field(
        (64, 128, 256, 512), min_length=1, description="rows and columns of a view, pixels"
    )
    lean_view_resolution: int = Field(
        128, ge=16, description="rows and columns of a view of family lean_viewpoints, pixels"
    )
    objects: int = Field(4, ge=1, description="objects, spread over all, on which time is taken")
    rounds: int = Field(3, ge=1, description="times that each setting names each of them")
