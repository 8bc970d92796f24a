"""Images and sequences at the ends of what numbers can be, against exact rationals."""

import functools
from fractions import Fraction

import numpy as np
import pytest
import pywt
from contourlet.definition import toolbox_bands
from hypothesis import given
from hypothesis import strategies as st
from numerics import drawings, oracles

from visuohaptic.contourlet import Contourlet, directional_deviations
from visuohaptic.features.imprint_shape import describe_imprint_shape
from visuohaptic.recognition.parameters import SequenceParameters
from visuohaptic.recognition.sequence_features import summarise_signals, wavelet_levels
from visuohaptic.sensor.touching import stretch

SIDE = 32
SMALL = 16
SEEDS = st.integers(0, 2**32 - 1)


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


def hard_images(side):
    generator = np.random.default_rng(2)
    one_pixel = np.zeros((side, side))
    one_pixel[13, 7] = 1.0
    ulp = np.full((side, side), 0.3)
    ulp[::2, 1::3] = np.nextafter(0.3, 1)
    ramp = np.add.outer(np.arange(side), np.arange(side)) / (2 * side - 2)
    return {
        "one pixel": one_pixel,
        "constant ± 1 ulp": ulp,
        "saturated, a corner free": (ramp > 0.2).astype(float),
        "checkerboard": np.indices((side, side)).sum(axis=0) % 2.0,
        "ramp": ramp,
        "noise": generator.random((side, side)),
        "1 beside 1e-16": np.where(generator.random((side, side)) < 0.5, 1.0, 1e-16),
        "huge offset, small relief": 1e6 + generator.random((side, side)),
    }


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


@given(value=st.floats(0, 1e150), side=st.sampled_from([16, 32, 64]))
def test_flat_images_have_no_deviation(hold, value, side):
    image = np.full((1, side, side), value)
    hold(
        "images/deviations of flat images",
        directional_deviations(image)[0] / (value or 1.0),
        f"{side} × {side} pixels of {value:g}",
        drawings.image(image[0], "a flat image"),
    )


@given(seed=SEEDS, power=st.integers(-900, 900))
def test_a_power_of_two_scales_deviations_to_the_bit(hold, seed, power):
    image = np.random.default_rng(seed).random((1, SIDE, SIDE))
    plain, scaled = directional_deviations(image), directional_deviations(np.ldexp(image, power))
    hold(
        "images/scale by a power of two",
        (np.ldexp(plain, power) != scaled).ravel(),
        f"noise (seed {seed}) times 2^{power}",
    )


@given(seed=SEEDS, exponent=st.sampled_from([-150, -40, -8, 8, 40, 150]))
def test_images_of_any_unit_have_deviations_in_that_unit(hold, seed, exponent):
    image = np.random.default_rng(seed).random((1, SIDE, SIDE))
    factor = 10.0**exponent
    plain, scaled = directional_deviations(image), directional_deviations(image * factor)
    hold(
        "images/scale by 1e±150",
        np.abs(scaled / factor / plain - 1),
        f"noise (seed {seed}) times 1e{exponent}",
    )


def hard_sequences():
    """Sequences of 1 to 64 values: any, near-constant, of any size, cancelling."""
    plain = st.lists(st.floats(-1e3, 1e3, allow_subnormal=False), min_size=1, max_size=12)

    @st.composite
    def near_constant(draw):
        level = draw(st.floats(0.1, 10)) * 10.0 ** draw(st.integers(-150, 150))
        steps = draw(st.lists(st.integers(-3, 3), min_size=2, max_size=8))
        spread = 10.0 ** draw(st.integers(-16, 0))
        return [level * (1 + spread * step) for step in steps]

    @st.composite
    def any_size(draw):
        exponent = draw(st.integers(-150, 150))
        return [value * 10.0**exponent for value in draw(plain)]

    return st.one_of(plain, near_constant(), any_size())


