"""Places that are uniform by area are distinguished from places that are not."""

import numpy as np
import pytest
import trimesh
from numerics.surfaces import of_trimesh

from visuohaptic.fixations.places import draw_by_area
from visuohaptic.guards.areas import LEAST, coordinates, guard_areas

TORUS = of_trimesh(trimesh.creation.torus(0.6, 0.25, 24, 12))
COUNT = 4000


def on_faces(faces, outer, along):
    """Give the coordinates of points by the share of their face that is nearer to its first corner, and along it."""
    weights = np.column_stack([1 - outer, outer * (1 - along), outer * along])
    return coordinates(TORUS, np.einsum("nc,ncd->nd", weights, TORUS.triangles[faces]), faces)


def uniform(generator, count=COUNT):
    drawn = draw_by_area(TORUS, count, generator)
    return coordinates(TORUS, drawn.points, drawn.faces)


def faces_alike(generator):
    faces = generator.integers(0, len(TORUS.faces), COUNT)
    return on_faces(faces, np.sqrt(generator.random(COUNT)), generator.random(COUNT))


def crowded_at_a_corner(generator):
    shares = TORUS.face_areas / TORUS.face_areas.sum()
    faces = generator.choice(len(shares), COUNT, p=shares)
    return on_faces(faces, *generator.random((2, COUNT)))


def in_reach_alone(generator):
    drawn = draw_by_area(TORUS, COUNT, generator)
    kept = drawn.take(np.flatnonzero(np.hypot(drawn.points[:, 0], drawn.points[:, 1]) > 0.6))
    return coordinates(TORUS, kept.points, kept.faces)


@pytest.mark.parametrize("seed", range(5))
def test_draws_by_area_hold(seed):
    assert guard_areas([uniform(np.random.default_rng(seed))]).outcome == "held"


@pytest.mark.parametrize("draw", [faces_alike, crowded_at_a_corner, in_reach_alone])
def test_other_draws_are_found(draw):
    assert guard_areas([draw(np.random.default_rng(0))]).outcome == "failed"


def test_too_few_places_are_not_tested():
    few = uniform(np.random.default_rng(0), LEAST - 1)
    assert [guard_areas(drawn).outcome for drawn in ([few], [])] == ["not tested"] * 2
