"""What a touch records of its place: the pose of the sensor, not that of the view."""

import numpy as np
import pyarrow as pa
import pytest
import trimesh

from visuohaptic.fixations.locations import location_table
from visuohaptic.fixations.places import ProbingLocations
from visuohaptic.fixations.viewpoints import Camera
from visuohaptic.geometry.layouts import grid_layout
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor import SensorParameters
from visuohaptic.tables.phases import NORMAL_NAMES, POINT_NAMES, TANGENT_NAMES
from visuohaptic.tables.schema import matrix
from visuohaptic.touches.touch_table import touch_outlines, touch_part

TILTED = np.array([[0.6, 0.8, 0.0], [0.0, 0.8, 0.6]])
UP = np.array([0.0, 1.0, 0.0])


def touched(**sensor):
    """Touch the top of a box at two points whose given normals are tilted."""
    box = trimesh.creation.box((1, 1, 1))
    grey = np.full((len(box.faces), 3), 128, np.uint8)
    surface = Surface(box.vertices, box.faces, grey)
    points = np.array([[0.1, 0.5, 0.0], [-0.2, 0.5, 0.1]])
    caster = RayCaster(surface)
    _, faces = caster.nearest(points)
    locations = location_table("a/b", {(0, "fixation"): ProbingLocations(points, TILTED, faces)})
    parameters = SensorParameters(resolution=8, **sensor)
    return points, touch_part(caster, locations, parameters, Scene(), 1, np.array([3, 5])).touches


@pytest.mark.parametrize(("normal", "felt"), [("face", [UP, UP]), ("given", TILTED)])
def test_a_touch_has_the_normal_of_its_sensor(normal, felt):
    points, touches = touched(normal=normal)
    np.testing.assert_array_equal(matrix(touches, POINT_NAMES), points)
    normals, tangents = matrix(touches, NORMAL_NAMES), matrix(touches, TANGENT_NAMES)
    np.testing.assert_allclose(normals, felt, atol=1e-12)
    np.testing.assert_allclose((normals * tangents).sum(axis=1), 0, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(tangents, axis=1), 1, atol=1e-12)
    assert touches["touch"].to_pylist() == [0, 1]
    assert touches["rank"].to_pylist() == [3, 5]


def test_a_flat_top_is_touched_by_the_largest_square_without_penetration():
    _, touches = touched(largest_size=0.2)
    assert touches["contact_state"].to_pylist() == ["full", "full"]
    assert touches["sensor_size"].to_pylist() == [0.2, 0.2]
    assert touches["penetration"].to_pylist() == [0.0, 0.0]
    assert (np.array(touches["image"].to_pylist()) == 1).all()


def test_squares_have_the_size_of_the_sensor_and_lie_around_their_touch():
    camera = Camera(0.0, 0.0, 3.0, 40.0, "orthographic")
    columns = {"x": 0.1, "y": 0.2, "z": 0.9, "normal_x": 0.0, "normal_y": 0.0, "normal_z": 1.0}
    columns |= {"tangent_x": 1.0, "tangent_y": 0.0, "tangent_z": 0.0, "sensor_size": 0.3}
    touch = pa.table({name: [value] for name, value in columns.items()})
    (corners,) = camera.project(touch_outlines(touch, grid_layout(32, 32)), 100)
    unit = 100 / (2 * np.tan(np.radians(20)) * 3.0)
    edges = np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1)
    np.testing.assert_allclose(edges, 4 * [0.3 * unit])
    np.testing.assert_allclose(corners.mean(axis=0), [50 + 0.1 * unit, 50 - 0.2 * unit])
    np.testing.assert_allclose(corners[0], [50 - 0.05 * unit, 50 - 0.35 * unit])
