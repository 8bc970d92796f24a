"""A random walk stays on the surface, comes everywhere, and is the same however long it is."""

import numpy as np
import pytest
import trimesh
from numerics.surfaces import build_plain_surface, of_trimesh

from visuohaptic.fixations.strategies.random_walk import STEP, walk
from visuohaptic.geometry.raycasting import RayCaster


def caster_of(*meshes):
    return RayCaster(of_trimesh(trimesh.util.concatenate(meshes)))


def walks(caster, count, places):
    found = [walk(caster, places, np.random.default_rng(seed)) for seed in range(count)]
    return tuple(
        np.concatenate([getattr(one, name) for one in found])
        for name in ("points", "normals", "faces")
    )


BALL = caster_of(trimesh.creation.icosphere(3, 0.8))
TORUS = caster_of(trimesh.creation.torus(0.6, 0.25))
# Parts that stand in each other, as in models that were made by hand.
CROSS = caster_of(trimesh.creation.box((1.2, 0.3, 0.3)), trimesh.creation.box((0.3, 1.2, 0.3)))
SQUARE = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
SHEET = RayCaster(build_plain_surface(SQUARE, [[0, 1, 2], [0, 2, 3]]))


@pytest.mark.parametrize("caster", [BALL, TORUS, CROSS, SHEET])
def test_places_lie_within_their_faces_with_outward_normals(caster):
    points, normals, faces = walks(caster, 4, 20)
    assert len(points) == 80
    nearest, _ = caster.nearest(points)
    np.testing.assert_allclose(points, nearest, atol=1e-5)
    flat = caster.surface.face_normals[faces]
    corners = caster.surface.triangles[faces]
    np.testing.assert_allclose(np.einsum("nk,nk->n", points - corners[:, 0], flat), 0, atol=1e-9)
    np.testing.assert_allclose(np.abs(np.einsum("nk,nk->n", normals, flat)), 1, atol=1e-9)
    assert not caster.first_hits(points + 1e-4 * normals, normals).hit.any()


def test_fewer_places_are_the_first_of_more_and_chance_repeats():
    few, many, again = (walk(TORUS, count, np.random.default_rng(5)) for count in (5, 21, 21))
    np.testing.assert_array_equal(few.points, many.points[:5])
    np.testing.assert_array_equal(again.points, many.points)
    other = walk(TORUS, 5, np.random.default_rng(6))
    assert not np.isin(other.points, many.points).any()


def test_a_step_has_its_length_along_a_flat_and_along_a_round_surface():
    flat = caster_of(trimesh.creation.box((40.0, 40.0, 40.0)))
    found = walk(flat, 200, np.random.default_rng(0))
    same = (found.normals[1:] == found.normals[:-1]).all(axis=1)
    steps = np.linalg.norm(np.diff(found.points, axis=0), axis=1)[same]
    assert len(steps) > 150
    np.testing.assert_allclose(steps, STEP, rtol=1e-6)
    ball = caster_of(trimesh.creation.icosphere(5, 1.0))
    points = walk(ball, 100, np.random.default_rng(1)).points
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    arcs = np.arccos(np.sum(points[1:] * points[:-1], axis=1))
    np.testing.assert_allclose(arcs, STEP, rtol=0.01)


def test_a_walk_turns_over_an_edge_and_climbs_a_wall():
    """From the floor of a step to its top and down the side of the slab, none is left out."""
    slab = trimesh.creation.box(bounds=[[-1, -1, -0.3], [1, 1, 0]])
    wall = trimesh.creation.box(bounds=[[0, -1, 0], [1, 1, 0.4]])
    normals = walks(caster_of(slab, wall), 6, 80)[1]
    sides = {tuple(np.rint(normal).astype(int)) for normal in normals}
    assert {(0, 0, 1), (-1, 0, 0), (1, 0, 0), (0, 0, -1), (0, 1, 0), (0, -1, 0)} <= sides


@pytest.mark.slow
def test_a_long_walk_comes_everywhere_by_area():
    """Eighths of a ball, by the signs of the coordinates, are equal."""
    points, _, _ = walks(BALL, 12, 300)
    shares = np.bincount((points > 0) @ [1, 2, 4], minlength=8) / len(points)
    # Places in a row are near each other: some 3,600 count for about 500 independent ones.
    assert np.abs(shares - 1 / 8).max() < 5 * np.sqrt(1 / 8 * 7 / 8 / 500)


def test_a_walk_never_enters_what_is_closed():
    """A ball within a shell: no way out along the normal leads from it or the shell's inside."""
    inner, shell = trimesh.creation.icosphere(2, 0.3), trimesh.creation.icosphere(3, 0.8)
    points, normals, _ = walks(caster_of(inner, shell), 20, 6)
    assert len(points) == 120
    assert (np.linalg.norm(points, axis=1) > 0.7).all()
    assert (np.sum(points * normals, axis=1) > 0).all()
