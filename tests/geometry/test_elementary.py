"""Functions of angles against Python's, and the same bits in any batch."""

import math

import numpy as np
import pytest

from visuohaptic.geometry.elementary import (
    arc_tangent,
    sin_cos,
    tangent,
)

GENERATOR = np.random.default_rng(0)
ULP = np.finfo(np.float64).eps


def relative(found, expected):
    return np.max(np.abs(found / expected - 1))


def test_sine_and_cosine_are_exact_to_the_last_place_and_turn_after_turn():
    angles = np.concatenate([GENERATOR.uniform(-10, 10, 2000), np.pi * np.arange(-8, 9) / 4])
    sine, cosine = sin_cos(angles)
    np.testing.assert_allclose(sine, np.sin(angles), rtol=0, atol=ULP)
    np.testing.assert_allclose(cosine, np.cos(angles), rtol=0, atol=ULP)
    np.testing.assert_allclose(sine**2 + cosine**2, 1, rtol=0, atol=4 * ULP)


def test_whole_quarter_turns_keep_their_sign():
    sine, cosine = sin_cos(np.radians([0.0, 90, 180, 270, 360, -90]))
    np.testing.assert_array_equal(np.round(sine), [0, 1, 0, -1, 0, -1])
    np.testing.assert_array_equal(np.round(cosine), [1, 0, -1, 0, 1, 0])
    for angle in (0.01, 0.3, 0.8, 1.4):
        assert tangent(angle) == pytest.approx(math.tan(angle), rel=8 * ULP)


def test_arc_tangents_are_exact_relative_to_themselves_also_where_small():
    across = GENERATOR.random(4000) * 10.0 ** GENERATOR.uniform(-12, 0, 4000)
    along = GENERATOR.normal(size=4000)
    expected = np.array([math.atan2(y, x) for y, x in zip(across, along, strict=True)])
    assert relative(arc_tangent(across, along), expected) < 8 * ULP
    axes = arc_tangent([0, 0, 1, 0, 1], [1, -1, 0, 0, 1])
    np.testing.assert_allclose(axes, np.pi * np.array([0, 1, 0.5, 0, 0.25]), rtol=2 * ULP)


def test_values_do_not_depend_on_what_else_is_in_the_batch():
    values = GENERATOR.random((300, 100))
    np.testing.assert_array_equal(arc_tangent(values, 0.5)[9], arc_tangent(values[9], 0.5))
