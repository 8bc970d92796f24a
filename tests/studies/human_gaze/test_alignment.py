import numpy as np
import pytest
import trimesh

from human_gaze.alignment import align, grey_surface, reconstruct
from human_gaze.recordings import GazeError, Recording
from visuohaptic.fixations.places import draw_by_area
from visuohaptic.geometry.raycasting import RayCaster

BOX = trimesh.creation.box(extents=(1.0, 0.6, 0.3)).subdivide().subdivide().subdivide()
SURFACE = grey_surface(np.array(BOX.vertices), np.array(BOX.faces))


def points_on(surface, count, seed=0):
    return draw_by_area(surface, count, np.random.default_rng(seed)).points


@pytest.mark.parametrize("scale", [1.0, 0.01, 250.0])
def test_scale_and_shift_are_found(scale):
    shift = np.array([3.0, -2.0, 0.5])
    points = (SURFACE.vertices - shift) / scale
    found, error = align(points, RayCaster(SURFACE), "box", 0.03)
    np.testing.assert_allclose(found, SURFACE.vertices, atol=1e-6)
    assert error < 1e-6


def test_points_that_leave_out_the_corners_are_brought_closer_than_their_box_does():
    points = points_on(SURFACE, 300)
    points = points[np.linalg.norm(points, axis=1) < 0.45]
    found, _ = align(points, RayCaster(SURFACE), "box", 0.05)
    box = np.linalg.norm(np.ptp(SURFACE.vertices, axis=0)) / np.linalg.norm(np.ptp(points, axis=0))
    off = np.linalg.norm((box - 1) * points, axis=1)
    assert np.percentile(np.linalg.norm(found - points, axis=1), 95) < np.percentile(off, 95) / 2


def test_other_axes_and_points_at_one_place_are_refused():
    points = points_on(SURFACE, 2000)[:, [1, 2, 0]]
    with pytest.raises(GazeError, match=r"box: .* 0\.\d+ .* axes"):
        align(points, RayCaster(SURFACE), "box", 0.03)
    with pytest.raises(GazeError, match="recorded points are equal"):
        align(np.ones((5, 3)), RayCaster(SURFACE), "box", 0.03)


@pytest.mark.slow
def test_a_surface_is_made_from_points_and_normals():
    mesh = trimesh.creation.icosphere(4)
    surface = grey_surface(np.array(mesh.vertices), np.array(mesh.faces))
    ball = draw_by_area(surface, 5000, np.random.default_rng(1))
    recording = Recording("ball", ball.points, ball.normals, np.ones(5000), "")
    made, again = reconstruct(recording), reconstruct(recording)
    assert abs(np.linalg.norm(made.vertices, axis=1) - 1).max() < 0.03
    np.testing.assert_array_equal(made.vertices, again.vertices)


def test_without_mesh_and_normals_there_is_no_surface():
    with pytest.raises(GazeError, match="put the mesh beside it"):
        reconstruct(Recording("ball", np.eye(3), None, np.ones(3), ""))
