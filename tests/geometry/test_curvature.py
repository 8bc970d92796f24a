from itertools import pairwise

import numpy as np
import pytest
import trimesh
from numerics.surfaces import of_trimesh
from sensor.shapes import sheet, surface_of

from visuohaptic.geometry.curvature import measure_shape, unit_vectors


def samples(surface, per_face=4):
    faces = np.repeat(np.arange(len(surface.faces)), per_face)
    return faces, np.random.default_rng(0).dirichlet([1.0, 1.0, 1.0], size=len(faces))


def integral(surface, shape, per_face=4000):
    """Integrate the curvedness over the surface by sampling each face alike."""
    values = shape.curvature(*samples(surface, per_face)).reshape(-1, per_face).mean(axis=1)
    return float(values @ surface.face_areas)


def points_of(surface, faces, weights):
    return np.einsum("nk,nkd->nd", weights, surface.triangles[faces])


def test_sphere_has_one_over_its_radius():
    surface = of_trimesh(trimesh.creation.icosphere(subdivisions=4, radius=0.25))
    shape = measure_shape(surface)
    places = samples(surface)
    np.testing.assert_allclose(shape.curvature(*places), 4, rtol=0.02)
    outwards = unit_vectors(points_of(surface, *places))
    assert np.einsum("nd,nd->n", shape.normals(*places), outwards).min() > 0.9999


def test_cylinder_has_the_curvedness_of_one_bent_direction():
    surface = of_trimesh(trimesh.creation.cylinder(radius=0.5, height=1.0, sections=64))
    side = np.abs(surface.face_normals[:, 2]) < 0.5
    faces, weights = samples(surface)
    inner = side[faces] & (np.abs(points_of(surface, faces, weights)[:, 2]) < 0.4)
    found = measure_shape(surface).curvature(faces, weights)[inner]
    np.testing.assert_allclose(found, np.sqrt(0.5) / 0.5, rtol=0.02)


def test_box_is_flat_off_its_edges_whatever_its_triangles():
    surface = of_trimesh(trimesh.creation.box(extents=(1.0, 0.8, 0.6)))
    shape = measure_shape(surface, crease_width=0.03)
    places = samples(surface, 400)
    gap = np.sort([0.5, 0.4, 0.3] - np.abs(points_of(surface, *places)), axis=1)[:, 1]
    curvature = shape.curvature(*places)
    assert curvature[gap > 0.031].max() < 1e-9
    assert curvature[gap < 0.02].min() > 1.0
    assert np.abs(shape.normals(*places)).max(axis=1).min() > 1 - 1e-12


