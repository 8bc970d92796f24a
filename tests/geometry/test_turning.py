"""Objects are turned by rotations that their name, the seed and the draw decide."""

import numpy as np
import pytest
from sensor.shapes import sheet

from visuohaptic.geometry.subject import Subject
from visuohaptic.geometry.surface import Surface, as_stored, read_surface, write_surface
from visuohaptic.geometry.turning import draw_rotation, turn_surface


def drawn(turns, count=400, **changed):
    given = {"seed": 1, "draw": 0, **changed}
    return np.array([draw_rotation(turns, f"cup/{number}", **given) for number in range(count)])


@pytest.mark.parametrize("turns", ["none", "vertical", "any"])
def test_rotations_are_orthogonal_right_handed_and_keep_the_vertical_where_asked(turns):
    found = drawn(turns)
    np.testing.assert_allclose(
        found @ found.transpose(0, 2, 1), np.tile(np.eye(3), (400, 1, 1)), atol=1e-14
    )
    np.testing.assert_allclose(np.linalg.det(found), 1.0, atol=1e-14)
    assert np.array_equal(found[:, 1], np.tile([0.0, 1, 0], (400, 1))) == (turns != "any")


def test_rotations_are_uniform_over_angles_and_over_all_rotations():
    angles = np.arctan2(*drawn("vertical", 4000)[:, 0, [2, 0]].T)
    counts, _ = np.histogram(angles, 8, (-np.pi, np.pi))
    assert np.abs(counts - 500).max() < 100
    # Uniform rotations move any direction to uniform heights, and have a trace whose mean is 0.
    found = drawn("any", 4000)
    for row in range(3):
        counts, _ = np.histogram(found[:, row, 1], 8, (-1, 1))
        assert np.abs(counts - 500).max() < 100
    assert abs(np.trace(found, axis1=1, axis2=2).mean()) < 0.06


@pytest.mark.parametrize("turns", ["vertical", "any"])
def test_object_seed_and_draw_each_give_another_rotation(turns):
    own = draw_rotation(turns, "cup/mug", 1, 0)
    others = [("cup/jug", 1, 0), ("cup/mug", 2, 0), ("cup/mug", 1, 1)]
    assert all(np.abs(draw_rotation(turns, *other) - own).max() > 1e-3 for other in others)
    np.testing.assert_array_equal(draw_rotation(turns, "cup/mug", 1, 0), own)


def test_a_turned_surface_is_rounded_as_its_file_and_loses_faces_without_area():
    surface = as_stored(sheet(lambda x, y: 0.2 * x * y))
    rotation = draw_rotation("any", "cup/mug", 1)
    found = turn_surface(surface, rotation)
    np.testing.assert_allclose(found.vertices, surface.vertices @ rotation.T, atol=1e-6)
    np.testing.assert_array_equal(found.vertices, as_stored(found).vertices)
    np.testing.assert_array_equal(found.faces, surface.faces)
    thin = np.array([[0.0, 0, 0], [1, 0, 0], [0.5, 1e-9, 0]])
    kept = turn_surface(surface_with(surface, thin), rotation)
    assert len(kept.faces) == len(surface.faces)
    assert len(kept.vertices) == len(surface.vertices)


def surface_with(surface, corners):
    """Add a triangle to a surface."""
    first = len(surface.vertices)
    return Surface(
        np.concatenate([surface.vertices, corners]),
        np.concatenate([surface.faces, [[first, first + 1, first + 2]]]),
        np.concatenate([surface.face_colours, surface.face_colours[:1]]),
    )


def test_a_subject_is_turned_beyond_its_file(tmp_path):
    surface, rotation = (
        as_stored(sheet(lambda x, y: 0.2 * x * y)),
        draw_rotation("any", "cup/mug", 1),
    )
    write_surface(surface, tmp_path / "mug.ply")
    turned = Subject.of_mesh("cup/mug", tmp_path / "mug.ply", rotation=rotation).caster.surface
    np.testing.assert_array_equal(turned.vertices, turn_surface(surface, rotation).vertices)
    plain = Subject.of_mesh("cup/mug", tmp_path / "mug.ply").caster.surface
    np.testing.assert_array_equal(plain.vertices, read_surface(tmp_path / "mug.ply").vertices)
