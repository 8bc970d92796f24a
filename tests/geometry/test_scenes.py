"""Open3D and embreex give the same bits on hard surfaces but at corners and edges, and one of them is enough."""

import numpy as np
import pytest
from numerics.surfaces import random_vectors
from sensor.shapes import box, joined, sheet, surface_of
from trimesh.creation import icosphere

from visuohaptic.base.errors import MissingPackageError
from visuohaptic.geometry import raycasting, scenes
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.subject import Subject
from visuohaptic.parameters import as_parameters
from visuohaptic.pipeline import run

BALL = icosphere(3)
AT_CORNERS_AND_EDGES = 2000
"""Rays of `rays` that aim exactly at a corner or an edge; all others aim anywhere."""
NARROW = np.array([[1.2, -1, 0.1], [1.2, 1, 0.1], [1.2, 0, 0.1 + 1e-7]])
# Faces on one another, a face as narrow as float32's errors, and an open sheet within a closed solid.
SURFACES = {
    "ball": surface_of(BALL.vertices, BALL.faces),
    "doubled": surface_of(BALL.vertices, np.concatenate([BALL.faces, BALL.faces[::-1]])),
    "narrow": joined(surface_of(BALL.vertices, BALL.faces), surface_of(NARROW, [[0, 1, 2]])),
    "gap": joined(
        box((-0.5, -0.5, -0.5), (0.5, 0.5, 0.4)), sheet(lambda x, z: 0.6 + 0.1 * x * z, cells=20)
    ),
}


@pytest.fixture(scope="module")
def rays():
    generator = np.random.default_rng(5)
    origins = random_vectors(generator, 3000, 2.5)
    # A third each through vertices, through edges, and anywhere, of which some meet the narrow face.
    targets = generator.uniform(-1, 1, (3000, 3))
    count = AT_CORNERS_AND_EDGES
    corners = BALL.triangles[generator.integers(0, len(BALL.faces), count)]
    share = np.where(np.arange(count) < 1000, 0, generator.random(count))[:, None]
    targets[:count] = corners[:, 0] * (1 - share) + corners[:, 1] * share
    targets[2800:] = generator.dirichlet(np.ones(3), 200) @ NARROW
    return origins, targets - origins


def both(surface):
    return [RayCaster(surface, package) for package in scenes.SCENES]


@pytest.mark.parametrize("surface", SURFACES.values(), ids=SURFACES)
def test_rays_first_meet_the_same_faces_at_the_same_bits(surface, rays):
    first, second = (caster.first_hits(*rays) for caster in both(surface))
    assert first.hit.any()
    same = (first.face == second.face) & (first.distance == second.distance)
    assert same[AT_CORNERS_AND_EDGES:].all()
    # Embree is not watertight there, and with AVX2 embreex rounds otherwise than Open3D (docs/decisions.md).
    assert same[:AT_CORNERS_AND_EDGES].mean() > 0.97


@pytest.mark.parametrize("surface", SURFACES.values(), ids=SURFACES)
def test_points_lie_in_solids_or_not_and_nearest_to_the_same_places(surface, rays):
    points, directions = 0.3 * rays[0][2000:2200], rays[1][2000:2200]
    first, second = (caster.winding_numbers(points, directions) for caster in both(surface))
    # Of faces that lie on each other Open3D counts one.
    assert np.array_equal(first != 0, second != 0)
    (near, _), (also_near, _) = (caster.nearest(points) for caster in both(surface))
    np.testing.assert_allclose(near, also_near, rtol=0, atol=1e-6)


def test_nothing_is_asked_of_no_rays_and_no_points():
    nothing = np.zeros((0, 3))
    for caster in both(SURFACES["narrow"]):
        assert len(caster.first_hits(nothing, nothing).face) == 0
        assert len(caster.winding_numbers(nothing, nothing)) == 0
        assert len(caster.nearest(nothing)[0]) == 0


def test_an_object_is_touched_at_the_same_bits(monkeypatch):
    parameters = as_parameters({"viewpoints.count": 2, "rendering.resolution": 64})
    found = []
    for package in scenes.SCENES:
        monkeypatch.setattr(raycasting, "installed_package", lambda package=package: package)
        subject = Subject("box/lid", lambda: RayCaster(SURFACES["gap"]), range(2))
        found.append(run(subject, parameters))
    first, second = found
    assert first["features"].num_rows
    assert all(first[name].equals(second[name]) for name in first)


def test_open3d_casts_where_it_is_installed_and_none_is_refused_in_a_sentence(monkeypatch):
    installed = {"embreex", "open3d"}
    monkeypatch.setattr(scenes, "find_spec", lambda name: name if name in installed else None)
    assert scenes.installed_package() == "open3d"
    installed.remove("open3d")
    assert scenes.installed_package() == "embreex"
    installed.clear()
    with pytest.raises(MissingPackageError, match="Neither open3d nor embreex is installed"):
        scenes.installed_package()
