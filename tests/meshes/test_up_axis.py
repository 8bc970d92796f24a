"""Which way is up is what an object stands on."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from numerics.surfaces import build_plain_surface, of_trimesh

from visuohaptic.base.errors import MeshError
from visuohaptic.meshes.catalogue import Model
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.meshes.preparing import UP_AXES, prepare_with_matrix
from visuohaptic.meshes.up_axis import steadiest_axis, tipping_angle

Y_OR_Z = {axis: UP_AXES[axis] for axis in "yz"}
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
    found, way = prepare_with_matrix(
        Model("a", "table"), turned, MeshParameters(own_up_axis="auto")
    )
    named, named_way = prepare_with_matrix(
        Model("a", "table"), turned, MeshParameters(own_up_axis="z")
    )
    np.testing.assert_array_equal(found.vertices, named.vertices)
    np.testing.assert_array_equal(way, named_way)


def test_every_axis_is_turned_to_y_by_a_rotation():
    for axis, rotation in UP_AXES.items():
        np.testing.assert_array_equal(rotation @ np.eye(3)["xyz".index(axis)], [0, 1, 0])
        np.testing.assert_array_equal(rotation @ rotation.T, np.eye(3))
        assert np.linalg.det(rotation) == pytest.approx(1)


@pytest.mark.parametrize("axis", "xyz")
def test_the_file_says_which_axis_points_up_unless_the_user_does(axis):
    tower = replace(of_trimesh(trimesh.creation.box((1, 2, 3))), up_axis=axis)
    for asked, taken in (("file", axis), ("y", "y"), ("z", "z")):
        made, way = prepare_with_matrix(Model("a", "b"), tower, MeshParameters(own_up_axis=asked))
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
        made, way = prepare_with_matrix(Model("a", "b"), surface, MeshParameters(own_up_axis=asked))
        assert np.abs(way[1, :3]).argmax() == 1
        assert ["taken as y-up" in note for note in made.notes] == [True] * count


def test_a_surface_without_area_is_refused_as_always():
    flat = build_plain_surface(np.zeros((3, 3)), [[0, 1, 2]])
    with pytest.raises(MeshError):
        prepare_with_matrix(Model("a", "flat"), flat, MeshParameters(own_up_axis="auto"))
