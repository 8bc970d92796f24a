"""Layouts of taxels: what is allowed, and what a layout says of its pad."""

import numpy as np
import pytest

from visuohaptic.base.errors import ParameterError
from visuohaptic.geometry.layouts import MOST_TAXELS, Layout, grid_layout, nearest_taxels
from visuohaptic.geometry.pads import PADS, layout_of

DOWN = [0.0, 0.0, -1.0]
THREE = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
CURVED = ("dome", "finger")


def own(positions=THREE, directions=None, **options):
    looks = np.tile(DOWN, (len(positions), 1)) if directions is None else directions
    return Layout.of(positions, looks, **options)


@pytest.mark.parametrize(
    ("positions", "directions", "options", "says"),
    [
        (THREE, [DOWN, [0, 0, 0], DOWN], {}, r"taxel 1 has the direction \(0, 0, 0\)"),
        (THREE, [DOWN, [0, np.nan, -1], DOWN], {}, "directions has NaN, .* the first in taxel 1"),
        (np.where(THREE == 1, np.inf, 0), None, {}, "positions has NaN, infinity"),
        (THREE[[0, 1, 1]], None, {}, r"taxels 1 and 2 are both at \[1.0, 0.0, 0.0\]"),
        (THREE, -np.tile(DOWN, (3, 1)), {}, r"taxel 0 looks behind the pad, along .* at most 0"),
        (THREE, [DOWN, DOWN], {}, "3 positions and 2 directions"),
        (THREE[:, :2], None, {}, r"positions has the shape \(3, 2\); \(taxels, 3\)"),
        (THREE[:0], np.zeros((0, 3)), {}, r"positions has the shape \(0, 3\)"),
        (THREE * [0, 0, 1], None, {}, "taxels 0 and 1 are both at"),
        ([[0, 0, 0], [0, 0, 1]], None, {}, "all taxels on the pad's axis"),
        (THREE, None, {"unit": "ft"}, "unit is 'ft'; mm, cm, m, in are allowed"),
        (THREE, None, {"half_width": 0.5}, "half_width is 0.5, and a taxel is 1 from the axis"),
        (THREE, None, {"half_width": np.nan}, "half_width is nan"),
        ([["a", 0, 0]], [DOWN], {}, "positions holds no numbers"),
        (np.ma.masked_less(THREE, 0.5), None, {}, "positions has masked values"),
    ],
)
def test_taxels_that_are_not_allowed_are_refused_in_a_sentence(
    positions, directions, options, says
):
    with pytest.raises(ParameterError, match=says):
        own(positions, directions, **options)


def test_a_million_taxels_are_refused_before_their_neighbours_are_searched():
    count = 10**6
    positions = np.column_stack([np.arange(count), np.zeros((count, 2))])
    with pytest.raises(ParameterError, match="1,000,000 taxels; at most 100,000 are allowed"):
        own(positions)
    assert MOST_TAXELS == 100_000


def test_directions_may_have_any_length_and_units_give_the_width():
    layout = own(directions=[DOWN, [0, 0, -1e-200], [0, -3e90, -4e90]], unit="mm")
    np.testing.assert_allclose(layout.directions, [DOWN, DOWN, [0, -0.6, -0.8]], atol=1e-15)
    assert layout.half_width_m == pytest.approx(1e-3)
    assert own().half_width_m is None


@pytest.mark.parametrize("name", PADS)
def test_a_preset_holds_its_taxels_and_they_look_at_the_object(name):
    layout = layout_of(name, 16)
    assert len(np.unique(layout.positions, axis=0)) == len(layout) == np.prod(layout.shape)
    np.testing.assert_allclose(np.linalg.norm(layout.directions, axis=1), 1, atol=1e-12)
    assert (layout.directions[:, 2] <= 0).all()
    assert layout.lowest == 0
    assert ((layout.norms > 0) | ~layout.positions[:, :2].any(axis=1)).all()
    assert (layout.norms < 1).all()
    assert (layout.approach.norms < 1).all()
    assert Layout.of(layout.positions, layout.directions).shape == (len(layout),)


