import numpy as np
import pytest
import trimesh
from numerics.surfaces import random_vectors
from sensor.shapes import box, joined, sheet, surface_of

from visuohaptic.geometry import raycasting
from visuohaptic.geometry.curvature import unit_vectors
from visuohaptic.geometry.nearest import nearest_on
from visuohaptic.geometry.raycasting import MISS, RayCaster

UP, DOWN = np.array([[0, 1.0, 0], [0, -1, 0]])


def all_of(distances):
    return np.ones(len(distances), dtype=bool)


def test_a_face_without_area_is_harmless_and_a_miss_is_infinitely_far_and_has_no_face():
    surface = surface_of([[0, 0, 0], [1, 0, 0], [0.5, 0, 0], [0, 0, 1]], [[0, 1, 2], [0, 1, 3]])
    hits = RayCaster(surface).first_hits(np.full((2, 3), [0.2, 1, 0.2]), np.array([DOWN, UP]))
    np.testing.assert_array_equal(hits.distance, [1, np.inf])
    np.testing.assert_array_equal(hits.face, [1, MISS])
    np.testing.assert_array_equal(hits.hit, [True, False])


def test_rays_beside_an_edge_that_float32_cannot_tell_apart_are_settled_in_float64():
    step = joined(box((0.1, -0.5, -0.5), (0.5, 0.3, 0.5)), box((-0.5, -0.5, -0.5), (0.1, 0.0, 0.5)))
    beside = 0.1 + np.array([-1e-7, -1e-8, -1e-9, 1e-9, 1e-8, 1e-7])
    expected = np.where(beside < 0.1, 2.0, 1.7)
    origins = np.column_stack([beside, np.full(6, 2.0), np.full(6, 0.0123)])
    directions = np.tile(DOWN, (6, 1))
    caster = RayCaster(step)
    in_float32, _ = caster._cast(origins, directions)
    assert not np.allclose(in_float32.distance, expected)
    found = caster.first_hits(origins, directions).distance
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-14)


def test_suspects_are_cast_again_and_keep_a_true_answer():
    caster = RayCaster(sheet(lambda x, z: 0.1 * x * z, cells=20))
    origins = np.random.default_rng(4).uniform(-0.6, 0.6, (500, 3)) + UP
    directions = np.tile(DOWN, (500, 1))
    plain = caster.first_hits(origins, directions)
    everything = caster.first_hits(origins, directions, all_of)
    np.testing.assert_array_equal(plain.face, everything.face)
    np.testing.assert_array_equal(plain.distance, everything.distance)


def test_a_ray_between_faces_smaller_than_the_search_keeps_its_hit():
    tiny = sheet(lambda x, z: 0 * x, half=2e-6, cells=40)
    hits = RayCaster(tiny).first_hits(np.array([[1e-8, 1.0, 3e-8]]), DOWN[None], all_of)
    assert hits.hit.all()
    assert hits.distance == pytest.approx(1.0, rel=1e-14)


def wires_before_a_wall(generator, count=200):
    """Triangles 1e-9 to 1e-5 high, in all directions, in front of a plane z = -2."""
    middles = generator.uniform(-0.8, 0.8, (count, 3))
    along = random_vectors(generator, count)
    across = unit_vectors(np.cross(along, [0, 0, 1.0]))
    heights = 10 ** generator.uniform(-9, -5, (count, 1))
    corners = [middles - 0.05 * along, middles + 0.05 * along, middles + heights * across]
    wall = 4 * np.array([[-1, -1, -0.5], [1, -1, -0.5], [1, 1, -0.5], [-1, 1, -0.5]])
    return joined(
        surface_of(np.stack(corners, axis=1), np.arange(3 * count)),
        surface_of(wall, [[0, 1, 2], [0, 2, 3]]),
    )


