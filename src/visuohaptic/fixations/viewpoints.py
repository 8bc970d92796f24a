"""Viewpoints: cameras around an object, and their rays."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visuohaptic.fixations.parameters import ViewpointParameters

GOLDEN_ANGLE = math.pi * (3.0 - math.sqrt(5.0))


@dataclass(frozen=True)
class Camera:
    """One viewpoint: an eye that looks at the origin of the object frame.

    Attributes
    ----------
    azimuth_degrees : float
        Around the vertical axis, from +z towards +x.
    elevation_degrees : float
        Above the horizontal plane, -90 to 90.
    distance : float
        From the origin to the eye, object radii.
    field_of_view_degrees : float
        Angle between the view's top and bottom edge.
    projection : str
        ``perspective`` or ``orthographic``.
    roll_degrees : float
        Turn about the viewing axis, counter-clockwise as the camera sees itself turn.
    """

    azimuth_degrees: float
    elevation_degrees: float
    distance: float
    field_of_view_degrees: float
    projection: str = "perspective"
    roll_degrees: float = 0.0

    @property
    def axes(self) -> NDArray[np.float64]:
        """Unit vectors right, up and back (towards the eye), rows of a rotation, shape (3, 3).

        They follow from the angles without a cross product, so a camera
        straight above the object has an upright view too.
        """
        azimuth, elevation, roll = np.radians(
            [self.azimuth_degrees, self.elevation_degrees, self.roll_degrees]
        )
        right = np.array([np.cos(azimuth), 0.0, -np.sin(azimuth)])
        back = np.array(
            [
                np.sin(azimuth) * np.cos(elevation),
                np.sin(elevation),
                np.cos(azimuth) * np.cos(elevation),
            ]
        )
        up = np.cross(back, right)
        return np.stack(
            [
                np.cos(roll) * right + np.sin(roll) * up,
                np.cos(roll) * up - np.sin(roll) * right,
                back,
            ]
        )

    @property
    def eye(self) -> NDArray[np.float64]:
        """Centre of the camera in the object frame, shape (3,)."""
        return self.distance * self.axes[2]

    @property
    def view_height(self) -> float:
        """Height of the view in the plane through the object's centre, object radii."""
        return 2.0 * self.distance * math.tan(math.radians(self.field_of_view_degrees) / 2.0)

    def rays(self, resolution: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Give the ray through the centre of each pixel of a square view.

        Parameters
        ----------
        resolution : int
            Pixels along each edge, n.

        Returns
        -------
        origins, directions : numpy.ndarray
            Shape (n·n, 3) each, row by row from the view's upper left, in the
            object frame. An optical-axis component of a direction has length 1,
            so the distance along a ray is the depth along the viewing axis.
        """
        right, up, back = self.axes
        half = math.tan(math.radians(self.field_of_view_degrees) / 2.0)
        steps = (np.arange(resolution) - 0.5 * (resolution - 1)) * (2.0 * half / resolution)
        across = np.tile(steps, resolution)[:, None]
        down = np.repeat(steps, resolution)[:, None]
        plane = across * right - down * up
        if self.projection == "orthographic":
            return self.eye + self.distance * plane, np.broadcast_to(-back, plane.shape)
        return np.broadcast_to(self.eye, plane.shape), plane - back


def place_cameras(parameters: ViewpointParameters) -> list[Camera]:
    """Place every camera of an arrangement.

    Parameters
    ----------
    parameters : ViewpointParameters
        The arrangement; rings follow each other in the order of their
        elevations, each from its first azimuth on; the Fibonacci sphere runs
        from top to bottom.

    Returns
    -------
    list of Camera
        In an order that depends on the parameters alone.

    Notes
    -----
    The Fibonacci sphere takes heights at the middle of equal slices and turns by
    the golden angle (Swinbank & Purser 2006, Q. J. R. Meteorol. Soc. 132).
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
            azimuth_degrees=parameters.first_azimuth_degrees + azimuth,
            elevation_degrees=elevation,
            distance=parameters.distance,
            field_of_view_degrees=parameters.field_of_view_degrees,
            projection=parameters.projection,
            roll_degrees=parameters.roll_degrees,
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
