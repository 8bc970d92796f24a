"""What was touched is found again in the frame of the object's file, and pressed again there."""

import re
import warnings

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pytest
import trimesh
from scipy.spatial.transform import Rotation

import visuohaptic as vh
from visuohaptic.base.errors import MeshError, ParameterError
from visuohaptic.exploration.pose_files import read_poses, write_poses
from visuohaptic.tables.phases import NORMAL_NAMES, POINT_NAMES, TANGENT_NAMES
from visuohaptic.tables.schema import matrix

SMALL = {"rendering.resolution": 64, "sensor.normal": "given"}


def lying_bottle():
    """A bottle of 120 mm that lies far from the origin, its axis along z, as printers like it."""
    profile = [[0, 0], [25, 0], [25, 70], [10, 90], [10, 120], [0, 120]]
    mesh = trimesh.creation.revolve(profile, sections=64)
    mesh.apply_translation([300.0, -40.0, 7.0])
    return mesh


@pytest.fixture(scope="module")
def touched():
    mesh = lying_bottle()
    parameters = {**SMALL, "meshes.own_up_axis": "z"}
    found = vh.load(mesh, parameters=parameters, unit="mm")
    return mesh, found, found.touch(2, "random", parameters)


def test_the_way_from_the_file_takes_its_vertices_to_the_surface(touched):
    mesh, found, _ = touched
    there = found.frame.points_in_object(mesh.vertices)
    np.testing.assert_allclose(np.linalg.norm(there, axis=1).max(), 1.0, atol=1e-6)
    distances = np.abs(found.surface.vertices[:, None] - there[None]).max(axis=2).min(axis=1)
    assert distances.max() < 2e-7
    np.testing.assert_allclose(found.frame.points_in_file(there), mesh.vertices, atol=1e-10)


def test_touches_lie_on_the_file_s_own_mesh_and_face_outwards(touched):
    mesh, _, explored = touched
    table = explored.frame.table(explored.touches)
    assert table.schema.metadata == {b"frame": b"file", b"unit": b'"mm"'}
    points, normals = matrix(table, POINT_NAMES), matrix(table, NORMAL_NAMES)
    for point, normal in zip(points, normals, strict=True):
        nearest = trimesh.triangles.closest_point(mesh.triangles, [point] * len(mesh.faces))
        distances = np.linalg.norm(nearest - point, axis=1)
        # In mm; vertices are float32 in the object frame. Faces meet at edges, so several may be as near.
        assert distances.min() < 1e-4
        assert (mesh.face_normals[distances < 1e-4] @ normal > 0.5).any()
    assert pc.max(table.column("sensor_size")).as_py() == pytest.approx(0.3 * explored.frame.radius)


def test_a_pose_pressed_on_the_file_s_mesh_feels_what_the_touch_felt(touched):
    mesh, _, explored = touched
    sizes = explored.touches.column("sensor_size").to_numpy() * explored.frame.radius
    whole = np.array(explored.touches.column("contact_state").to_pylist()) == "full"
    assert whole.sum() >= 5
    depth = 0.1 * explored.frame.radius
    felt = vh.press(mesh, poses=explored.poses[whole], size=sizes[whole], depth=depth)
    rough = felt.images - felt.images.max(axis=(1, 2), keepdims=True)
    span = np.maximum(-rough.min(axis=(1, 2), keepdims=True), 1e-3 / 0.1)
    again = np.where(felt.images.max(axis=(1, 2), keepdims=True) > 0, 1 + rough / span, 0)
    np.testing.assert_allclose(np.clip(again, 0, 1), explored.imprints[whole], atol=2e-4)


def test_poses_are_rotations_and_come_back_from_a_file_to_the_last_digits(touched, tmp_path):
    poses = touched[2].poses
    axes = poses[:, :3, :3]
    squares = axes @ np.swapaxes(axes, 1, 2)
    np.testing.assert_allclose(squares, np.broadcast_to(np.eye(3), squares.shape), atol=1e-12)
    assert (np.linalg.det(axes) > 0).all()
    write_poses(poses, tmp_path / "poses.csv")
    np.testing.assert_allclose(read_poses(tmp_path / "poses.csv"), poses, rtol=1e-13, atol=1e-12)