def test_a_ray_is_compared_with_the_narrow_faces_near_it_alone(monkeypatch):
    surface = wires_before_a_wall(np.random.default_rng(6))
    origins = surface.triangles[:-2].mean(axis=1) + np.array([0, 0, 2.0])
    directions = np.tile([0.0, 0, -1], (len(origins), 1))
    compared, original = [], RayCaster._first_of_candidates

    def counting(self, candidates, *rays):
        compared.append(candidates.size)
        return original(self, candidates, *rays)

    caster = RayCaster(surface)
    expected = caster.first_hits(origins, directions)
    assert (expected.face < len(surface.faces) - 2).all()
    monkeypatch.setattr(RayCaster, "_first_of_candidates", counting)
    caster.first_hits(origins, directions)
    assert sum(compared) < 0.1 * len(origins) * (len(surface.faces) - 2)
    monkeypatch.setattr(raycasting, "_MOST_PAIRS", 50)
    found = caster.first_hits(origins, directions)
    np.testing.assert_array_equal(found.distance, expected.distance)
    np.testing.assert_array_equal(found.face, expected.face)


@pytest.mark.parametrize("winding", [1, -1])
def test_winding_numbers_count_the_solids_around_a_point_in_any_direction(winding):
    solids = joined(box((-0.5,) * 3, (0.5,) * 3), box((-0.3,) * 3, (0.8,) * 3))
    caster = RayCaster(surface_of(solids.vertices, solids.faces[:, ::winding]))
    directions = np.random.default_rng(0).normal(size=(200, 3))
    points = {0: (-0.6, 0.1, 0.1), 1: (-0.4, 0.1, 0.1), 2: (0.1, 0.0, 0.2)}
    for count, point in points.items():
        found = caster.winding_numbers(np.tile(point, (200, 1)), directions)
        np.testing.assert_array_equal(found, winding * count)


def test_rays_through_many_narrow_faces_are_compared_with_some_of_these_at_a_time(monkeypatch):
    heights = np.linspace(-0.5, 0.5, 40)
    corners = np.array([(-0.7, 0.0), (0.7, 0.0), (0.7, 1e-7)])
    slivers = [np.column_stack([corners, np.full(3, height)]) for height in heights]
    caster = RayCaster(surface_of(np.concatenate(slivers), np.arange(120).reshape(-1, 3)))
    origins = np.column_stack([np.linspace(-0.6, 0.6, 500), np.zeros(500), np.full(500, 2.0)])
    directions = np.tile([0.0, 0.0, -1.0], (500, 1))
    monkeypatch.setattr(raycasting, "_MOST_PAIRS", 1000)
    parts = [len(rays) for rays, _ in caster._narrow_pairs(origins, directions)]
    assert sum(parts) == 500 * 40
    assert max(parts) <= 1000 + 40


def fan_of_slivers(count=400, width=0.0018, length=1.7):
    """Return a plane fan of faces that are a thousand times as long as they are wide."""
    across = (np.arange(count + 1) - count / 2) * width
    ends = np.column_stack([np.full(count + 1, length), across, np.zeros(count + 1)])
    vertices = np.concatenate([np.zeros((1, 3)), ends]) - [length / 2, 0, 0]
    turn = trimesh.transformations.rotation_matrix(0.7, [0.3, 1.0, 0.2])[:3, :3]
    return surface_of(vertices @ turn.T, [[0, face, face + 1] for face in range(1, count + 1)])


def test_points_on_slivers_are_their_own_nearest_points():
    surface, generator = fan_of_slivers(), np.random.default_rng(5)
    corners = surface.vertices[surface.faces]
    faces = generator.integers(len(corners), size=300)
    points = np.einsum("nk,nkd->nd", generator.dirichlet(np.ones(3), size=300), corners[faces])
    caster = RayCaster(surface)
    in_float32 = nearest_on(corners[caster._scene.nearest_faces(points)], points)
    assert np.linalg.norm(in_float32 - points, axis=1).max() > 1e-4
    locations, found = caster.nearest(points)
    assert np.linalg.norm(locations - points, axis=1).max() < 1e-9
    np.testing.assert_array_equal(nearest_on(corners[found], points), locations)


def test_the_face_found_first_stays_where_a_neighbour_is_as_near():
    surface = surface_of(
        np.array([[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1.0]]), [[0, 2, 1], [0, 3, 2]]
    )
    caster = RayCaster(surface)
    points = np.column_stack([np.linspace(0.1, 0.9, 9), np.full(9, 0.2), np.linspace(0.1, 0.9, 9)])
    locations, faces = caster.nearest(points)
    np.testing.assert_array_equal(faces, caster._scene.nearest_faces(points))
    np.testing.assert_allclose(locations, points * [1, 0, 1], atol=1e-15)
