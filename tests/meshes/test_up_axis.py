"""Which way is up is what an object stands on."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from numerics.surfaces import build_plain_surface, of_trimesh

import visuohaptic as vh
from visuohaptic.base.errors import MeshError
from visuohaptic.geometry.surface import read_surface
from visuohaptic.meshes.catalogue import Model
from visuohaptic.meshes.files import make_mesh
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.meshes.preparing import prepare_object
from visuohaptic.meshes.up_axis import (
    AXES,
    are_perpendicular,
    named_axis,
    rotation_upright,
    steadiest_axis,
    tipping_angle,
)

Y_OR_Z = {axis: rotation_upright(axis) for axis in "yz"}
Y_TO_Z = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])


def table():
    """A board on four legs, y up."""
    parts = [trimesh.creation.box((2, 0.1, 1))]
    for x, z in itertools.product((-0.9, 0.9), (-0.4, 0.4)):
        parts.append(trimesh.creation.box((0.1, 1, 0.1)).apply_translation((x, -0.5, z)))
    return trimesh.util.concatenate(parts)


def test_an_object_tips_over_its_nearest_edge_and_what_stands_on_a_line_does_not_stand():
    corners = np.asarray(trimesh.creation.box((2, 4, 6)).vertices)
    assert tipping_angle(corners) == pytest.approx(math.atan2(1, 2))
    assert tipping_angle(np.add(corners, [1.5, 0, 0])) == pytest.approx(math.atan2(-0.5, 2))
    assert tipping_angle(np.array([[0, -1.0, 0], [0, -1, 1], [0, 1, 0]])) == 0


def test_a_table_is_found_upright_in_either_axis_and_placed_as_that_axis_does():
    assert steadiest_axis(of_trimesh(table()), Y_OR_Z) == "y"
    turned = of_trimesh(table().apply_transform(Y_TO_Z))
    assert steadiest_axis(turned, Y_OR_Z) == "z"
    found, way = prepare_object(Model("a", "table"), turned, MeshParameters(own_up_axis="auto"))
    named, named_way = prepare_object(Model("a", "table"), turned, MeshParameters(own_up_axis="z"))
    np.testing.assert_array_equal(found.vertices, named.vertices)
    np.testing.assert_array_equal(way, named_way)


def unit(axis):
    return np.eye(3)["xyz".index(axis[-1])] * (-1 if axis[0] == "-" else 1)


@pytest.mark.parametrize("up", AXES)
def test_up_and_front_are_turned_to_y_and_z_by_a_rotation(up):
    for front in AXES:
        if not are_perpendicular(up, front):
            continue
        rotation = rotation_upright(up, front)
        np.testing.assert_array_equal(rotation @ unit(up), [0, 1, 0])
        np.testing.assert_array_equal(rotation @ unit(front), [0, 0, 1])
        np.testing.assert_array_equal(rotation @ rotation.T, np.eye(3))
        assert np.linalg.det(rotation) == pytest.approx(1)
        assert (named_axis(rotation[1]), named_axis(rotation[2])) == (up, front)
        assert not np.signbit(rotation[rotation == 0]).any()


def test_without_a_front_the_rotations_are_those_of_earlier_versions():
    np.testing.assert_array_equal(rotation_upright("y"), np.eye(3))
    np.testing.assert_array_equal(rotation_upright("z"), [[1, 0, 0], [0, 0, 1], [0, -1, 0]])
    np.testing.assert_array_equal(rotation_upright("x"), [[0, -1, 0], [1, 0, 0], [0, 0, 1]])


def test_the_axis_that_stands_is_sought_among_those_perpendicular_to_the_front():
    for front, up in (("y", "z"), ("-z", "y"), ("x", "y"), (None, "y")):
        parameters = MeshParameters(own_up_axis="auto", own_front_axis=front)
        _, way = prepare_object(Model("a", "table"), of_trimesh(table()), parameters)
        assert named_axis(way[1, :3]) == up
        assert front in (None, named_axis(way[2, :3]))


def test_a_front_along_the_axis_that_the_file_states_is_refused():
    tower = replace(of_trimesh(trimesh.creation.box((1, 2, 3))), up_axis="z")
    with pytest.raises(MeshError, match="has up axis z, and the front axis is -z; perpendicular"):
        prepare_object(Model("a", "b"), tower, MeshParameters(own_front_axis="-z"))


@pytest.mark.parametrize("axis", "xyz")
def test_the_file_says_which_axis_points_up_unless_the_user_does(axis):
    tower = replace(of_trimesh(trimesh.creation.box((1, 2, 3))), up_axis=axis)
    for asked, taken in (("file", axis), ("y", "y"), ("z", "z")):
        made, way = prepare_object(Model("a", "b"), tower, MeshParameters(own_up_axis=asked))
        assert np.abs(way[1, :3]).argmax() == "xyz".index(taken)
        assert (made.notes, made.up_axis) == ((), None)


def test_a_model_that_hardly_stands_is_said_to_be_taken_as_y_up_where_nobody_says():
    lying = of_trimesh(trimesh.creation.cone(1, 2))
    for surface, asked, count in (
        (lying, "file", 1),
        (lying, "y", 0),
        (replace(lying, up_axis="y"), "file", 0),
        (of_trimesh(table()), "file", 0),
    ):
        made, way = prepare_object(Model("a", "b"), surface, MeshParameters(own_up_axis=asked))
        assert np.abs(way[1, :3]).argmax() == 1
        assert ["taken as y-up" in note for note in made.notes] == [True] * count


def test_a_run_turns_an_own_model_as_load_does(tmp_path):
    table().export(tmp_path / "table.stl")
    axes = MeshParameters(own_up_axis="x", own_front_axis="-y")
    make_mesh("a/table", None, tmp_path / "table.stl", tmp_path / "made.ply", axes)
    loaded = vh.load(tmp_path / "table.stl", up="x", front="-y")
    np.testing.assert_array_equal(
        read_surface(tmp_path / "made.ply").vertices, loaded.surface.vertices
    )


def test_a_surface_without_area_is_refused_as_always():
    flat = build_plain_surface(np.zeros((3, 3)), [[0, 1, 2]])
    with pytest.raises(MeshError):
        prepare_object(Model("a", "flat"), flat, MeshParameters(own_up_axis="auto"))
