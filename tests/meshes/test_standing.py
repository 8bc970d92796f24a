"""Which way is up is what an object stands on."""

import math

import numpy as np
import pytest
import trimesh
from numerics.surfaces import build_plain_surface, of_trimesh

from visuohaptic.errors import MeshError
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.meshes.preparing import UP_AXES, place_surface
from visuohaptic.meshes.standing import steadiest_axis, tipping_angle

Y_TO_Z = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])


def table():
    """A board on four legs, y up."""
    parts = [
        trimesh.creation.box((2, 0.1, 1), trimesh.transformations.translation_matrix((0, 0, 0)))
    ]
    for x in (-0.9, 0.9):
        for z in (-0.4, 0.4):
            place = trimesh.transformations.translation_matrix((x, -0.5, z))
            parts.append(trimesh.creation.box((0.1, 1, 0.1), place))
    return trimesh.util.concatenate(parts)


def test_a_box_tips_over_its_nearest_edge():
    corners = trimesh.creation.box((2, 4, 6)).vertices
    assert tipping_angle(np.asarray(corners)) == pytest.approx(math.atan2(1, 2))


def test_an_object_whose_centre_is_not_above_its_foot_has_a_negative_angle():
    corners = np.add(trimesh.creation.box((2, 4, 6)).vertices, [1.5, 0, 0])
    assert tipping_angle(corners) == pytest.approx(math.atan2(-0.5, 2))


def test_what_stands_on_a_line_does_not_stand():
    assert tipping_angle(np.array([[0, -1.0, 0], [0, -1, 1], [0, 1, 0]])) == 0


def test_a_table_is_found_upright_in_either_axis():
    upright = table()
    assert steadiest_axis(of_trimesh(upright), UP_AXES) == "y"
    upright.apply_transform(Y_TO_Z)
    assert steadiest_axis(of_trimesh(upright), UP_AXES) == "z"


def test_auto_places_an_object_as_its_axis_does():
    turned = table()
    turned.apply_transform(Y_TO_Z)
    found, way = place_surface(of_trimesh(turned), "table", MeshParameters(own_up_axis="auto"))
    named, named_way = place_surface(of_trimesh(turned), "table", MeshParameters(own_up_axis="z"))
    np.testing.assert_array_equal(found.vertices, named.vertices)
    np.testing.assert_array_equal(way, named_way)


def test_a_surface_without_area_is_refused_as_always():
    flat = build_plain_surface(np.zeros((3, 3)), [[0, 1, 2]])
    with pytest.raises(MeshError):
        place_surface(flat, "flat", MeshParameters(own_up_axis="auto"))
