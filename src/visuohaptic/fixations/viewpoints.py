"""Viewpoints: cameras around an object, and their rays."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.fixations.parameters import ViewpointParameters
from visuohaptic.geometry.elementary import sin_cos, tangent

GOLDEN_ANGLE = math.pi * (3.0 - math.sqrt(5.0))
FIELD_OF_VIEW_DEGREES = 40.0
"""The object fills the view: at the default distance of 3 object radii its bounding sphere spans 39°."""


@dataclass(frozen=True)
class Camera:
    """A camera that looks at the origin of the object frame.

    Attributes
    ----------
    azimuth_degrees : float
        Angle around the vertical axis, from +z towards +x.
    elevation_degrees : float
        Angle above the horizontal plane.
    distance : float
        Distance from the origin, object radii.
    field_of_view_degrees : float
        Angle from the top to the bottom edge. An orthographic view has the height of a perspective view in the
        plane through the origin.
    projection : {"perspective", "orthographic"}
        Rays from a point, or parallel rays.
    """

    azimuth_degrees: float
    elevation_degrees: float
    distance: float
    field_of_view_degrees: float
    projection: str = "perspective"

    @cached_property
    def axes(self) -> FloatArray:
        """Rotation (3, 3) with the unit vectors right, up and back as rows, defined at the poles too.

        Back points from the origin to the camera.
        """
        angles = [self.azimuth_degrees, self.elevation_degrees]
        (east, rise), (north, level) = sin_cos(np.radians(angles))
        right = np.array([north, 0.0, -east])
        back = np.array([east * level, rise, north * level])
        return np.stack([right, np.cross(back, right), back])

    @cached_property
    def eye(self) -> FloatArray:
        """Centre of the camera in the object frame, shape (3,)."""
        return self.distance * self.axes[2]

    @property
    def view_height(self) -> float:
        """Height of the view in the plane through the origin, object radii."""
        return 2.0 * self.distance * self._half_height

    def window(self, points: FloatArray, resolution: int) -> IntArray:
        """Return the pixels (m,), counted row by row, of the smallest rectangle that shows all points (k, 3).

        No other pixel can see a surface with these corners. If a point is not in front of the camera, all pixels are
        returned.
        """
        right, up, back = np.einsum("nd,kd->kn", points, self.axes)
        depth = np.full_like(back, self.distance)
        if self.projection == "perspective":
            depth -= back
        if depth.min(initial=np.inf) <= 0.0:
            return np.arange(resolution**2)
        columns = _pixels_between(right / depth, self._steps(resolution))
        rows = _pixels_between(-up / depth, self._steps(resolution))
        return (resolution * rows[:, None] + columns).reshape(-1)

    def rays(
        self, resolution: int, pixels: IntArray | None = None
    ) -> tuple[FloatArray, FloatArray]:
        """Return origins and directions (m, 3) of the rays through the centres of pixels (m,), by default all pixels.

        Along the viewing axis directions have length 1, so the distance along a ray is the depth.
        """
        right, up, back = self.axes
        steps = self._steps(resolution)
        rows, columns = np.divmod(
            np.arange(resolution**2) if pixels is None else pixels, resolution
        )
        plane = (np.outer(right, steps[columns]) - np.outer(up, steps[rows])).T
        if self.projection == "orthographic":
            return self.eye + self.distance * plane, np.broadcast_to(-back, plane.shape)
        return np.broadcast_to(self.eye, plane.shape), plane - back

    def project(self, points: FloatArray, resolution: int) -> FloatArray:
        """Return the positions (..., 2), column and row, of points (..., 3) in front of the camera: inverse of `rays`.

        Positions are in pixels from the upper left corner, so the centre of the first pixel is at 0.5. The view has
        `resolution` × `resolution` pixels.
        """
        right, up, back = self.axes
        depth = np.full(points.shape[:-1], self.distance)
        if self.projection == "perspective":
            depth -= points @ back
        pixels = 0.5 * resolution / self._half_height
        return 0.5 * resolution + pixels * np.stack(
            [points @ right / depth, -(points @ up) / depth], axis=-1
        )

    def pixel_sides(self, resolution: int, depths: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the sides of a pixel, to the right and up, at depths (n,): vectors (n, 3), object frame."""
        size = self.view_height / (self.distance * resolution)
        if self.projection == "orthographic":
            depths = np.full_like(depths, self.distance)
        right, up, _ = self.axes
        return np.outer(size * depths, right), np.outer(size * depths, up)

    def _steps(self, resolution: int) -> FloatArray:
        """Return the pixels' centres along an edge in the plane at depth 1."""
        steps = np.arange(resolution, dtype=np.float64) - 0.5 * (resolution - 1)
        return steps * (2.0 * self._half_height / resolution)

    @property
    def _half_height(self) -> float:
        """Half the view's height at depth 1."""
        return tangent(math.radians(self.field_of_view_degrees) / 2.0)


def place_cameras(parameters: ViewpointParameters) -> list[Camera]:
    """Return the cameras of an arrangement, by viewpoint number.

    Rings follow in the order of their elevations, and each ring begins in front of the object, at +z. A Fibonacci
    sphere begins at the top: camera i is in the middle of slice i of equal height, turned by i golden angles
    (Swinbank & Purser 2006, Q. J. R. Meteorol. Soc. 132).
    """
    if parameters.arrangement == "fibonacci":
        angles = _fibonacci_angles(parameters.count)
    else:
        angles = [
            (360.0 * index / parameters.count, elevation)
            for elevation in parameters.elevations_degrees
            for index in range(parameters.count)
        ]
    return [
        Camera(
            azimuth_degrees=azimuth,
            elevation_degrees=elevation,
            distance=parameters.distance,
            field_of_view_degrees=FIELD_OF_VIEW_DEGREES,
            projection=parameters.projection,
        )
        for azimuth, elevation in angles
    ]


def _fibonacci_angles(count: int) -> list[tuple[float, float]]:
    return [
        (
            math.degrees(index * GOLDEN_ANGLE) % 360.0,
            math.degrees(math.asin(1.0 - (2.0 * index + 1.0) / count)),
        )
        for index in range(count)
    ]


def _pixels_between(positions: FloatArray, steps: FloatArray) -> IntArray:
    """Return the pixels along an edge that cover some positions, with a margin of a pixel at each end."""
    if not len(positions):
        return np.arange(0)
    first, end = np.searchsorted(steps, [positions.min(), positions.max()])
    return np.arange(max(first - 1, 0), min(end + 1, len(steps)))
