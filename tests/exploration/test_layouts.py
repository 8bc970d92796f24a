"""Layouts in `press`, and in touches of an object."""

import numpy as np
import pytest
import trimesh

import visuohaptic as vh
from visuohaptic.base.errors import LayoutWarning, ParameterError
from visuohaptic.geometry.layouts import grid_layout
from visuohaptic.geometry.pads import layout_of

BALL = trimesh.creation.icosphere(5, radius=40.0)
TOP = {"points": [[0, 0, 40.0]], "normals": [[0, 0, 1.0]]}
IN_A_RUN = {
    "features.descriptor": "image_statistics",
    "viewpoints.count": 2,
    "attention.fixations": 2,
}


def test_a_grid_given_as_taxels_reads_what_the_grid_reads_bit_for_bit():
    grid = grid_layout(16, 16)
    own = vh.Layout.of(grid.positions, grid.directions, half_width=1.0)
    square = vh.press(BALL, **TOP, size=12.0, resolution=16)
    felt = vh.press(BALL, **TOP, size=12.0, layout=own)
    for one, other in ((felt.images, square.images), (felt.heights, square.heights)):
        np.testing.assert_array_equal(one, other.reshape(1, 256))
    np.testing.assert_array_equal(felt.points, square.points.reshape(1, 256, 3))
    named = vh.press(BALL, **TOP, size=12.0, resolution=16, layout="square")
    np.testing.assert_array_equal(named.heights, square.heights)


def test_a_pad_has_its_own_width_in_the_unit_of_the_mesh():
    own = vh.press(BALL, **TOP, layout="dome", unit="mm")
    np.testing.assert_allclose(own.sizes, 40.0)
    sized = vh.press(BALL, **TOP, layout="dome", size=40.0)
    np.testing.assert_allclose(own.heights, sized.heights, rtol=1e-12)
    centimetres = vh.press((BALL.vertices / 10, BALL.faces), [[0, 0, 4.0]], [[0, 0, 1]], layout="dome", unit="cm")  # fmt: skip
    np.testing.assert_allclose(centimetres.images, own.images, atol=1e-6)


def test_surface_points_of_a_curved_pad_lie_on_the_object():
    felt = vh.press(BALL, **TOP, layout="finger", size=20.0)
    met = np.isfinite(felt.heights)
    assert met.any()
    np.testing.assert_allclose(np.linalg.norm(felt.points[met], axis=1), 40.0, rtol=2e-3)
    assert np.isnan(felt.points[~met]).all()


def test_a_turned_object_and_pose_give_the_same_readings():
    turn = trimesh.transformations.random_rotation_matrix(np.array([0.2, 0.5, 0.8]))
    turned = BALL.copy()
    turned.apply_transform(turn)
    pose = np.eye(4)
    pose[:3, 3] = [3.0, -2.0, 39.5]
    for name in ("round", "dome", "finger", "gripper"):
        felt = [
            vh.press(mesh, poses=[at], layout=name, size=20.0).heights
            for mesh, at in ((BALL, pose), (turned, turn @ pose))
        ]
        np.testing.assert_allclose(*felt, atol=1e-10)


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"layout": "dome"}, "Layout dome has real lengths and unit is None; .* or a size is needed"),
        ({"layout": vh.Layout.of([[1, 0, 0]], [[0, 0, -1]])}, "size is missing"),
        ({"layout": "dome", "size": (2.0, 3.0)}, "a layout needs one width"),
        ({"layout": 3, "size": 2.0}, "layout is of type int; a Layout, a name or a CSV file"),
        ({"layout": "none.csv", "size": 2.0}, r"none\.csv can't be read"),
        (
            {"layout": "dome", "size": 2.0, "scene": "fsr400", "unit": "mm"},
            "scene.readout is grounded, which needs a square grid .* scene.readout: ideal works",
        ),
        (
            {"layout": "dome", "size": 2.0, "points": np.zeros((600_000, 3)), "normals": np.ones((600_000, 3))},
            "600000 sensors of 127 taxels have 76200000 sensing points",
        ),
    ],
)  # fmt: skip
def test_a_layout_that_is_not_allowed_is_refused_in_a_sentence(options, says):
    with pytest.raises(ParameterError, match=says):
        vh.press(BALL, **{**TOP, **options})


def test_a_pad_wider_than_the_object_is_said_once_a_call():
    with pytest.warns(LayoutWarning, match="are 200 wide, and the object is 80 wide") as said:
        vh.press(BALL, [[0, 0, 40.0]] * 3, [[0, 0, 1.0]] * 3, layout="round", size=200.0)
    assert len(said) == 1


def test_pictures_of_pads_show_contact_where_the_taxel_is():
    felt = vh.press(BALL, [[0, 0, 39.0]], [[0, 0, 1.0]], layout="dome", unit="mm")
    grey = np.asarray(felt.picture())
    middle, rim = grey[grey.shape[0] // 2, grey.shape[1] // 2], grey[grey.shape[0] // 2, 20]
    assert middle == 255
    assert rim < 128
    coloured = np.asarray(felt.layout_picture())
    assert tuple(coloured[22 + 120, 120]) == (253, 231, 37)
    assert "1 imprints of 127 taxels, 1 of which" in repr(felt)


@pytest.mark.parametrize("layout", ["round", "dome", "finger", "gripper", "a file"])
def test_an_object_is_touched_described_and_drawn_with_any_layout(layout, tmp_path):
    count = len(layout_of("round" if layout == "a file" else layout, 2))
    if layout == "a file":
        pad = layout_of("round", 2)
        rows = np.concatenate([pad.positions, pad.directions], axis=1)
        layout = str(tmp_path / "pad.csv")
        header = "x,y,z,direction_x,direction_y,direction_z"
        np.savetxt(layout, rows, delimiter=",", header=header, comments="")
    felt = vh.example("chair").touch(parameters={"sensor.layout": layout, **IN_A_RUN})
    assert felt.imprints.shape == (4, count)
    # On a wall a gripper stands on its tips, and nothing is between its pads.
    assert felt.imprints.any() or layout == "gripper"
    statistics = [name for name in felt.features.column_names if name.startswith("imprint_")]
    assert np.isfinite(felt.features.select(statistics).to_pandas().to_numpy()).all()
    assert felt.picture().size[0] > 300
    assert "<svg" in felt._repr_html_() or "<img" in felt._repr_html_()


def test_touches_at_given_points_and_one_more_take_a_layout():
    chair = vh.example("chair")
    parameters = {"sensor.layout": "dome", "features.descriptor": "image_statistics"}
    felt = chair.touch(at=[[0.1, -0.1, 0.4]], parameters=parameters)
    more, one = felt.touch_next([-0.2, 0.3, -0.2])
    assert one.imprint.shape == (127,)
    np.testing.assert_array_equal(more.imprints[1], one.imprint)


def test_a_descriptor_of_images_is_refused_for_taxels_in_a_sentence():
    with pytest.raises(ParameterError, match="descriptor is contourlet, which needs a square grid"):
        vh.example("chair").touch(parameters={**IN_A_RUN, "sensor.layout": "dome", "features.descriptor": "contourlet"})  # fmt: skip
