"""The outline is followed in order, from its most salient place, step by step."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis.extra.numpy import arrays

from visuohaptic.fixations.strategies.contour import follow_outline, outline_pixels

SIZE = 64
ROWS, COLUMNS = np.mgrid[:SIZE, :SIZE]
DISC = np.hypot(ROWS - 31.5, COLUMNS - 31.5) < 24
POINT = np.stack([COLUMNS / 24.0, -ROWS / 24.0, np.zeros((SIZE, SIZE))], axis=-1)


def follow(mask=DISC, peak=(31, 55)):
    saliency = np.zeros((SIZE, SIZE), dtype=np.float32)
    saliency[peak] = 1.0
    return np.stack(follow_outline(mask, POINT, saliency, 0.5, 16), axis=1)


def test_of_a_disc_the_places_go_round_once():
    places = follow()
    angles = np.unwrap(np.arctan2(places[:, 0] - 31.5, places[:, 1] - 31.5))
    turns = np.diff(angles)
    assert (turns > 0).all() or (turns < 0).all()
    assert np.abs(turns) == pytest.approx(2 * np.arcsin(0.25), abs=0.08)
    assert 2 * np.pi - 0.6 < abs(angles[-1] - angles[0]) < 2 * np.pi


def test_the_first_place_is_the_most_salient_of_the_outline():
    assert tuple(follow()[0]) == (31, 55)
    assert tuple(follow(peak=(8, 31))[0]) == (8, 31)


def test_a_hole_a_smaller_part_and_a_view_of_nothing_have_no_place():
    mask = DISC.copy()
    mask[25:39, 25:39] = False
    mask[1:4, 1:4] = True
    np.testing.assert_array_equal(follow(mask), follow())
    assert not len(follow(np.zeros((SIZE, SIZE), dtype=bool)))


def test_an_object_that_fills_the_view_has_the_view_s_border():
    border = np.ones((5, 7), dtype=bool)
    border[1:-1, 1:-1] = False
    places = outline_pixels(np.ones((5, 7), dtype=bool))
    assert set(zip(*places, strict=True)) == set(zip(*np.nonzero(border), strict=True))


@given(arrays(bool, (9, 9)))
def test_places_are_pixels_of_the_object_beside_the_background_each_once(mask):
    rows, columns = outline_pixels(mask)
    assert mask[rows, columns].all()
    assert len(set(zip(rows, columns, strict=True))) == len(rows)
    padded = np.pad(mask, 1)
    around = [padded[rows + down, columns + right] for down in (0, 1, 2) for right in (0, 1, 2)]
    assert not np.all(around, axis=0).any()
    assert len(rows) == 0 or mask.any()
