"""Places that are uniform by area are distinguished from places that are not."""

import numpy as np
import pytest
import trimesh
from numerics.surfaces import of_trimesh

from visuohaptic.fixations.places import draw_by_area
from visuohaptic.guards.areas import LEAST, coordinates, guard_areas

TORUS = of_trimesh(trimesh.creation.torus(0.6, 0.25, 24, 12))
COUNT = 4000


def places_of(faces, weights):
    return coordinates(TORUS, np.einsum("nc,ncd->nd", weights, TORUS.triangles[faces]), faces)


def uniform(generator, count=COUNT):
    drawn = draw_by_area(TORUS, count, generator)
    return coordinates(TORUS, drawn.points, drawn.faces)


def within(generator, count=COUNT):
    outer, along = np.sqrt(generator.random(count)), generator.random(count)
    return np.column_stack([1 - outer, outer * (1 - along), outer * along])


@pytest.mark.parametrize("seed", range(5))
def test_draws_by_area_hold(seed):
    assert guard_areas([uniform(np.random.default_rng(seed))]).outcome == "held"


def test_faces_that_are_drawn_alike_are_found():
    generator = np.random.default_rng(0)
    faces = generator.integers(0, len(TORUS.faces), COUNT)
    assert guard_areas([places_of(faces, within(generator))]).outcome == "failed"


def test_points_that_crowd_at_a_corner_of_their_face_are_found():
    generator = np.random.default_rng(0)
    areas = TORUS.face_areas / TORUS.face_areas.sum()
    faces = generator.choice(len(areas), COUNT, p=areas)
    outer, along = generator.random((2, COUNT))
    crowded = np.column_stack([1 - outer, outer * (1 - along), outer * along])
    assert guard_areas([places_of(faces, crowded)]).outcome == "failed"


def test_places_in_reach_alone_are_found():
    generator = np.random.default_rng(0)
    drawn = draw_by_area(TORUS, COUNT, generator)
    outside = np.flatnonzero(np.hypot(drawn.points[:, 0], drawn.points[:, 1]) > 0.6)
    kept = drawn.take(outside)
    assert guard_areas([coordinates(TORUS, kept.points, kept.faces)]).outcome == "failed"


def test_too_few_places_are_not_tested():
    generator = np.random.default_rng(0)
    assert guard_areas([uniform(generator, LEAST - 1)]).outcome == "not tested"
    assert guard_areas([]).outcome == "not tested"


def test_the_three_coordinates_are_shares_of_area():
    corners = TORUS.triangles[[0, 5]]
    middles = 0.5 * (corners[:, 1] + corners[:, 2])
    found = coordinates(TORUS, middles, np.array([0, 5]))
    np.testing.assert_allclose(found[:, 1], 1)
    np.testing.assert_allclose(found[:, 2], 0.5)
