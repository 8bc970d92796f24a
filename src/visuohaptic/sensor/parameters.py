"""The virtual tactile sensor's own measures."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import Field, model_validator

from visuohaptic.base.section import Section

Normal = Literal["face", "given", "smoothed"]
Orientation = Literal["upright", "transported"]
Normalisation = Literal["per_imprint", "absolute"]


class SensorParameters(Section):
    """Measures of the sensor; the radius of an object's bounding sphere is 1."""

    resolution: int = Field(
        32, ge=2, le=256, description="Sensing points (taxels) along each edge of the square"
    )
    largest_size: float = Field(
        0.3, gt=0, le=2, description="Edge of the largest square, the palm (object radii)"
    )
    smallest_size: float = Field(
        0.02, gt=0, le=2, description="Edge of the smallest square, the fingertip (object radii)"
    )
    depth_range: float = Field(
        0.1,
        gt=0,
        le=2,
        description="How deep below its plane the sensor feels (object radii); 2 is no limit, as no two points of an object are farther apart",
    )
    normal: Normal = Field(
        "face",
        description="`face`: the touched triangle's own; `given`: as the probing location has it; `smoothed`: the mean normal of the surface under the largest square",
    )
    orientation: Orientation = Field(
        "upright",
        description="How the square is turned about the normal: `upright` keeps the columns horizontal, `transported` turns the frame of an upward normal the shortest way",
    )
    normalisation: Normalisation = Field(
        "per_imprint",
        description="`per_imprint` stretches each imprint to [0, 1] as the paper does; `absolute` keeps the depth range as the scale",
    )

    @model_validator(mode="after")
    def _sizes_agree(self) -> Self:
        if self.smallest_size > self.largest_size:
            raise ValueError(
                f"smallest_size is {self.smallest_size}; at most largest_size ({self.largest_size}) is allowed."
            )
        return self