@pytest.mark.parametrize(("name", "radius"), [("dome", 1.0), ("finger", 0.7)])
def test_the_body_of_a_round_pad_is_its_radius_and_points_between_are_on_the_pad(name, radius):
    layout = layout_of(name, 2)
    assert layout.body == pytest.approx(radius)
    points = layout.approach.positions
    across = [0, 2] if name == "finger" else [0, 1, 2]
    distances = np.linalg.norm((points - [0, 0, radius])[:, across], axis=1)
    # Neighbours at the rim are up to 45 degrees apart, where the cubic errs by 0.2 % of the radius, and a chord by 8 %.
    np.testing.assert_allclose(distances, radius, rtol=2e-3)
    chords = points[: len(layout)][layout.pairs].mean(axis=1) - [0, 0, radius]
    assert np.linalg.norm(chords[:, across], axis=1).min() < radius * 0.99


def test_hollow_and_flat_pads_have_no_body_that_bounds_their_rays():
    dome = layout_of("dome", 2)
    bowl = Layout.of(dome.positions * [1, 1, -1], dome.directions * [-1, -1, 1])
    assert bowl.body == layout_of("round", 2).body == layout_of("gripper", 2).body == np.inf


def test_a_flat_pad_is_checked_at_its_taxels_and_within_its_plane():
    flat = layout_of("round", 2)
    assert flat.approach is flat
    assert len(flat.outline) == 128
    np.testing.assert_allclose(np.linalg.norm(flat.outline, axis=1), 1)
    for name in CURVED:
        curved = layout_of(name, 2)
        assert len(curved.approach) == len(curved) + len(curved.pairs)
        assert (curved.approach.directions == DOWN).all()
        assert not len(curved.outline)


def test_the_outline_of_given_taxels_is_the_ellipse_or_rectangle_that_holds_them():
    ring = np.array([[np.cos(a), 0.5 * np.sin(a), 0] for a in np.arange(20) * np.pi / 10])
    assert own(ring).is_round
    grid = grid_layout(4, 8).positions * [1, 0.25, 1]
    rectangle = own(grid)
    assert not rectangle.is_round
    np.testing.assert_allclose(rectangle.extents, (1, 3 / 14), rtol=1e-12)


def test_triples_are_lines_through_a_taxel_and_its_neighbours():
    grid = grid_layout(3, 3)
    triples = own(grid.positions).triples
    found = {tuple(triple) for triple in np.sort(triples, axis=0).T.tolist()}
    assert {(3, 4, 5), (1, 4, 7), (0, 1, 2), (2, 5, 8)} <= found
    middles = grid.positions[triples[1:]].mean(axis=0)
    np.testing.assert_allclose(middles, grid.positions[triples[0]], atol=1e-12)


def test_unrolling_moves_taxels_outwards_by_their_height_and_flat_pads_stay():
    np.testing.assert_array_equal(layout_of("square", 8).chart, grid_layout(8, 8).positions[:, :2])
    finger = layout_of("finger", 2)
    np.testing.assert_allclose(finger.chart[:, 1], finger.positions[:, 1])
    gripper = layout_of("gripper", 2)
    heights = gripper.positions[:, 2] - gripper.positions[:, 2].min()
    np.testing.assert_allclose(np.abs(gripper.chart[:, 0]), 1 + heights)


def test_each_pixel_of_a_drawing_shows_the_nearest_taxel_or_none():
    layout = layout_of("round", 2)
    index, empty = nearest_taxels(layout, 32)
    assert set(index[~empty].tolist()) == set(range(127))
    assert empty[0, 0]
    assert not empty[16, 16]


def test_a_name_that_is_none_is_refused_with_those_allowed():
    with pytest.raises(ParameterError, match="'fist' is no layout; square, round, dome, finger"):
        layout_of("fist", 32)


def test_the_outline_crosses_a_taxel_at_its_distance_by_the_norm_of_the_outline():
    round_pad, square = layout_of("round", 2), layout_of("square", 8)
    np.testing.assert_allclose(round_pad.norms, np.hypot(*round_pad.positions[:, :2].T), atol=1e-12)
    np.testing.assert_allclose(square.norms, np.abs(square.positions[:, :2]).max(axis=1))