def test_the_unit_gives_the_scene_the_object_s_real_size():
    mesh = trimesh.creation.icosphere(3, radius=5.0)
    sized = vh.load(mesh, unit="mm")
    assert sized.frame.radius_m == pytest.approx(0.005, rel=1e-6)
    scene = {**SMALL, "scene.preset": "fsr400"}
    units = (None, "mm", "m")
    felt = [vh.load(mesh, "a/ball", unit=unit).touch(1, "random", scene) for unit in units]
    sizes = [one.parameters.scene.object_radius_m for one in felt]
    assert sizes == pytest.approx([0.05, 0.005, 5], rel=1e-6)
    assert not np.array_equal(felt[1].imprints, felt[2].imprints)
    own = vh.load(mesh, unit="mm").touch(1, "random", {**SMALL, "scene.object_radius_m": 0.02})
    assert own.parameters.scene.object_radius_m == 0.02
    with pytest.raises(MeshError, match="unit is 'feet'; mm, cm, m, in"):
        vh.load(lying_bottle(), unit="feet")


def test_a_file_of_points_normals_empty_lines_and_a_byte_order_mark_stands_as_press_does(tmp_path):
    ball = trimesh.creation.icosphere(4, radius=10.0)
    normals = np.array([[0.0, 0.0, 2.0], [1.0, 1.0, 0.0]])
    (tmp_path / "poses.csv").write_text(
        "\ufeffx,y,z,normal_x,normal_y,normal_z,roll\n\n0,0,10,0,0,2,0\n7.07,7.07,0,1,1,0,30\n\n"
    )
    read = vh.press(ball, poses=read_poses(tmp_path / "poses.csv"), size=2.0)
    given = vh.press(ball, [[0, 0, 10], [7.07, 7.07, 0]], normals, 2.0, roll=[0, 30])
    np.testing.assert_allclose(read.heights, given.heights, atol=1e-9)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("x,y,z\n1,2,3\n", "0 columns normal_x"),
        ("x,y,z,qw,qx,qy,qz\n\n1,2,3,0,0,0,0\n", "line 3: qw, qx, qy, qz are all 0"),
        ("x,y,z,qw,qx,qy,qz\n1,2,inf,1,0,0,0\n", "line 2, column z is 'inf': a finite number"),
        ("x,y,z,normal_x,normal_y,normal_z\n1,2,3,a,0,1\n", "line 2, column normal_x is 'a'"),
        ("x,y,z,normal_x,normal_y,normal_z\n1,2,3,1e200,0,1\n", r"normal_x is 1e\+200; .* 1e\+100"),
        ("x;y;z;qw;qx;qy;qz\n1;2;1e308;1;0;0;0\n", r"column z is 1e\+308"),
        ("x,y,z,qw,qx,qy,qz,x\n1,2,3,1,0,0,0,1\n", "2 columns x"),
        ("1,2,3,1,0,0,0\n", "its commas may separate 7 whole numbers, or be decimal signs"),
        ("1.5,2,3,1,0,0,0\n", "line 1 holds numbers; a header is needed"),
        ("", "no rows"),
        ("x,y,z,\xff\n", "no row of numbers below"),
        ("x,y,z\n\0", "zero bytes"),
    ],
)
def test_a_wrong_file_of_poses_is_refused_in_a_sentence(tmp_path, text, sentence):
    (tmp_path / "poses.csv").write_bytes(text.encode("latin-1"))
    with pytest.raises(ParameterError, match=sentence):
        read_poses(tmp_path / "poses.csv")


@pytest.mark.parametrize(
    ("text", "encoding"),
    [
        ("x;y;z;qw;qx;qy;qz;part\r\n0,5;0;1;2;0;0;0;a, b\r\n", "utf-16"),
        ("x\ty\tz\tqw\tqx\tqy\tqz\n0.5\t0\t1\t2\t0\t0\t0\n", "utf-8-sig"),
        (
            "sep=;\n# of a part\nx;y;z;normal_x;normal_y;normal_z;Größe\n0,5;0;1;0;0;1e-200;1\n",
            "latin-1",
        ),
        ('x,y,z,normal_x,normal_y,normal_z\n"0,5",0,1,0,0,"7,5"\n', "utf-8"),
    ],
)
def test_poses_are_read_as_spreadsheets_of_any_locale_write_them(tmp_path, text, encoding):
    (tmp_path / "poses.csv").write_bytes(text.encode(encoding))
    (pose,) = read_poses(tmp_path / "poses.csv")
    np.testing.assert_array_equal(pose[:3, 3], [0.5, 0, 1])
    np.testing.assert_array_equal(pose[:3, 2], [0, 0, 1])


