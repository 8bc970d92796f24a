"""Powers against Python's decimals, and the same bits in any batch."""

from decimal import Decimal, localcontext

import numpy as np

from meshreaders.base.powers import exponential, logarithm, power

GENERATOR = np.random.default_rng(0)
ULP = np.finfo(np.float64).eps


def relative(found, expected):
    return np.max(np.abs(found / expected - 1))


def decimals(function, values):
    """Apply a function of decimals with forty digits."""
    with localcontext() as context:
        context.prec = 40
        return np.array([float(function(Decimal(value))) for value in values.tolist()])


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


def test_powers_do_not_depend_on_what_else_is_in_the_batch():
    values = GENERATOR.random((300, 100))
    np.testing.assert_array_equal(power(values, 0.4)[7], power(values[7], 0.4))
