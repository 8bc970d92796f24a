"""Sections `viewpoints` and `rendering` of `params.yaml`."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, field_validator

from visuohaptic.base.section import Section

LARGEST_RESOLUTION = 2048
"""Largest number of rows and columns of a view; rendering and attending to a view of this size takes 0.8 GB."""

PIXELS_AT_ONCE = LARGEST_RESOLUTION**2
"""Largest number of pixels of the views that are held in memory together; a pixel takes 78 bytes."""


class ViewpointParameters(Section):
    """Arrangement of the viewpoints, and the lens of all cameras.

    In the object frame y is up, and the object's bounding sphere has radius 1 and its centre in the origin. Every
    camera looks at the origin.
    """

    arrangement: Literal["rings", "fibonacci"] = Field(
        "rings",
        description="`rings`: a circle around the vertical axis per elevation; "
        "`fibonacci`: evenly over the whole sphere",
    )
    count: int = Field(
        16,
        gt=0,
        le=1024,  # a third of a degree between neighbours, which then have the same view
        description="Viewpoints on each ring, or on the whole Fibonacci sphere",
    )
    elevations_degrees: tuple[float, ...] = Field(
        (20.0,),
        min_length=1,
        description="Elevation of each ring above the horizon (degrees); for `rings` only",
    )
    distance: float = Field(
        3.0, gt=1.0, description="Distance from the object's centre to the camera (object radii)"
    )
    projection: Literal["perspective", "orthographic"] = Field(
        "perspective",
        description="Rays of the camera: from a point (`perspective`) or parallel (`orthographic`)",
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
            raise ValueError(f"elevations are {outside}; -90 to 90 degrees are allowed.")
        return values


class RenderingParameters(Section):
    """How views are rendered."""

    resolution: int = Field(
        256,
        ge=16,
        le=LARGEST_RESOLUTION,
        description="Rows and columns of a view (pixels)",
    )
    ambient: float = Field(
        0.4, ge=0.0, le=1.0, description="Share of ambient light, which has no direction"
    )
    background: float = Field(
        0.85, ge=0.0, le=1.0, description="Grey level of the background; it changes no saliency map"
    )

    @property
    def views_at_once(self) -> int:
        """Number of views that are held in memory together; the number changes no result."""
        return max(1, PIXELS_AT_ONCE // self.resolution**2)
