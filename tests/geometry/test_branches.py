"""Edges of more than two faces: their folds, and the independence of any order."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numerics.hard_cases.attention import look
from numerics.hard_cases.invariance import KINDS, describe
from numerics.surfaces import branching_shapes, pages, points_on_faces, tube

from visuohaptic.fixations.parameters import ViewpointParameters
from visuohaptic.fixations.viewpoints import place_cameras
from visuohaptic.geometry.curvature import measure_shape
from visuohaptic.geometry.surface import read_surface
from visuohaptic.meshes.preparing import normalise

BEETLE = "meshes/paper/car/kl_VW-new-beetle.ply.gz"
SHAPES = sorted(branching_shapes())
SPINE = 0
"""The edge of a page's first face on the y axis, for pages that are not wound the other way."""


def prepared(name):
    return normalise(branching_shapes()[name], name).surface


@pytest.fixture(scope="module")
def beetle():
    return normalise(read_surface(BEETLE), "beetle").surface


def spine_folds(degrees, order=None):
    """Compute the fold of each page at the common edge, degrees; `order` is the order of the faces."""
    surface = pages(degrees)
    order = np.arange(len(surface.faces)) if order is None else order
    mixed = replace(surface, faces=surface.faces[order], face_colours=surface.face_colours[order])
    angles = np.empty((len(order), 3))
    angles[order] = measure_shape(mixed).crease_angles
    return np.degrees(angles[::2, SPINE])


def compare(found, wanted, generator):
    """Want the same curvature and normals at a point of each face."""
    weights = generator.dirichlet([1.0, 1.0, 1.0], size=len(wanted.faces))
    (first, second), shapes = (
        [points_on_faces(each, weights) for each in (found, wanted)],
        [measure_shape(each) for each in (found, wanted)],
    )
    curvature = [shape.curvature(*at) for shape, at in zip(shapes, (first, second), strict=True)]
    np.testing.assert_allclose(*curvature, atol=1e-7)
    one, other = (shape.normals(*at) for shape, at in zip(shapes, (first, second), strict=True))
    side = np.sign(np.einsum("nd,nd->n", one, other))
    np.testing.assert_allclose(side[:, None] * one, other, atol=1e-9)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", SHAPES)
def test_curvature_and_normals_do_not_depend_on_any_order(name, kind):
    surface, generator = prepared(name), np.random.default_rng(1)
    for _ in range(5):
        compare(describe(kind, surface, generator), surface, generator)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_curvature_and_normals_of_a_car_do_not_depend_on_any_order(beetle, kind):
    generator = np.random.default_rng(1)
    compare(describe(kind, beetle, generator), beetle, generator)


@pytest.mark.parametrize("kind", ["faces in another order", "vertices in another order"])
@pytest.mark.parametrize("name", SHAPES)
def test_folds_are_the_same_bits_for_faces_and_vertices_in_another_order(name, kind):
    surface, generator = prepared(name), np.random.default_rng(2)
    weights = np.full((len(surface.faces), 3), 1 / 3)
    wanted = measure_shape(surface).crease_angles[points_on_faces(surface, weights)[0]]
    for _ in range(5):
        other = describe(kind, surface, generator)
        found = measure_shape(other).crease_angles[points_on_faces(other, weights)[0]]
        np.testing.assert_array_equal(found, wanted)


def fixated(surface, count, resolution):
    """Return the saliency maps and the fixated points of some views."""
    cameras = place_cameras(ViewpointParameters(count=count))
    attended = look(surface, cameras, resolution)[1]
    points = np.concatenate([each.scanpath.points for each in attended])
    return np.stack([each.saliency for each in attended]), points


