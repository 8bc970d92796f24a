"""Section `sensor` of `params.yaml`."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import Field, field_validator, model_validator

from visuohaptic.base.errors import ParameterError
from visuohaptic.base.section import Section
from visuohaptic.geometry.layouts import Layout
from visuohaptic.geometry.pads import Taxels, layout_of

Normal = Literal["face", "given", "smoothed"]
Orientation = Literal["upright", "transported"]
Normalisation = Literal["per_imprint", "absolute"]

MOST_TAXELS = 4096
"""Limit of taxels in a layout of the experiment. Records hold all taxels."""


class SensorParameters(Section):
    """Size, resolution and orientation of the sensor; the radius of an object's bounding sphere is 1."""

    layout: str | Taxels = Field(
        "square",
        description="Layout of the taxels: `square` (a grid of `resolution`), `round`, `dome`, `finger`, `gripper`, or a CSV file with the columns x, y, z, direction_x, direction_y, direction_z",
    )
    resolution: int = Field(
        32,
        ge=2,
        le=256,
        description="Sensing points (taxels) along each edge of the square; for layout `square` only",
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
        description="Largest gap below the sensor's plane that it measures (object radii); 2, the diameter of an object, is no limit",
    )
    normal: Normal = Field(
        "face",
        description="Normal of the sensor: of the touched triangle (`face`), of the probing location (`given`), or the mean over the surface under the largest square (`smoothed`)",
    )
    orientation: Orientation = Field(
        "upright",
        description="Rotation of the square about the normal: `upright` keeps columns horizontal, `transported` rotates the frame of an upward normal the shortest way",
    )
    normalisation: Normalisation = Field(
        "per_imprint",
        description="Scale of imprints: `per_imprint` stretches each imprint to [0, 1] as the paper does, `absolute` keeps the depth range",
    )

    @property
    def taxels(self) -> Layout:
        """The layout of the taxels."""
        return layout_of(self.layout, self.resolution)

    @field_validator("layout", mode="after")
    @classmethod
    def _layout_is_one(cls, layout: str | Taxels) -> str | Taxels:
        if len(layout) > MOST_TAXELS:
            raise ValueError(f"it has {len(layout):,} taxels; at most {MOST_TAXELS:,} are allowed")
        try:
            layout_of(layout, 2)
        except ParameterError as error:
            raise ValueError(str(error).rstrip(".")) from error
        return layout

    @model_validator(mode="after")
    def _sizes_agree(self) -> Self:
        if self.smallest_size > self.largest_size:
            raise ValueError(
                f"smallest_size is {self.smallest_size}; at most largest_size ({self.largest_size}) is allowed."
            )
        return self
