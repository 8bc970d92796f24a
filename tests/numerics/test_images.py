"""Contourlet bands of hard images, against the transform's definition in exact rationals."""

import functools
from fractions import Fraction

import numpy as np
import pytest
from contourlet_definition import toolbox_bands
from numerics import oracles
from numerics.hard_cases.images import SIDE, hard_images

from contourlets import Contourlet, directional_deviations
from visuohaptic.stability import drawings

SMALL = 16


@functools.cache
def exact_bank(side):
    """Give the transform's definition as whole numbers: (pixels, coefficients), unit, band sizes.

    The matrix is made by the second implementation of the tests, not by the library.
    """
    columns = []
    for pixel in range(side * side):
        impulse = np.zeros(side * side)
        impulse[pixel] = 1.0
        bands = toolbox_bands(impulse.reshape(side, side), (4,))
        columns.append(np.concatenate([band.ravel() for band in bands]))
    matrix, unit = whole_numbers(np.array(columns))
    return matrix, unit, [band.size for band in bands]


def whole_numbers(values):
    """Give Python integers and a power of two that they are to be divided by; nothing is rounded."""
    mantissas, exponents = np.frexp(values)
    shift = int(53 - exponents[values != 0].min(initial=0))
    digits = np.ldexp(mantissas, 53).astype(np.int64).astype(object)
    raised = np.where(values != 0, exponents - 53 + shift, 0).astype(object)
    return digits << raised, 2**shift


def exact_products(image):
    """Multiply an image with the matrix; numerators, their unit, and the bands' sizes."""
    matrix, unit, sizes = exact_bank(len(image))
    pixels, own = whole_numbers(image.ravel())
    return pixels @ matrix, unit * own, sizes


@pytest.mark.parametrize("name", hard_images(SMALL))
@pytest.mark.parametrize("side", [SMALL, pytest.param(SIDE, marks=pytest.mark.hard)])
def test_bands_and_deviations_agree_with_exact_rationals(hold, side, name):
    image = hard_images(side)[name]
    exact, unit, sizes = exact_products(image)
    largest = np.abs(image).max()
    found = Contourlet(levels=(4,)).forward(image)
    values = np.concatenate([band.ravel() for band in found.bands])
    error = [
        abs(float(Fraction(float(value)) - Fraction(whole, unit)))
        for value, whole in zip(values, exact, strict=True)
    ]
    picture = drawings.image(image, name)
    hold(
        "images/contourlet bands against exact rationals", np.array(error) / largest, name, picture
    )

    deviations = directional_deviations(image[None])[0]
    start = sizes[0]
    wanted = []
    for size in sizes[1:]:
        band = [Fraction(whole, unit) for whole in exact[start : start + size]]
        mean = sum(band) / size
        wanted.append(oracles.root(sum((value - mean) ** 2 for value in band) / (size - 1)))
        start += size
    hold(
        "images/deviations against exact rationals",
        np.abs(deviations - wanted) / largest,
        lambda band: f"{name}, band {band + 1}",
        picture,
    )
