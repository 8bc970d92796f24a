"""Planes of the channels, by their formulas in float64."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from visuohaptic.attention import channels
from visuohaptic.attention.channels import WorkingView
from visuohaptic.attention.levels import CENTRE_LEVELS
from visuohaptic.attention.pyramid import BORDER_REPEATED, blur, build_pyramid

SIZE = 256


@pytest.fixture(scope="module")
def view():
    """A view of smooth random colours, of which a disk is the object."""
    generator = np.random.default_rng(5)
    colours = [gaussian_filter(generator.random((SIZE, SIZE)), 4) for _ in range(3)]
    red, green, blue = (np.float32((plane - plane.min()) / np.ptp(plane)) for plane in colours)
    rows, columns = np.mgrid[:SIZE, :SIZE] - SIZE / 2
    certainty = np.float32(np.clip(100.5 - np.hypot(rows, columns), 0, 1))
    intensity = (red + green + blue) / np.float32(3)
    backdrop, curvature = intensity * np.float32(0.9), np.abs(intensity - red)
    return WorkingView(certainty, (red, green, blue), intensity, backdrop, curvature)


def in_double(*planes):
    return [plane.astype(np.float64) for plane in planes]


def test_colours_are_opposed_in_pairs_relative_to_the_brightest(view):
    red, green, blue, certainty = in_double(*view.colour, view.certainty)
    brightest = np.maximum.reduce([red, green, blue, np.full_like(red, 0.1)])
    expected = ((red - green) / brightest, (blue - np.minimum(red, green)) / brightest)
    for plane, values in zip(channels.colour_planes(view), expected, strict=True):
        np.testing.assert_allclose(plane, values * certainty, atol=1e-6)


def test_yellow_is_the_lesser_of_red_and_green():
    one = np.ones((4, 4), np.float32)
    orange = WorkingView(one, (one, 0.5 * one, 0 * one), one / 2, one / 2, 0 * one)
    red_green, blue_yellow = channels.colour_planes(orange)
    assert red_green[0, 0] == pytest.approx(0.5)
    assert blue_yellow[0, 0] == pytest.approx(-0.5)


def test_contrast_is_the_standard_deviation_over_the_mean_within_the_object(view):
    intensity, certainty = in_double(view.intensity, view.certainty)

    def mean_of(values):
        def window(plane):
            return gaussian_filter(plane, channels.WINDOW_DEVIATION, mode="constant", truncate=4)

        inside = certainty > 0
        means = np.zeros_like(values)
        means[inside] = window(values * certainty)[inside] / window(certainty)[inside]
        return means

    mean = mean_of(intensity)
    expected = np.sqrt(mean_of((intensity - mean) ** 2)) / (mean + 0.1) * certainty
    (plane,) = channels.contrast_planes(view)
    np.testing.assert_allclose(plane, expected, atol=2e-5)


def test_each_orientation_counts_above_the_mean_of_all(view):
    images = build_pyramid(view.backdrop, max(CENTRE_LEVELS), BORDER_REPEATED)
    certainties = build_pyramid(view.certainty, max(CENTRE_LEVELS))
    for level, planes in zip(CENTRE_LEVELS, channels.orientation_planes(view), strict=True):
        energies = np.array(
            [
                blur(energy, BORDER_REPEATED)
                for energy in channels._gabor_energies(images[level], channels.ORIENTATIONS)
            ],
            np.float64,
        )
        above = np.maximum(energies - energies.mean(axis=0), 0)
        np.testing.assert_allclose(planes, above * certainties[level], atol=1e-6)
        assert np.any(above == 0)


@pytest.mark.parametrize("index", range(channels.ORIENTATIONS))
def test_energy_of_an_orientation_is_that_of_the_filters_of_the_toolbox(index):
    """9 x 9 pixels, period 7, deviation 7/3, zero mean and unit norm (Itti, Koch & Niebur 1998)."""
    y, x = np.mgrid[-4:5, -4:5].astype(np.float64)
    angle = np.pi * index / channels.ORIENTATIONS
    across = x * np.cos(angle) + y * np.sin(angle)
    envelope = np.exp(-(x**2 + y**2) / (2 * (7 / 3) ** 2))
    even, odd = (envelope * wave(2 * np.pi / 7 * across) for wave in (np.cos, np.sin))
    even -= even.mean()
    patch = np.random.default_rng(index).random((9, 9))
    image = np.zeros((33, 33), np.float32)
    image[12:21, 12:21] = patch
    found = channels._gabor_energies(image, channels.ORIENTATIONS)[index][16, 16]
    values = [(patch * kernel).sum() / np.linalg.norm(kernel) for kernel in (even, odd)]
    assert found == pytest.approx(np.hypot(*values), rel=1e-4)


def test_intensity_and_curvature_count_as_far_as_the_object_covers_a_pixel(view):
    (intensity,), (curvature,) = channels.intensity_planes(view), channels.curvature_planes(view)
    np.testing.assert_array_equal(intensity, view.intensity * view.certainty)
    np.testing.assert_array_equal(curvature, view.curvature * view.certainty)


def test_a_view_is_relative_to_its_brightest_value_and_curvature_is_a_logarithm():
    mask = np.ones((64, 64), bool)
    colour = np.broadcast_to(np.float32([0.1, 0.2, 0.4]), (64, 64, 3))
    prepared = channels.prepare_view(colour, mask, np.full((64, 64), 3, np.float32))
    for plane, value in zip(prepared.colour, (0.25, 0.5, 1.0), strict=True):
        np.testing.assert_allclose(plane, value, atol=1e-5)
    np.testing.assert_allclose(prepared.intensity, 1.75 / 3, atol=1e-5)
    np.testing.assert_allclose(prepared.curvature, np.log(4), atol=1e-5)