@pytest.mark.parametrize("subdivisions", [0, 2, 4])
@pytest.mark.parametrize("width", [0.01, 0.05])
def test_fold_holds_the_curvature_of_its_angle(subdivisions, width):
    mesh = trimesh.creation.box(extents=(1.0, 1.0, 1.0))
    for _ in range(subdivisions):
        mesh = mesh.subdivide()
    surface = of_trimesh(mesh)
    # The normal cycle's mean curvature: half the angle for each unit of length.
    expected = 0.5 * (np.pi / 2) * 12.0
    found = integral(surface, measure_shape(surface, crease_width=width), 6000 // 4**subdivisions)
    assert found == pytest.approx(expected, rel=0.05)


def test_windings_and_split_vertices_do_not_matter():
    plain = of_trimesh(trimesh.creation.icosphere(subdivisions=3, radius=0.7))
    flip = np.random.default_rng(2).random(len(plain.faces)) < 0.5
    mixed = np.where(flip[:, None], plain.faces[:, ::-1], plain.faces)
    torn = surface_of(plain.vertices[mixed], np.arange(mixed.size))
    faces, weights = samples(plain)
    swapped = np.where(flip[faces, None], weights[:, ::-1], weights)
    one, two = measure_shape(plain), measure_shape(torn)
    found, expected = two.curvature(faces, swapped), one.curvature(faces, weights)
    np.testing.assert_allclose(found, expected, atol=1e-9)
    side = np.where(flip[faces], -1.0, 1.0)[:, None]
    found, expected = side * two.normals(faces, swapped), one.normals(faces, weights)
    np.testing.assert_allclose(found, expected, atol=1e-9)


def test_open_sheet_has_no_curvature_at_its_rim():
    flat = sheet(lambda x, z: 0 * x, cells=4)
    assert measure_shape(flat).curvature(*samples(flat)).max() == 0.0


def test_degenerate_faces_and_one_sided_strips_give_finite_numbers():
    turns = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    across = np.array([[-0.2], [0.2]])
    wide, height = 1 + across * np.cos(turns / 2), across * np.sin(turns / 2)
    rims = np.stack([wide * np.cos(turns), wide * np.sin(turns), height], axis=2)
    # After one turn the lower rim has become the upper one.
    low, high = np.arange(40), np.arange(40, 80)
    next_low, next_high = np.append(low[1:], 40), np.append(high[1:], 0)
    faces = [np.stack([low, high, next_low], 1), np.stack([high, next_high, next_low], 1)]
    strip = surface_of(0.8 * rims, np.concatenate([*faces, [[0, 0, 1], [3, 3, 3]]]))
    shape = measure_shape(strip)
    assert np.isfinite(shape.curvature(*samples(strip))).all()
    assert np.isfinite(shape.normals(*samples(strip))).all()


def test_spike_keeps_its_normals_outwards():
    cone = of_trimesh(trimesh.creation.cone(radius=0.1, height=1.0, sections=24))
    places = samples(cone)
    normals, flat = measure_shape(cone).normals(*places), cone.face_normals[places[0]]
    assert np.einsum("nd,nd->n", normals, flat).min() > 0.0


OFFSETS = [(0.0, 0.0, 3e-8), (0.0, 0.0, -3e-8), (0.0, 2e-8, -4e-8), (0.0, -3e-8, 1e-8)]


def roof(middle, *, slivers):
    """Two slopes that meet along the x axis; the second is cut at points of the ridge, with slivers between both."""
    ends = np.array([[0.0, 0, 0], [1, 0, 0], [0.5, 1, -1], [0.5, -1, -1]])
    points = np.concatenate([ends, middle])
    ridge = [0, *range(4, 4 + len(middle)), 1]
    cut = [[end, start, 3] for start, end in pairwise(ridge)]
    # Each sliver has the ridge from a point to the far end as its longest edge, beside the sliver before.
    thin = [[start, 1, end] for start, end in pairwise(ridge[:-1])]
    return surface_of(points, np.array([[0, 1, 2], *cut, *(thin if slivers else [])]))


@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize("count", [1, 3])
def test_slivers_on_a_fold_change_no_normal_and_no_curvature(offset, count):
    along = np.linspace(0, 1, count + 2)[1:-1, None] * [1.0, 0, 0]
    plain, cut = roof(along[:0], slivers=False), roof(along + offset, slivers=True)
    whole, found = measure_shape(plain), measure_shape(cut)
    weights = np.random.default_rng(0).dirichlet([1.0, 1.0, 1.0], size=400)
    first = np.zeros(400, dtype=np.int64)
    np.testing.assert_allclose(
        found.curvature(first, weights), whole.curvature(first, weights), atol=1e-5
    )
    np.testing.assert_allclose(
        found.normals(first, weights), whole.normals(first, weights), atol=1e-6
    )


def test_a_sliver_among_slivers_has_no_normal_and_no_curvature():
    shape = measure_shape(
        surface_of([[0.0, 0, 0], [1, 0, 0], [0.5, 1e-8, 0]], np.array([[0, 1, 2]]))
    )
    assert not shape.corner_normals.any()
    assert not shape.curvature(np.zeros(1, dtype=np.int64), np.full((1, 3), 1 / 3)).any()
