"""Positions of points and touches in a view."""

from __future__ import annotations

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.fixations.viewpoints import Camera
from visuohaptic.sensor.frames import row_axes
from visuohaptic.tables.phases import NORMAL_NAMES, POINT_NAMES, TANGENT_NAMES
from visuohaptic.tables.schema import matrix


def project(camera: Camera, points: NDArray[np.float64], resolution: int) -> NDArray[np.float64]:
    """Compute the positions (n, 2), column and row, of points (n, 3) in a camera's view.

    Points are in the object frame, in front of the camera. Positions are in pixels from the upper left corner, so the
    centre of the first pixel is at 0.5. The view has `resolution` × `resolution` pixels. Inverse of `Camera.rays`.
    """
    right, up, back = camera.axes
    if camera.projection == "orthographic":
        depth = np.full(len(points), camera.distance)
    else:
        depth = camera.distance - points @ back
    pixels = resolution / (2.0 * np.tan(np.radians(camera.field_of_view_degrees) / 2.0))
    across, down = points @ right / depth, -(points @ up) / depth
    return 0.5 * resolution + pixels * np.column_stack([across, down])


def squares_in_view(camera: Camera, touches: pa.Table, resolution: int) -> NDArray[np.float64]:
    """Compute the corners (n, 4, 2), column and row in pixels, of the sensor's squares in a camera's view.

    `touches` are rows of `tables.TOUCHES`. Positions are as in `project`.
    """
    points, columns = matrix(touches, POINT_NAMES), matrix(touches, TANGENT_NAMES)
    half = 0.5 * touches.column("sensor_size").to_numpy()[:, None]
    across, down = half * columns, half * row_axes(matrix(touches, NORMAL_NAMES), columns)
    signs = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    corners = np.stack([points + a * across + b * down for a, b in signs], axis=1)
    return project(camera, corners.reshape(-1, 3), resolution).reshape(-1, 4, 2)