@pytest.mark.parametrize("kind", ["poses", "points", "normals", "size", "depth", "above"])
@pytest.mark.parametrize("large", [1e39, 1e100, 1e200, 1e308])
def test_numbers_beyond_the_range_of_rays_are_refused_in_a_sentence(kind, large):
    pose = np.eye(4)
    given = {"points": [[0.0, 0, 1]], "normals": [[0.0, 0, 1]], "size": 0.2}
    if kind == "poses":
        pose[0, 3] = large
        given = {"poses": [pose], "size": 0.2}
    elif kind in {"points", "normals"}:
        given[kind] = [[0, 0, large]]
    else:
        given[kind] = large
    ball = trimesh.creation.icosphere(2)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        if large == 1e39 and kind == "normals":
            vh.press(ball, **given)
            return
        with pytest.raises(ParameterError, match=rf"{re.escape(f'{large:g}')}|beyond 1e\+100"):
            vh.press(ball, **given)


@pytest.mark.parametrize(
    "name", ["points", "normals", "size", "depth", "above", "resolution", "roll"]
)
def test_truth_values_and_text_are_no_numbers(name):
    given = {"points": [[0.0, 0, 1]], "normals": [[0.0, 0, 1]], "size": 0.2}
    for wrong in (True, "1 mm"):
        values = [[wrong] * 3] if name in {"points", "normals"} else wrong
        with pytest.raises(ParameterError, match=f"^{name} "):
            vh.press(trimesh.creation.icosphere(2), **given | {name: values})


def test_a_file_of_more_poses_than_allowed_is_refused(tmp_path, monkeypatch):
    file = tmp_path / "poses.csv"
    file.write_text("x,y,z,qw,qx,qy,qz\n" + "0,0,1,1,0,0,0\n" * 3)
    monkeypatch.setattr("visuohaptic.exploration.pose_files.MOST_POSES", 2)
    with pytest.raises(ParameterError, match=r"poses\.csv has more than 2 rows"):
        read_poses(file)
    write_poses(np.tile(np.eye(4), (2, 1, 1)), file)
    assert len(read_poses(file)) == 2


def test_turned_and_rectangular_sensors_feel_the_turned_surface():
    wall = trimesh.creation.box((40.0, 10.0, 4.0))
    pose = np.eye(4)
    pose[2, 3] = 2.0
    turned = pose.copy()
    turned[:3, :3] = Rotation.from_euler("z", 90, degrees=True).as_matrix()
    wide = vh.press(wall, poses=[pose, turned], size=(20.0, 8.0), resolution=(8, 20))
    assert wide.images.shape == (2, 8, 20)
    assert (wide.images[0] == 1).all()
    # The wall is 10 wide: half of the turned sensor's 20 columns stand over it.
    assert ((wide.images[1] == 1).sum(axis=1) == 10).all()
    by_roll = vh.press(wall, poses=[pose], size=(20.0, 8.0), resolution=(8, 20), roll=90.0)
    np.testing.assert_array_equal(by_roll.images[0], wide.images[1])


def test_points_that_are_felt_lie_on_the_mesh():
    ball = trimesh.creation.icosphere(5, radius=10.0)
    felt = vh.press(ball, [[0, 10, 0]], [[0, 1, 0]], (6.0, 3.0), resolution=(6, 12))
    points = felt.points.reshape(-1, 3)
    assert np.isfinite(points).all()
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 10.0, atol=0.02)
    assert (felt.points[0, :, 0, :] != felt.points[0, :, -1, :]).any()


