"""Probing without the eye: by area, by what is seen, and spread out; repeatable."""

import numpy as np
import pytest
import trimesh
from numerics.surfaces import build_plain_surface, of_trimesh

from visuohaptic.fixations.places import draw_by_area, is_visible
from visuohaptic.fixations.strategies.farthest_point import farthest_order, spread_far
from visuohaptic.fixations.strategies.visible import draw_visible
from visuohaptic.fixations.viewpoints import Camera
from visuohaptic.geometry.raycasting import RayCaster


@pytest.fixture(scope="module")
def uneven():
    """A box with one face cut into many triangles, so that counts of faces mislead."""
    box = trimesh.creation.box((1, 2, 3))
    return of_trimesh(box.subdivide(face_index=[0, 1]).subdivide(face_index=[0, 1, 2, 3]))


def test_points_fall_on_faces_by_their_area(uneven):
    drawn = draw_by_area(uneven, 200_000, np.random.default_rng(0))
    shares = np.bincount(drawn.faces, minlength=len(uneven.faces)) / 200_000
    expected = uneven.face_areas / uneven.face_areas.sum()
    # Five standard deviations of a binomial share.
    assert (np.abs(shares - expected) <= 5 * np.sqrt(expected * (1 - expected) / 200_000)).all()


def test_points_are_uniform_within_a_triangle():
    triangle = build_plain_surface([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    points = draw_by_area(triangle, 100_000, np.random.default_rng(1)).points
    np.testing.assert_allclose(points.mean(axis=0), [1 / 3, 1 / 3, 0], atol=0.005)
    # A quarter of the area lies in the triangle that is cut off at each corner.
    corners = [points[:, 0], points[:, 1], 1 - points[:, 0] - points[:, 1]]
    np.testing.assert_allclose(np.mean(np.array(corners) > 0.5, axis=1), 0.25, atol=0.007)


def test_faces_without_area_are_never_drawn():
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0]]
    surface = build_plain_surface(corners, [[0, 1, 3], [0, 1, 2], [0, 1, 3]])
    assert (draw_by_area(surface, 1000, np.random.default_rng(4)).faces == 1).all()


def camera(azimuth=30.0, elevation=20.0, projection="perspective"):
    return Camera(azimuth, elevation, 3.0, 40.0, projection)


@pytest.fixture(scope="module")
def box():
    return RayCaster(of_trimesh(trimesh.creation.box((1, 1, 1)).subdivide()))


@pytest.mark.parametrize("projection", ["perspective", "orthographic"])
def test_a_box_shows_the_sides_that_face_the_camera(box, projection):
    one = camera(projection=projection)
    drawn = draw_by_area(box.surface, 2000, np.random.default_rng(0))
    towards = one.eye - drawn.points if projection == "perspective" else one.axes[2]
    facing = np.sum(drawn.normals * towards, axis=1) > 0
    np.testing.assert_array_equal(is_visible(box, one, drawn.points), facing)
    assert not is_visible(box, one, np.empty((0, 3))).size


def test_what_stands_in_front_hides_what_is_behind():
    plates = trimesh.util.concatenate(
        [trimesh.creation.box((size, size, 0.02)) for size in (0.2, 1.0)]
    )
    plates.vertices[:8, 2] += 0.5
    caster = RayCaster(of_trimesh(plates))
    points = np.array([[0.0, 0, 0.51], [0, 0, 0.01], [0.4, 0, 0.01]])
    ahead = camera(0.0, 0.0)
    assert is_visible(caster, ahead, points).tolist() == [True, False, True]
    assert is_visible(caster, camera(180.0, 0.0), points).sum() == 0


def test_what_is_outside_the_view_is_not_seen(box):
    points = np.array([[0.0, 0, 0.5], [0.4, 0, 0.5], [0, 0.4, 0.5]])
    for projection in ("perspective", "orthographic"):
        narrow = Camera(0.0, 0.0, 3.0, 5.0, projection)
        assert is_visible(box, narrow, points).tolist() == [True, False, False]


def test_visible_points_are_uniform_over_the_visible_faces(box):
    one = camera(45.0)
    drawn = draw_visible(box, one, 12_000, np.random.default_rng(1))
    seen = (drawn.points >= 0.5 - 1e-9).argmax(axis=1)
    # Three faces of one area are seen, one along each axis, however slanted.
    assert np.abs(np.bincount(seen, minlength=3) / 12_000 - 1 / 3).max() < 0.02
    assert (np.sum(drawn.normals * (one.eye - drawn.points), axis=1) > 0).all()


def test_a_camera_that_sees_nothing_gives_no_point():
    far = build_plain_surface([[9, 0, 0], [9, 0.1, 0], [9, 0, 0.1]], [[0, 1, 2]])
    drawn = draw_visible(RayCaster(far), camera(0.0), 5, np.random.default_rng(4))
    assert drawn.points.shape == (0, 3)


def test_spread_points_cover_a_sphere_more_evenly_than_random_ones():
    sphere = of_trimesh(trimesh.creation.icosphere(4))
    probes = draw_by_area(sphere, 2000, np.random.default_rng(6)).points

    def radius(points):
        return np.linalg.norm(probes[:, None] - points, axis=2).min(axis=1).max()

    spread = spread_far(sphere, 12, np.random.default_rng(7))
    random = [
        radius(draw_by_area(sphere, 12, np.random.default_rng(seed)).points) for seed in range(20)
    ]
    # Twelve caps can't cover a sphere with less than 37.4 degrees; greedy takes at most twice that.
    assert radius(spread.points) < min(random)
    assert radius(spread.points) <= 2 * 2 * np.sin(np.radians(37.4 / 2))


def test_the_farthest_point_comes_next_and_none_twice_even_where_all_are_equal():
    points = np.array([[0.0], [1.0], [10.0], [6.0]])
    assert farthest_order(points, 3).tolist() == [0, 2, 3]
    assert sorted(farthest_order(np.zeros((4, 3)), 9)) == [0, 1, 2, 3]
