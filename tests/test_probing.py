"""Random probing is uniform over the surface, by area, and repeatable."""

import numpy as np
import pytest
import trimesh

from visuohaptic.probing import draw_by_area
from visuohaptic.surface import Surface


def surface_of(mesh):
    faces = np.asarray(mesh.faces, dtype=np.int64)
    return Surface(np.asarray(mesh.vertices), faces, np.zeros((len(faces), 3), np.uint8))


@pytest.fixture(scope="module")
def uneven():
    """A box with one face cut into many triangles, so that counts of faces mislead."""
    box = trimesh.creation.box((1, 2, 3))
    return surface_of(box.subdivide(face_index=[0, 1]).subdivide(face_index=[0, 1, 2, 3]))


def test_points_fall_on_faces_by_their_area(uneven):
    drawn = draw_by_area(uneven, 200_000, np.random.default_rng(0))
    shares = np.bincount(drawn.faces, minlength=len(uneven.faces)) / 200_000
    expected = uneven.face_areas / uneven.face_areas.sum()
    # Five standard deviations of a binomial share.
    assert (np.abs(shares - expected) <= 5 * np.sqrt(expected * (1 - expected) / 200_000)).all()


def test_points_are_uniform_within_a_triangle():
    triangle = Surface(
        np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]),
        np.array([[0, 1, 2]]),
        np.zeros((1, 3), np.uint8),
    )
    points = draw_by_area(triangle, 100_000, np.random.default_rng(1)).points
    np.testing.assert_allclose(points.mean(axis=0), [1 / 3, 1 / 3, 0], atol=0.005)
    # A quarter of the area lies in the triangle that is cut off at each corner.
    assert abs((points[:, 0] > 0.5).mean() - 0.25) < 0.007
    assert abs((points[:, 1] > 0.5).mean() - 0.25) < 0.007
    assert abs((points[:, 0] + points[:, 1] < 0.5).mean() - 0.25) < 0.007


def test_points_lie_on_their_faces_with_unit_normals(uneven):
    drawn = draw_by_area(uneven, 1000, np.random.default_rng(2))
    corners = uneven.triangles[drawn.faces]
    offsets = np.einsum("nk,nk->n", drawn.points - corners[:, 0], drawn.normals)
    np.testing.assert_allclose(offsets, 0, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(drawn.normals, axis=1), 1)


def test_the_same_generator_draws_the_same_points(uneven):
    one = draw_by_area(uneven, 5, np.random.default_rng(3))
    two = draw_by_area(uneven, 5, np.random.default_rng(3))
    np.testing.assert_array_equal(one.points, two.points)


def test_faces_without_area_are_never_drawn():
    surface = Surface(
        np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0]]),
        np.array([[0, 1, 3], [0, 1, 2], [0, 1, 3]]),
        np.zeros((3, 3), np.uint8),
    )
    assert (draw_by_area(surface, 1000, np.random.default_rng(4)).faces == 1).all()