def test_a_scene_needs_a_unit_and_square_cells_and_changes_the_images():
    ball = trimesh.creation.icosphere(4, radius=50.0)
    place = {"points": [[0, 50, 0]], "normals": [[0, 1, 0]], "depth": 5.0}
    ideal = vh.press(ball, **place, size=10.0)
    covered = vh.press(ball, **place, size=10.0, scene="fsr400", unit="mm")
    assert covered.images.shape == ideal.images.shape
    assert not np.array_equal(covered.images, ideal.images)
    np.testing.assert_array_equal(covered.heights, ideal.heights)
    with pytest.raises(ParameterError, match="unit is None; mm, cm, m, in are allowed"):
        vh.press(ball, **place, size=10.0, scene="fsr400")
    with pytest.raises(ParameterError, match="A scene needs square sensors"):
        vh.press(ball, **place, size=(10.0, 5.0), scene="fsr400", unit="mm")


def test_a_file_too_small_for_a_scale_is_touched_and_has_no_way_back(tmp_path):
    mesh = trimesh.creation.icosphere(2)
    tiny = (mesh.vertices * 1e-320, mesh.faces)
    found = vh.load(tiny)
    assert np.linalg.norm(found.surface.vertices, axis=1).max() == pytest.approx(1)
    with pytest.raises(MeshError, match="so small or large"):
        found.frame.points_in_file([[0, 0, 0]])
    saved = found.touch(1, "random", SMALL).save(tmp_path)
    assert {path.name for path in saved} > {"picture.png", "touches.parquet"}
    assert not (tmp_path / "poses.csv").exists()


def rotated_about(axes, vectors, degrees):
    """Rotate vectors counterclockwise about unit axes by Rodrigues' formula, seen against the axes."""
    angle = np.radians(degrees)[:, None]
    along = axes * (axes * vectors).sum(axis=1, keepdims=True)
    return along + np.cos(angle) * (vectors - along) + np.sin(angle) * np.cross(axes, vectors)


@pytest.mark.parametrize("roll", [90.0, -35.0])
def test_a_roll_turns_the_sensor_counterclockwise_seen_from_outside(roll, tmp_path):
    ball = trimesh.creation.icosphere(2)
    normals = np.array([[0, 0, 1.0], [0, 1, 0], [0.6, 0, 0.8], [-0.48, 0.6, 0.64]])
    plain, turned = (vh.press(ball, normals, normals, 0.2, roll=angle).poses for angle in (0, roll))
    expected = rotated_about(normals, plain[:, :3, 0], np.full(4, roll))
    np.testing.assert_allclose(turned[:, :3, 0], expected, atol=1e-12)
    np.testing.assert_allclose(turned[:, :3, 2], normals, atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(turned[:, :3, :3]), 1, atol=1e-12)
    file = tmp_path / "poses.csv"
    rows = [",".join(map(str, (*normal, *normal, roll))) for normal in normals]
    file.write_text("\n".join(["x,y,z,normal_x,normal_y,normal_z,roll", *rows]))
    np.testing.assert_allclose(read_poses(file), turned, atol=1e-12)


def test_a_sensor_that_is_turned_by_a_quarter_feels_columns_where_rows_were():
    # A ridge along y, right of the sensor's centre: seen from outside, a quarter turn moves it from one edge to another.
    block = trimesh.creation.box((2, 2, 2))
    ridge = trimesh.creation.box((0.08, 2, 0.2))
    ridge.apply_translation([0.35, 0, 1.0])
    body = trimesh.util.concatenate([block, ridge])
    felt = [
        vh.press(
            body, [[0, 0, 1.1]], [[0, 0, 1]], 1.0, resolution=10, depth=0.05, roll=roll
        ).images[0]
        for roll in (0, 90, 180, 270)
    ]
    assert np.flatnonzero(felt[0].all(axis=0)).tolist() == [8]
    # The sensor turns counterclockwise, so that the ridge turns clockwise on the sensor.
    for turns, image in enumerate(felt):
        np.testing.assert_array_equal(image, np.rot90(felt[0], -turns))


