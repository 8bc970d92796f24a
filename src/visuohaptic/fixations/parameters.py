"""Sections `viewpoints` and `rendering` of `params.yaml`; `attention` has its own package."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, field_validator

from visuohaptic.base.section import Section


class ViewpointParameters(Section):
    """Arrangement of the viewpoints and the lens that all of them share.

    The object frame has y up; its bounding sphere has radius 1 about the origin,
    at which every camera looks.
    """

    arrangement: Literal["rings", "fibonacci"] = Field(
        "rings",
        description="`rings`: circles around the vertical axis, one for each elevation; "
        "`fibonacci`: evenly over the whole sphere",
    )
    count: int = Field(
        16,
        gt=0,
        le=1024,  # a third of a degree apart: neighbours see the same
        description="Viewpoints on each ring, or on the whole Fibonacci sphere",
    )
    elevations_degrees: tuple[float, ...] = Field(
        (20.0,),
        min_length=1,
        description="Height of each ring above the horizon (degrees); not used by `fibonacci`",
    )
    distance: float = Field(
        3.0, gt=1.0, description="From the object's centre to the eye (object radii)"
    )
    projection: Literal["perspective", "orthographic"] = Field(
        "perspective",
        description="How rays leave the camera: from one point (`perspective`), or parallel (`orthographic`)",
    )

    @property
    def total(self) -> int:
        """Number of viewpoints in the whole arrangement."""
        rings = len(self.elevations_degrees) if self.arrangement == "rings" else 1
        return self.count * rings

    @field_validator("elevations_degrees")
    @classmethod
    def _within_the_poles(cls, values: tuple[float, ...]) -> tuple[float, ...]:
        outside = [value for value in values if not -90.0 <= value <= 90.0]
        if outside:
            raise ValueError(f"elevations are {outside}; -90 to 90 degrees is allowed.")
        return values


class RenderingParameters(Section):
    """How views are rendered."""

    resolution: int = Field(
        256,
        ge=16,
        le=4096,  # rendering such a view takes 2 GB
        description="Rows and columns of a view (pixels)",
    )
    ambient: float = Field(
        0.4, ge=0.0, le=1.0, description="Share of light that comes evenly from everywhere"
    )
    background: float = Field(
        0.85, ge=0.0, le=1.0, description="Grey level where no surface is; no channel looks at it"
    )
