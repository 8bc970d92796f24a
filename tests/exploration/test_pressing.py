"""Sensors at any pose."""

import re

import numpy as np
import pytest
import trimesh

import visuohaptic as vh
from visuohaptic.base.errors import MeshError, ParameterError
from visuohaptic.exploration import pressing

BALL = trimesh.creation.icosphere(5, radius=40.0)


def poses(count=20, seed=0):
    normals = np.random.default_rng(seed).normal(size=(count, 3))
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def test_a_ball_is_as_deep_as_it_is_round_wherever_it_lies():
    normals = poses()
    moved = BALL.copy()
    moved.apply_translation([500.0, -20.0, 3.0])
    felt = vh.press(moved, normals * 40 + [500.0, -20.0, 3.0], 3 * normals, 12.0, resolution=16)
    offsets = (2 * np.arange(16) - 15) / 16 * 6
    expected = np.sqrt(40**2 - offsets[:, None] ** 2 - offsets**2) - 40
    np.testing.assert_allclose(felt.heights, np.broadcast_to(expected, (20, 16, 16)), atol=0.06)
    assert felt.images.dtype == np.float32
    np.testing.assert_allclose(felt.images, np.clip(1 + felt.heights / 4, 0, 1), atol=1e-6)


def test_arrays_and_a_trimesh_give_the_same_and_each_pose_is_alone():
    normals = poses()
    sizes = np.linspace(2, 20, 20)
    arrays = (BALL.vertices, BALL.faces)
    together = vh.press(arrays, normals * 40, normals, sizes, above=9.0, depth=3)
    for place in (0, 19):
        normal = normals[[place]]
        alone = vh.press(BALL, normal * 40, normal, sizes[place], above=9.0, depth=3)
        np.testing.assert_array_equal(together.heights[place], alone.heights[0])


def test_a_plane_in_the_air_feels_nothing_and_one_within_is_full():
    normals = poses(3)
    air = vh.press(BALL, normals * 80, normals, 5.0)
    assert not air.images.any()
    within = vh.press(BALL, normals * 38, normals, 5.0, resolution=8)
    assert (within.images == 1).all()
    assert (within.heights > 1).all()


@pytest.mark.parametrize(
    "change", [lambda pose: pose.T, lambda pose: pose + np.full(4, 9.0) * pose[3, :, None]]
)
def test_a_pose_with_another_bottom_row_is_refused(change):
    pose = np.eye(4)
    pose[:3, 3] = [0.0, 0.0, 40.0]
    with pytest.raises(
        ParameterError, match=r"Pose 1 has the bottom row .*; \[0, 0, 0, 1\] is needed"
    ):
        vh.press(BALL, poses=[pose, change(pose)], size=2.0)


@pytest.mark.parametrize("shape", [(4, 4), (2, 3, 4), (2, 4, 3), (2, 4, 4, 1), (2,)])
def test_poses_of_another_shape_are_refused(shape):
    with pytest.raises(
        ParameterError, match=rf"poses has the shape {re.escape(str(shape))}; \(n, 4, 4\) is needed"
    ):
        vh.press(BALL, poses=np.ones(shape), size=2.0)


def test_no_pose_gives_no_image():
    assert vh.press(BALL, np.zeros((0, 3)), np.zeros((0, 3)), 1.0).images.shape == (0, 32, 32)


@pytest.mark.parametrize(
    ("change", "error", "sentence"),
    [
        ({"points": [[0, 0]]}, ParameterError, r"points has the shape \(1, 2\)"),
        ({"points": np.zeros((2, 3))}, ParameterError, "1 normals for 2 points"),
        ({"normals": [[0, 0, 0]]}, ParameterError, "normals has no direction in row 0"),
        ({"size": -1}, ParameterError, "size holds -1"),
        ({"resolution": 1}, ParameterError, "resolution is 1"),
        ({"depth": 0}, ParameterError, "depth holds 0"),
        ({"mesh": (np.zeros((3, 3)), np.zeros((0, 3), int))}, MeshError, "no faces"),
        ({"mesh": (np.eye(3), [[0, 1, 3]])}, MeshError, "a face names vertex 3; 0 to 2 are there"),
        ({"mesh": 7}, MeshError, "type int; a path, a trimesh.Trimesh"),
    ],
)
def test_what_is_not_allowed_is_refused_in_a_sentence(change, error, sentence):
    given = {"mesh": BALL, "points": [[0, 40, 0]], "normals": [[0, 1, 0]], "size": 1.0} | change
    with pytest.raises(error, match=sentence):
        vh.press(**given)


