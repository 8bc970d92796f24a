import numpy as np
import pytest
from contourlet_definition import HALVES, NINE, SEVEN

from contourlets import (
    FilterError,
    diamond_filters,
    ladder_taps,
    pyramid_filter_names,
    pyramid_filters,
)
from contourlets.filters import ladder_steps


def test_nine_seven_pair_has_the_toolbox_digits():
    filters = pyramid_filters("9-7")
    np.testing.assert_array_equal(filters.analysis, NINE)
    np.testing.assert_array_equal(filters.synthesis, SEVEN)


@pytest.mark.parametrize("name", pyramid_filter_names())
def test_pyramid_pairs_are_symmetric_biorthogonal_and_sum_to_root_two(name):
    filters = pyramid_filters(name)
    h, g = filters.analysis, filters.synthesis
    np.testing.assert_allclose([h.sum(), g.sum()], np.sqrt(2), atol=1e-13)
    np.testing.assert_allclose(h, h[::-1], atol=1e-15)
    np.testing.assert_allclose(g, g[::-1], atol=1e-15)
    product = np.convolve(h, g)
    middle = len(product) // 2
    halfband = product[middle % 2 :: 2]
    expected = np.zeros(len(halfband))
    expected[middle // 2] = 1
    np.testing.assert_allclose(halfband, expected, atol=2e-14)


@pytest.mark.parametrize("name", ["bior4.4", "bior5.5", "rbio6.8"])
def test_polished_pairs_keep_the_digits_that_pywavelets_has(name):
    import pywt

    taps = np.array(pywt.Wavelet(name).dec_lo)
    np.testing.assert_allclose(pyramid_filters(name).analysis, taps[taps != 0], atol=1e-12)


@pytest.mark.parametrize("name", HALVES)
def test_diamond_filters_are_the_ladders_product_filters(name):
    h0, h1 = diamond_filters(name)
    beta = ladder_taps(name)
    n = len(beta)
    # β(z1 z2) β(z1 / z2): tap (i, j) of the product lies i + j rows and i − j columns away.
    B = np.zeros((2 * n - 1, 2 * n - 1))
    for i in range(n):
        for j in range(n):
            B[i + j, n - 1 + i - j] += beta[i] * beta[j]
    B[n - 1, n - 1] += 1
    np.testing.assert_allclose(h0, np.sqrt(2) * B / 2, atol=1e-12)
    assert h1.shape == (4 * n - 3, 4 * n - 3)
    angles = np.linspace(-np.pi, np.pi, 9)

    def response(h):
        waves = np.exp(-1j * np.outer(np.arange(len(h)) - len(h) // 2, angles))
        return waves.T @ h @ waves

    b = (response(h0) * np.sqrt(2) - 1).real
    np.testing.assert_allclose(response(h1), np.sqrt(2) * (1 - b * (1 + b) / 2), atol=1e-12)


def test_pkva_diamond_filters_leak_zero_frequency_as_known():
    h0, h1 = diamond_filters("pkva")
    assert h0.shape == (23, 23)
    assert h0.sum() == pytest.approx(1.3985, abs=5e-5)
    assert h1.sum() == pytest.approx(0.0469, abs=5e-5)


@pytest.mark.parametrize(
    ("look_up", "name"),
    [(pyramid_filters, "db2"), (ladder_steps, "pkva7"), (diamond_filters, "haar")],
)
def test_unknown_filters_are_named(look_up, name):
    with pytest.raises(FilterError, match=f"{name}.*names are"):
        look_up(name)


@pytest.mark.parametrize("name", ["9-7", "5-3", "haar", "bior4.4"])
def test_no_caller_can_change_the_filters_of_others(name):
    filters = pyramid_filters(name)
    shared = [filters.analysis, filters.synthesis, ladder_taps("pkva"), *diamond_filters("pkva6")]
    for taps in shared:
        with pytest.raises(ValueError, match="read-only"):
            taps[0] = 2
