"""Elementary functions against Python's decimals, and the same bits whatever NumPy's kernels are."""

import math
from decimal import Decimal, localcontext

import numpy as np
import pytest

from visuohaptic.geometry.elementary import (
    arc_tangent,
    exponential,
    logarithm,
    power,
    sin_cos,
    tangent,
)

GENERATOR = np.random.default_rng(0)
ULP = np.finfo(np.float64).eps


def relative(found, expected):
    return np.max(np.abs(found / expected - 1))


def decimals(function, values):
    """Apply a function of decimals with forty digits."""
    with localcontext() as context:
        context.prec = 40
        return np.array([float(function(Decimal(value))) for value in values.tolist()])


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


def test_exponentials_and_logarithms_agree_with_decimals_of_forty_digits():
    values = GENERATOR.uniform(-40, 40, 500)
    assert relative(exponential(values), decimals(Decimal.exp, values)) < 4 * ULP
    positive = 10.0 ** GENERATOR.uniform(-12, 12, 500)
    assert relative(logarithm(positive), decimals(Decimal.ln, positive)) < 4 * ULP
    assert logarithm(1.0) == 0
    assert exponential(0.0) == 1


def test_powers_agree_with_decimals_and_keep_zero_and_one():
    values = 10.0 ** GENERATOR.uniform(-6, 0, 500)
    for exponent in (2.4, 1 / 2.4):
        wanted = decimals(lambda value, p=exponent: value ** Decimal(p), values)
        assert relative(power(values, exponent), wanted) < 64 * ULP
    np.testing.assert_array_equal(power([0.0, 1.0], 0.4), [0, 1])


def test_values_do_not_depend_on_what_else_is_in_the_batch():
    values = GENERATOR.random((300, 100))
    np.testing.assert_array_equal(power(values, 0.4)[7], power(values[7], 0.4))
    np.testing.assert_array_equal(arc_tangent(values, 0.5)[9], arc_tangent(values[9], 0.5))