@given(values=hard_sequences())
def test_moments_of_sequences_agree_with_exact_rationals(hold, values):
    signal = np.array(values)
    found = summarise_signals(signal, 1)
    assert np.isfinite(found).all()
    mean, second, _ = oracles.exact_moments(signal)
    square = sum((Fraction(float(v)) ** 2 for v in signal), Fraction(0)) / len(signal)
    rms = oracles.root(square)
    count = len(signal)
    deviation = oracles.root(second * count / max(count - 1, 1))
    label = f"{count} values about {float(mean):.3g}, deviation {deviation:.3g}"
    picture = functools.partial(lambda _: drawings.sequence(signal, "the sequence"))
    unit = rms or 1.0
    # What counts as constant may lose its deviation, which is 1e-12 of the rms or less.
    constant = deviation <= 1.01e-12 * rms * np.sqrt(count / max(count - 1, 1))
    wanted = 0.0 if constant and found[0] == 0 else deviation
    hold(
        "images/moments of sequences against exact rationals",
        [abs(found[0] - wanted) / unit, abs(found[1] - rms) / unit],
        label, picture,
    )  # fmt: skip
    exact = oracles.skewness(signal)
    if constant or deviation <= 2e-12 * rms:
        # A deviation of half of what counts as constant must be without skewness.
        assert found[2] == 0 or (deviation > 0.5e-12 * rms and abs(found[2]) <= np.sqrt(count))
        return
    hold("images/skewness against exact rationals", abs(found[2] - exact), label, picture)
    if deviation > 0.01 * np.abs(signal).max():
        hold("images/skewness of well spread sequences", abs(found[2] - exact), label, picture)


@given(
    values=st.lists(st.floats(-1e3, 1e3, allow_subnormal=False), min_size=1, max_size=9),
    exponent=st.sampled_from([0, -140, 140]),
)
def test_wavelet_levels_agree_with_exact_rationals(hold, values, exponent):
    signal = np.array(values) * 10.0**exponent
    wavelet = pywt.Wavelet("db2")
    wanted = oracles.exact_detail_levels(signal, wavelet.dec_lo, wavelet.dec_hi, 3)
    found = wavelet_levels(signal[None], SequenceParameters())
    largest = np.abs(signal).max() or 1.0
    for level, (exact, computed) in enumerate(zip(wanted, found, strict=True)):
        error = [
            abs(float((Fraction(float(value)) - right) / Fraction(float(largest))))
            for value, right in zip(computed[0], exact, strict=True)
        ]
        hold(
            "images/wavelet levels against exact rationals",
            error,
            f"{len(values)} values, db2, level {level + 1}, scale 1e{exponent}",
            lambda _: drawings.sequence(signal, "the sequence"),
        )


@given(seed=SEEDS, relief=st.floats(-6, 0), side=st.sampled_from([3, 8, 32]))
def test_shapes_of_imprints_agree_with_exact_rationals(hold, seed, relief, side):
    generator = np.random.default_rng(seed)
    level = generator.random()
    image = np.clip(level + 10.0**relief * generator.normal(size=(side, side)), 0, 1).astype(
        np.float32
    )
    found = describe_imprint_shape(image[None])[0]
    mean, second, _ = oracles.exact_moments(image.ravel())
    deviation = oracles.root(second)
    errors = [abs(found[0] - float(mean)), abs(found[1] - deviation)]
    if deviation > 1e-6:
        errors.append(abs(found[2] - oracles.skewness(image.ravel())))
    hold(
        "images/shape of imprints against exact rationals",
        errors,
        f"{side} × {side}, relief 1e{relief:.1f} (seed {seed})",
        drawings.image(image, "an imprint"),
    )


@given(
    seed=SEEDS,
    kind=st.sampled_from(["flat", "one pixel", "saturated", "ulp", "noise", "nothing"]),
    span=st.floats(1e-12, 1),
)
def test_stretched_imprints_stay_images(hold, seed, kind, span):
    generator = np.random.default_rng(seed)
    signal = {
        "flat": np.full((1, 8, 8), generator.random()),
        "one pixel": np.eye(64)[:1].reshape(1, 8, 8) * generator.random(),
        "saturated": np.ones((1, 8, 8)),
        "ulp": 0.5 + 2.0**-53 * generator.integers(0, 3, (1, 8, 8)),
        "noise": generator.random((1, 8, 8)),
        "nothing": np.zeros((1, 8, 8)),
    }[kind]
    image = stretch(signal, span)
    wrong = not np.isfinite(image).all() or image.min() < 0 or image.max() > 1
    wrong |= bool(signal.max() > 0) != bool(image.max() == 1.0)
    if kind in ("flat", "saturated"):
        wrong |= bool((image != 1).any())
    hold(
        "images/stretched imprints",
        wrong,
        f"{kind}, least span {span:.2g}",
        drawings.image(signal[0], kind),
    )
