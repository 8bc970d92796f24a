"""Polygons are cut into triangles that cover them and no more, whatever their first corner."""

import io
from collections import Counter

import numpy as np
import pytest
from mesh_files import generated

import meshreaders
from meshreaders import polygons
from meshreaders.formats.scenes import fan_faces

PENTAGON = np.array([[0.0, 0], [4, 0], [4, 4], [2, 1], [0, 4]])
FLAT = np.column_stack([PENTAGON, np.zeros(5)])


def cut(points, first=0):
    points = np.asarray(points, dtype=np.float64)
    ring = np.roll(np.arange(len(points)), -first)
    found = polygons.cuts(points, ring, np.array([len(points)]))
    return {place: ring[triangles] for place, triangles in found.items()}


def area_vectors(points, triangles):
    first, second, third = np.asarray(points, dtype=np.float64)[triangles].transpose(1, 0, 2)
    return 0.5 * np.cross(second - first, third - first)


def test_a_convex_polygon_is_left_to_the_reader():
    angles = np.linspace(0, 2 * np.pi, 5000, endpoint=False)
    assert cut(np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])) == {}
    assert cut([[0, 0, 0], [1, 0, 0], [2, 0, 0], [2, 1, 0]]) == {}


def test_winding_is_kept_on_both_sides():
    for order, up in ((slice(None), 1), (slice(None, None, -1), -1)):
        for axes in ([0, 1, 2], [1, 2, 0], [2, 0, 1]):
            turned = FLAT[order][:, axes]
            (triangles,) = cut(turned).values()
            vectors = area_vectors(turned, triangles)
            assert (vectors.sum(axis=1) * up > 0).all()
            assert np.abs(vectors).sum() == pytest.approx(10)


@pytest.mark.parametrize("scale", [1e-300, 1e300])
def test_the_unit_changes_no_cut(scale):
    np.testing.assert_array_equal(cut(FLAT * scale)[0], cut(FLAT)[0])


def test_a_polygon_that_is_not_flat_is_cut_as_seen_along_its_area_vector():
    points = np.column_stack([PENTAGON, [0, 0.1, -0.1, 0.2, 0]])
    whole = area_vectors(points, np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4]])).sum(axis=0)
    for first in range(5):
        for triangles in cut(points, first).values():
            vectors = area_vectors(points, triangles)
            np.testing.assert_allclose(vectors.sum(axis=0), whole, atol=1e-12)
            assert (vectors @ whole > 0).all()


def test_a_polygon_that_crosses_itself_is_cut_only_where_that_comes_nearer_to_its_area():
    random = np.random.default_rng(0)
    for _ in range(500):
        points = np.column_stack([random.random((12, 2)), np.zeros(12)])
        fan = area_vectors(points, fan_faces(np.arange(12)))
        whole = fan.sum(axis=0)
        for triangles in cut(points).values():
            vectors = area_vectors(points, triangles)
            assert (vectors @ whole >= 0).all()
            excess = np.abs(fan).sum() - np.abs(whole).sum()
            assert abs(np.abs(vectors).sum() - np.abs(whole).sum()) < excess


# A closed solid of a pentagon that is not flat, and of five triangles to an apex.
SOLID = [[-5, 0, 5], [5, 0, 5], [5, 0, -5], [-5, 0, -5], [0, 5, -5], [0, -6, 0]]
SIDES = [[0, 1, 2, 3, 4], [1, 0, 5], [2, 1, 5], [3, 2, 5], [4, 3, 5], [0, 4, 5]]


def uses_of_edges(faces):
    return Counter(
        tuple(sorted(edge)) for face in faces for edge in zip(face, np.roll(face, -1), strict=True)
    )


@pytest.mark.parametrize(
    ("kind", "data"),
    [
        ("obj", generated.as_obj(SOLID, SIDES)),
        ("off", generated.as_off(SOLID, SIDES)),
        ("ply", generated.as_ply(np.array(SOLID, float), SIDES, "ascii")),
    ],
    ids=["obj", "off", "ply"],
)
def test_a_closed_surface_of_polygons_stays_closed(kind, data):
    faces = meshreaders.read(io.BytesIO(data), kind).faces
    edges = uses_of_edges(faces)
    assert len(faces) == 8
    assert set(edges.values()) == {2}


def test_the_triangles_of_a_polygon_use_each_of_its_corners_and_edges():
    random = np.random.default_rng(1)
    for count in random.integers(4, 14, 1500):
        # Corners on few places lie on lines, and on one another.
        points = random.integers(0, 7, (count, 3)) * [1, 1, random.integers(0, 2)]
        for triangles in cut(points).values():
            assert len(triangles) == count - 2
            edges = uses_of_edges([*triangles, range(count)])
            assert all(number % 2 == 0 for number in edges.values())


@pytest.mark.parametrize(
    "points",
    [
        [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0], [1.5, 0, 0]],
        [[0, 0, 0], [1, 1, 0], [1, 0, 0], [0, 1, 0]],
        [[1, 1, 1]] * 5,
        [[0, 0, 0], [1, 0, 0], [np.nan, 1, 0], [0, 1, 0]],
    ],
    ids=["on a line", "crossing itself", "one point", "not a number"],
)
def test_a_polygon_without_an_area_vector_stays_a_fan(points):
    assert cut(points) == {}


def test_texture_and_colours_stay_with_the_corners_of_a_cut_polygon(tmp_path):
    halves = np.zeros((8, 8, 3), np.uint8)
    halves[:, :4], halves[:, 4:] = (200, 0, 0), (0, 0, 200)
    spots = "vt 0.1 0.5\n" * 5 + "vt 0.9 0.5\n" * 5
    rows = [f"v {x} {y} {z}" for z in (0, 1) for x, y in PENTAGON]
    faces = ["f " + " ".join(f"{k}/{k}" for k in range(start, start + 5)) for start in (1, 6)]
    text = "\n".join(["mtllib a.mtl", *rows, spots.strip(), "usemtl paint", *faces, ""])
    surface = meshreaders.read(generated.write_square(tmp_path, halves, text=text))
    low = surface.triangles[..., 2].max(axis=1) == 0
    assert surface.face_areas[low].sum() == pytest.approx(10)
    assert (surface.face_colours[low] == [200, 0, 0]).all()
    assert (surface.face_colours[~low] == [0, 0, 200]).all()


def test_a_ply_keeps_a_colour_for_each_polygon():
    rows = [f"{x} {y} {z}" for z in (0, 1) for x, y in PENTAGON]
    rows += ["5 0 1 2 3 4 9 8 7", "5 5 6 7 8 9 1 2 3"]
    head = generated.as_ply(np.zeros((10, 3)), [[0]] * 2, "ascii").split(b"end_header")[0]
    colours = b"".join(b"property uchar %s\n" % name for name in (b"red", b"green", b"blue"))
    data = head + colours + b"end_header\n" + "\n".join([*rows, ""]).encode()
    surface = meshreaders.read(io.BytesIO(data), "ply")
    low = surface.triangles[..., 2].max(axis=1) == 0
    assert surface.face_areas.sum() == pytest.approx(20)
    assert (surface.face_colours[low] == [9, 8, 7]).all()
    assert (surface.face_colours[~low] == [1, 2, 3]).all()
