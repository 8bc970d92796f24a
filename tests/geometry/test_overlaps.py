import itertools

import numpy as np
import pytest
from sensor.shapes import surface_of

from visuohaptic.base.errors import MeshError
from visuohaptic.geometry import overlaps
from visuohaptic.geometry.overlaps import overlapping_faces
from visuohaptic.geometry.raycasting import RayCaster

SQUARE = np.array([[-0.5, 0, -0.5], [0.5, 0, -0.5], [0.5, 0, 0.5], [-0.5, 0, 0.5]])
HALVES = np.array([[0, 2, 1], [0, 3, 2]])


def squares(*placed):
    """Join squares, each two triangles, from their corners."""
    return surface_of(
        np.vstack(placed), np.vstack([HALVES + 4 * place for place in range(len(placed))])
    )


def turned(corners):
    axis = np.array([0.3, 0.8, -0.5]) / np.linalg.norm([0.3, 0.8, -0.5])
    cross = np.cross(np.eye(3), axis)
    return corners @ (np.eye(3) + 0.9 * cross + 0.4 * cross @ cross)


@pytest.mark.parametrize(
    "other",
    [
        SQUARE + np.array([1.0, 0, 0]),
        0.4 * SQUARE + [0, 1e-3, 0],
        0.4 * SQUARE + [0, 1e-5, 0],
        SQUARE[:, [1, 0, 2]],
    ],
    ids=["beside", "above", "just above", "at an angle"],
)
def test_halves_of_a_square_and_squares_apart_or_at_an_angle_do_not_overlap(other):
    assert len(overlapping_faces(squares(SQUARE, other), 1e-6)) == 0


@pytest.mark.parametrize("move", [lambda corners: corners, turned])
def test_a_square_on_a_square_overlaps_with_both_of_its_halves(move):
    askew = 0.4 * SQUARE @ np.array([[0.8, 0, 0.6], [0, 1, 0], [-0.6, 0, 0.8]])
    surface = squares(move(SQUARE), move(askew + np.array([0, 1e-7, 0])))
    one_way = list(itertools.product((0, 1), (2, 3)))
    expected = sorted(one_way + [pair[::-1] for pair in one_way])
    np.testing.assert_array_equal(overlapping_faces(surface, 1e-6), expected)


def test_a_face_folded_back_onto_its_neighbour_overlaps_with_it_and_one_without_area_does_not():
    corners = [[0, 0, 0], [1, 0, 0], [0.5, 0, 1], [0.4, 0, 0.5], [0.5, 0, 0]]
    surface = surface_of(corners, [[0, 1, 2], [1, 0, 3], [0, 1, 4]])
    np.testing.assert_array_equal(overlapping_faces(surface, 1e-6), [[0, 1], [1, 0]])


def test_random_pairs_are_those_that_share_sampled_points():
    generator = np.random.default_rng(2)
    count = 60
    flat = generator.uniform(-1, 1, (3 * count, 2))
    surface = surface_of(turned(np.insert(flat, 1, 0, axis=1)), np.arange(3 * count))
    corners = flat.reshape(count, 3, 1, 2) - generator.uniform(-1, 1, (20_000, 2))
    onward = np.roll(corners, -1, axis=1)
    sides = corners[..., 0] * onward[..., 1] - corners[..., 1] * onward[..., 0]
    inside = (sides > 0).all(axis=1) | (sides < 0).all(axis=1)
    shared = inside.astype(float) @ inside.T.astype(float)
    found = np.zeros((count, count), dtype=bool)
    found[tuple(overlapping_faces(surface, 1e-6).T)] = True
    np.fill_diagonal(shared, 0)
    assert found[shared > 0].all()  # overlaps without a sampled point may be found, too
    assert (found & (shared == 0)).mean() < 0.02


@pytest.mark.parametrize("order", [[0, 1], [1, 0]])
def test_of_faces_on_each_other_the_nearest_in_float64_is_met(order):
    # A billionth is nothing to float32, and the second square is the nearer one.
    placed = [SQUARE, 0.4 * SQUARE + [0, 1e-9, 0]]
    caster = RayCaster(squares(*[placed[place] for place in order]))
    points = np.random.default_rng(0).uniform(-0.19, 0.19, (500, 2))
    origins = np.column_stack([points[:, 0], np.ones(500), points[:, 1]])
    hits = caster.first_hits(origins, np.tile([0, -1.0, 0], (500, 1)))
    np.testing.assert_allclose(hits.distance, 1 - 1e-9, rtol=0, atol=1e-12)
    assert set((hits.face // 2).tolist()) == {order.index(1)}


def test_very_many_faces_on_each_other_are_refused_before_they_take_memory(monkeypatch):
    count = 40
    across = 1e-6 * np.arange(count)
    corners = np.zeros((count, 3, 3))
    corners[:, 0, 0], corners[:, 1, 0], corners[:, 1, 1], corners[:, 2, 1] = across, 1, across, 1
    surface = surface_of(corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3))
    pairs = count * (count - 1) // 2
    monkeypatch.setattr(overlaps, "MOST_OVERLAPS", pairs)
    assert len(overlapping_faces(surface, 1e-4)) == 2 * pairs
    monkeypatch.setattr(overlaps, "MOST_OVERLAPS", pairs - 1)
    with pytest.raises(MeshError, match=r"more than 779 pairs of faces .* out of 40 faces; remove"):
        overlapping_faces(surface, 1e-4)