CUBE = trimesh.creation.box((1, 1, 1))
TOP = {"points": [[0, 0, 0.5]], "normals": [[0, 0, 1]], "size": 0.2, "resolution": 8}


@pytest.mark.parametrize("far", [[1e8, 0, 0], [np.nan, 0, 0], [np.inf, 0, 0], [1e300, 0, 0]])
def test_a_vertex_that_no_face_names_is_no_part_of_the_mesh(far):
    felt = vh.press((np.vstack([CUBE.vertices, [far]]), CUBE.faces), **TOP)
    np.testing.assert_array_equal(felt.heights, vh.press(CUBE, **TOP).heights)


def test_a_file_is_pressed_as_the_mesh_that_it_holds(tmp_path):
    CUBE.export(tmp_path / "cube.stl")
    np.testing.assert_array_equal(vh.press(tmp_path / "cube.stl", **TOP).images, np.ones((1, 8, 8)))


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"resolution": 5000}, "resolution is 5000; a whole number from 2 to 1024"),
        ({"resolution": np.nan}, "resolution is nan"),
        ({"resolution": 10**20}, "resolution is 100000000000000000000; a whole number"),
        ({"resolution": 10**5000}, "resolution holds a number that float64 can't hold"),
        ({"roll": np.inf}, "roll"),
        ({"seed": np.nan}, "seed is nan; a whole number of at least 0"),
        ({"seed": -1}, "seed is -1; a whole number of at least 0"),
        (
            {"resolution": 1024, "points": np.zeros((100, 3)), "normals": np.ones((100, 3))},
            "100 sensors of 1024 x 1024 have 104857600 sensing points",
        ),
        ({"points": [[1e200, 0, 0]]}, r"points has NaN, infinite .* row 0"),
        ({"points": [[0, 1e308, 0]]}, "beyond 1e[+]100"),
        ({"normals": [[0, 1e308, 1e308]]}, "normals has NaN, infinite"),
        ({"points": [[1e50, 0, 0]]}, "radii are allowed"),
        ({"size": 1e200}, r"size holds 1e[+]200"),
        ({"depth": 1e60}, "radii are allowed"),
        ({"above": np.inf}, "above holds inf"),
    ],
)
def test_sizes_are_bounded_before_memory_is_taken_and_numbers_before_they_overflow(change, says):
    with pytest.raises(ParameterError, match=says):
        vh.press(CUBE, **{**TOP, **change})


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("scale", [1e200, 1e308, 1e-200])
def test_a_mesh_of_coordinates_that_no_ray_meets_is_refused(scale):
    with pytest.raises(MeshError, match="vertices"):
        vh.press((CUBE.vertices * scale, CUBE.faces), **TOP)


def test_blocks_of_sensors_give_what_one_batch_gives(monkeypatch):
    normals = poses(7)
    given = {"points": normals * 40, "normals": normals, "size": 5.0, "resolution": 8}
    scene = {"scene": "worn_fsr", "unit": "mm", "seed": 3}
    whole = [vh.press(BALL, **given), vh.press(BALL, **given, **scene)]
    monkeypatch.setattr(pressing, "_POINTS_AT_ONCE", 3 * 64)
    for expected, found in zip(
        whole, [vh.press(BALL, **given), vh.press(BALL, **given, **scene)], strict=True
    ):
        np.testing.assert_array_equal(expected.images, found.images)
        np.testing.assert_array_equal(expected.heights, found.heights)