def compare_fixations(found, wanted):
    np.testing.assert_allclose(found[0], wanted[0], atol=1e-5)
    np.testing.assert_allclose(found[1], wanted[1], atol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", ["book of five pages", "plate on a plate", "double-walled tube"])
def test_fixations_do_not_depend_on_any_order(name, kind):
    # The shape lies askew, so that no peaks tie.
    surface = branching_shapes()[name]
    turn = np.linalg.qr(np.random.default_rng(8).normal(size=(3, 3)))[0]
    surface = normalise(replace(surface, vertices=surface.vertices @ turn), name).surface
    wanted = fixated(surface, 4, 128)
    generator = np.random.default_rng(3)
    for _ in range(2):
        compare_fixations(fixated(describe(kind, surface, generator), 4, 128), wanted)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_fixations_on_a_car_do_not_depend_on_any_order(beetle, kind):
    other = describe(kind, read_surface(BEETLE), np.random.default_rng(4))
    compare_fixations(fixated(normalise(other, "beetle").surface, 4, 256), fixated(beetle, 4, 256))


ANGLES = st.lists(st.integers(0, 359), min_size=3, max_size=9)


@given(ANGLES, st.randoms(use_true_random=False))
def test_a_face_has_the_smaller_of_the_folds_on_its_two_sides(degrees, random):
    sheets = sorted(set(degrees))
    gaps = {
        each: [
            abs(180 - ((sheets[(place + side) % len(sheets)] - each) * side) % 360)
            for side in (1, -1)
        ]
        for place, each in enumerate(sheets)
    }
    wanted = [min(gaps[each]) if len(sheets) > 1 else 180 for each in degrees]
    order = list(range(2 * len(degrees)))
    random.shuffle(order)
    found = spine_folds(degrees, order)
    for each, fold in zip(found, wanted, strict=True):
        assert each == pytest.approx(fold if fold > 40 else 0, abs=1e-6) or fold == 40


@pytest.mark.parametrize(
    ("degrees", "folds"),
    [
        ([0, 90, 180, 270], [90, 90, 90, 90]),
        ([0, 90, 180], [0, 90, 0]),
        # Two boxes side by side: their outsides continue each other, the two walls between lie on each other.
        ([90, 0, 0, 270], [0, 90, 90, 0]),
        ([0, 20, 40, 60, 80], [100, 160, 160, 160, 100]),
        ([5, 5, 5], [180, 180, 180]),
        ([0, 1e-4, 180.0, 180.0001], [0, 0, 0, 0]),
        # Faces that differ by less than a thousandth of a radian are one sheet, whichever lies between.
        ([0, 0.02, 0.04, 180], [0, 0, 0, 0]),
    ],
)
def test_folds_of_known_edges(degrees, folds):
    np.testing.assert_allclose(spine_folds(degrees), folds, atol=1e-4)


def test_two_equal_faces_have_the_same_folds_as_more_of_them():
    np.testing.assert_allclose(spine_folds([10, 10]), 180)
    np.testing.assert_allclose(spine_folds([10, 70, 70]), spine_folds([10, 70])[[0, 1, 1]])


def test_a_second_wall_changes_neither_normals_nor_curvature():
    single, double = measure_shape(tube()), measure_shape(tube(walls=2))
    first = np.arange(len(single.corner_normals))
    np.testing.assert_allclose(double.corner_normals[first], single.corner_normals, atol=1e-12)
    weights = np.random.default_rng(0).dirichlet([1.0, 1.0, 1.0], size=len(first))
    # At its rims the second wall is folded back on the first one.
    inner = np.flatnonzero(np.abs(tube().triangles[:, :, 1]).max(axis=1) < 0.5)
    assert not double.crease_angles[inner].any()
    found, wanted = (each.curvature(inner, weights[inner]) for each in (double, single))
    np.testing.assert_allclose(found, wanted, rtol=1e-9)
    np.testing.assert_allclose(wanted, np.sqrt(0.5) / 0.5, rtol=0.02)


def test_a_surface_with_one_side_has_the_same_normals_for_any_winding():
    turns = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    across = np.array([[-0.2], [0.2]])
    wide, height = 1 + across * np.cos(turns / 2), across * np.sin(turns / 2)
    rims = np.stack([wide * np.cos(turns), wide * np.sin(turns), height], axis=2)
    low, high = np.arange(40), np.arange(40, 80)
    next_low, next_high = np.append(low[1:], 40), np.append(high[1:], 0)
    faces = [np.stack([low, high, next_low], 1), np.stack([high, next_high, next_low], 1)]
    strip = replace(tube(), vertices=0.8 * rims.reshape(-1, 3), faces=np.concatenate(faces))
    strip = replace(strip, face_colours=strip.face_colours[: len(strip.faces)])
    generator = np.random.default_rng(6)
    for _ in range(5):
        compare(describe("faces wound at random", strip, generator), strip, generator)
