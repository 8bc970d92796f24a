"""Products of vectors have one order of their sums, and the bits of NumPy's own where they replace it."""

import numpy as np

from visuohaptic.geometry.vectors import cross, dot_rows


def test_dot_rows_add_the_first_and_the_third_product_before_the_second():
    # 1e17 swallows 1, so each order has another sum.
    first = np.array([[1e17], [1.0], [-1e17]])
    assert dot_rows(first, np.ones((3, 1)))[0] == 1.0
    assert dot_rows(first[[0, 2, 1]], np.ones((3, 1)))[0] == 0.0


def test_a_dot_product_of_zeros_is_positive_zero():
    assert not np.signbit(dot_rows(np.full((3, 2), -0.0), np.ones((3, 1)))).any()


def test_cross_products_have_the_bits_of_numpys_for_vectors_that_broadcast():
    random = np.random.default_rng(0)
    first, second = random.standard_normal((50, 9, 3, 3)), random.standard_normal((50, 1, 1, 3))
    np.testing.assert_array_equal(cross(first, second), np.cross(first, second))
    np.testing.assert_array_equal(cross(second, first), np.cross(second, first))
