"""Conspicuity maps and the operator N, by hand."""

import numpy as np
import pytest

from visuohaptic.attention import AttentionParameters
from visuohaptic.attention.channels import prepare_view
from visuohaptic.attention.saliency import (
    FAINT_PEAK,
    MAP_SIZE,
    conspicuity_maps,
    promote,
    saliency_map,
)

MASK = np.ones((64, 64), bool)


def spot_view(contrast):
    """An even grey view with a spot that is brighter by `contrast`."""
    colour = np.full((64, 64, 3), 1.0 - contrast, np.float32)
    colour[24:40, 24:40] = 1.0
    return prepare_view(colour, MASK, np.zeros((64, 64), np.float32))


def test_a_channel_is_as_conspicuous_as_its_strongest_map():
    parameters = AttentionParameters(normalisation="none")
    peaks = [
        conspicuity_maps(spot_view(contrast), ("intensity",), parameters)["intensity"].max()
        for contrast in (0.002, 0.004, 0.2)
    ]
    # Maps below the faint peak stay below 1, in proportion to their contrast less the noise of 1e-4.
    assert 0 < peaks[0] < peaks[1] < 0.004 / FAINT_PEAK
    assert peaks[1] / peaks[0] == pytest.approx(2, rel=0.1)
    assert peaks[2] == pytest.approx(1)


def map_of(*peaks):
    plane = np.zeros((MAP_SIZE, MAP_SIZE), np.float32)
    for place, height in enumerate(peaks):
        plane[10, 10 + 12 * place] = height
    return plane


@pytest.mark.parametrize(
    ("peaks", "factor"),
    [
        ((1.0,), 1.0),
        ((1.0, 0.5), 0.25),
        ((1.0, 0.4, 0.2), (1 - 0.3) ** 2),
        # Of a maximum from 0.05 to 0.15 the vote rises from 0 to 1; at least one other maximum is counted.
        ((1.0, 0.1), (1 - 0.5 * 0.1 / 1.0) ** 2),
        ((1.0, 0.4, 0.1), (1 - (0.4 + 0.5 * 0.1) / 1.5) ** 2),
        ((1.0, 1.0), 1e-3),
        ((0.5, 0.1), (0.5 - 0.5 * 0.1) ** 2),
    ],
)
def test_a_map_counts_by_the_square_of_its_largest_maximum_less_the_mean_of_the_others(
    peaks, factor
):
    plane = map_of(*peaks)
    found = promote(plane, AttentionParameters(normalisation="local_maxima"))
    np.testing.assert_allclose(found, factor * plane, rtol=1e-4)


def test_equal_neighbours_are_one_maximum():
    plane = map_of(1.0)
    plane[40, 40:42] = 0.5
    found = promote(plane, AttentionParameters(normalisation="local_maxima"))
    np.testing.assert_allclose(found, 0.25 * plane, rtol=1e-4)


def test_the_saliency_map_is_the_weighted_sum_of_channels():
    maps = {name: map_of(height) for name, height in (("colour", 1.0), ("contrast", 0.5))}
    weights = {"colour": 0.5, "contrast": 3.0, "intensity": 7.0}
    found = saliency_map(maps, AttentionParameters(weights=weights))
    assert found[10, 10] == pytest.approx(0.5 * 1.0 + 3.0 * 0.5)
    assert np.count_nonzero(found) == 1