def stretched_body():
    """A lopsided octahedron: vertices in a stretched and turned file, faces, and the frame of that file."""
    vertices = np.array(
        [[1.0, 0, 0], [-0.8, 0, 0.1], [0.1, 1.2, 0], [0, -0.9, 0.2], [0, 0.1, 0.7], [0.2, 0, -0.6]]
    )
    faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
    to_file = np.eye(4)
    to_file[:3, :3] = (
        np.diag([3.0, 0.5, 1.5])
        @ Rotation.from_euler("xyz", [20, 40, 60], degrees=True).as_matrix()
    )
    to_file[:3, 3] = [5.0, -2.0, 1.0]
    in_file = vertices @ to_file[:3, :3].T + to_file[:3, 3]
    return vertices, in_file, np.array(faces), vh.FileFrame(np.linalg.inv(to_file))


def triangle_normals(vertices, faces):
    first, second, third = (vertices[faces[:, corner]] for corner in range(3))
    across = np.cross(second - first, third - first)
    return across / np.linalg.norm(across, axis=1, keepdims=True)


def test_normals_of_a_stretched_file_are_those_of_its_own_faces():
    vertices, in_file, faces, frame = stretched_body()
    found = frame.normals_in_file(triangle_normals(vertices, faces))
    np.testing.assert_allclose(found, triangle_normals(in_file, faces), atol=1e-12)


def test_poses_on_a_stretched_file_lie_on_its_faces_along_the_stretched_columns():
    vertices, in_file, faces, frame = stretched_body()
    points = vertices[faces].mean(axis=1)
    normals, edges = (
        triangle_normals(vertices, faces),
        vertices[faces[:, 1]] - vertices[faces[:, 0]],
    )
    tangents = edges / np.linalg.norm(edges, axis=1, keepdims=True)
    rows = {
        name: values
        for names, vectors in (
            (POINT_NAMES, points),
            (NORMAL_NAMES, normals),
            (TANGENT_NAMES, tangents),
        )
        for name, values in zip(names, vectors.T, strict=True)
    }
    touches = pa.table({**rows, "sensor_size": np.full(len(faces), 0.1)})
    poses = frame.poses(touches)
    np.testing.assert_allclose(poses[:, :3, 3], in_file[faces].mean(axis=1), atol=1e-12)
    np.testing.assert_allclose(poses[:, :3, 2], triangle_normals(in_file, faces), atol=1e-12)
    along = in_file[faces[:, 1]] - in_file[faces[:, 0]]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    np.testing.assert_allclose(poses[:, :3, 0], along, atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(poses[:, :3, :3]), 1, atol=1e-12)
    table = frame.table(touches)
    np.testing.assert_allclose(matrix(table, NORMAL_NAMES), poses[:, :3, 2], atol=1e-12)
    np.testing.assert_allclose(matrix(table, TANGENT_NAMES), along, atol=1e-12)
    # The volume of the stretched unit cube is 3 * 0.5 * 1.5.
    np.testing.assert_allclose(table["sensor_size"].to_numpy(), 0.1 * 2.25 ** (1 / 3), atol=1e-12)


def test_the_axis_of_the_file_that_points_up_is_named(touched):
    assert touched[1].frame.up_axis == "z"
    assert vh.load(lying_bottle()).frame.up_axis == "y"


@pytest.mark.parametrize(("up", "front"), [("z", "x"), ("-x", "y"), ("y", "-z")])
def test_poses_come_back_on_the_file_s_mesh_for_any_up_and_front(up, front):
    mesh = trimesh.creation.box((2, 3, 4)).apply_translation((5, -6, 7))
    found = vh.load(mesh, up=up, front=front)
    assert (found.frame.up_axis, found.frame.front_axis) == (up, front)
    # The middle of the face of the box at the front, in the object frame.
    middle = found.surface.vertices[:, 2].max()
    [pose] = found.touch(at=[[0.0, 0.0, middle]], parameters=SMALL).poses
    axis, sign = "xyz".index(front[-1]), -1 if front[0] == "-" else 1
    outward = np.zeros(3)
    outward[axis] = sign
    np.testing.assert_allclose(pose[:3, 2], outward, atol=1e-6)
    np.testing.assert_allclose(
        pose[:3, 3], [5, -6, 7] + outward * mesh.extents[axis] / 2, atol=1e-5
    )
