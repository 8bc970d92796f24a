import numpy as np
import pytest
from pydantic import ValidationError

from visuohaptic.fixations.parameters import ViewpointParameters
from visuohaptic.fixations.viewpoints import Camera, place_cameras


def test_default_is_sixteen_around_the_vertical_axis():
    cameras = place_cameras(ViewpointParameters())
    eyes = np.array([camera.eye for camera in cameras])
    assert len(cameras) == 16
    np.testing.assert_allclose(np.linalg.norm(eyes, axis=1), 3.0)
    np.testing.assert_allclose(eyes[:, 1], 3.0 * np.sin(np.radians(20.0)))
    angles = np.degrees(np.arctan2(eyes[:, 0], eyes[:, 2])) % 360
    np.testing.assert_allclose(angles, 22.5 * np.arange(16), atol=1e-9)


def test_rings_follow_their_elevations():
    parameters = ViewpointParameters(count=4, elevations_degrees=(-30.0, 0.0, 90.0))
    elevations = [camera.elevation_degrees for camera in place_cameras(parameters)]
    assert elevations == [-30.0] * 4 + [0.0] * 4 + [90.0] * 4


@pytest.mark.parametrize("count", [1, 16, 100])
def test_fibonacci_sphere_is_even(count):
    cameras = place_cameras(ViewpointParameters(arrangement="fibonacci", count=count))
    eyes = np.array([camera.eye for camera in cameras]) / 3.0
    assert len(eyes) == count
    assert np.linalg.norm(eyes.mean(axis=0)) < 1.2 / np.sqrt(count)
    if count > 1:
        gaps = np.linalg.norm(eyes[:, None] - eyes[None], axis=2) + 9 * np.eye(count)
        # The densest packing of n caps has gaps of about sqrt(8 pi / (sqrt(3) n)).
        assert gaps.min() > 0.7 * np.sqrt(8 * np.pi / (np.sqrt(3) * count))


@pytest.mark.parametrize("elevation", [-90.0, -20.0, 0.0, 65.0, 90.0])
def test_axes_are_a_rotation_and_look_at_the_origin(elevation):
    camera = Camera(77.0, elevation, 3.0, 40.0)
    np.testing.assert_allclose(camera.axes @ camera.axes.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(camera.axes) == pytest.approx(1.0)
    np.testing.assert_allclose(camera.eye, 3.0 * camera.axes[2])
    assert camera.axes[1, 1] >= -1e-12
    assert camera.axes[0, 1] == pytest.approx(0.0)


@pytest.mark.parametrize("projection", ["perspective", "orthographic"])
@pytest.mark.parametrize("resolution", [3, 64, 65])
def test_rays_fill_the_field_of_view(projection, resolution):
    camera = Camera(30.0, 20.0, 3.0, 40.0, projection)
    origins, directions = camera.rays(resolution)
    reach = -origins @ camera.axes[2] / (directions @ camera.axes[2])
    meets = origins + reach[:, None] * directions
    up = (meets @ camera.axes[1]).reshape(resolution, resolution)
    right = (meets @ camera.axes[0]).reshape(resolution, resolution)
    edge = 0.5 * camera.view_height * (1 - 1 / resolution)
    np.testing.assert_allclose(up[[0, -1], 0], [edge, -edge])
    np.testing.assert_allclose(right[0, [0, -1]], [-edge, edge])
    np.testing.assert_allclose(directions @ camera.axes[2], -1.0)


def test_the_window_is_the_rectangle_of_pixels_around_the_points():
    camera = Camera(0.0, 0.0, 3.0, 40.0)
    rows, columns = np.divmod(camera.window(np.array([[0.5, 0.25, 0.0], [0.6, 0.3, 0.1]]), 64), 64)
    assert (rows.min(), rows.max(), columns.min(), columns.max()) == (22, 25, 46, 50)
    assert len(rows) == 4 * 5
    assert not len(camera.window(np.zeros((0, 3)), 64))


def test_an_elevation_beyond_the_poles_is_refused():
    with pytest.raises(ValidationError, match="-90 to 90"):
        ViewpointParameters(elevations_degrees=(91.0,))


def test_the_window_is_the_whole_view_where_a_point_is_not_in_front_of_the_camera():
    points = np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 3.0]])
    assert len(Camera(0.0, 0.0, 3.0, 40.0).window(points, 8)) == 64
    assert len(Camera(0.0, 0.0, 3.0, 40.0, "orthographic").window(points, 8)) < 64


@pytest.mark.parametrize("projection", ["perspective", "orthographic"])
def test_projecting_undoes_casting(projection):
    camera = Camera(30.0, 20.0, 3.0, 40.0, projection)
    origins, directions = camera.rays(16)
    places = camera.project(origins + 2.7 * directions, 16)
    rows, columns = np.divmod(np.arange(256), 16)
    np.testing.assert_allclose(places, np.column_stack([columns, rows]) + 0.5, atol=1e-9)
