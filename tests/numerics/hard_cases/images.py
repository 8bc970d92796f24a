"""Images and sequences at the ends of what numbers can be, against exact rationals."""

from fractions import Fraction
from functools import cache

import numpy as np
import pywt
from contourlet_definition import toolbox_bands
from numerics import oracles
from numerics.surfaces import pick

from contourlets import Contourlet, directional_deviations
from visuohaptic.features.imprint_shape import describe_imprint_shape
from visuohaptic.recognition.parameters import SequenceParameters
from visuohaptic.recognition.sequence_features import summarise_signals, wavelet_levels
from visuohaptic.sensor.sensing import stretch
from visuohaptic.stability.findings import Finding
from visuohaptic.stability.objects import reconstruction_errors

SIDE = 32


def hard_images(side):
    """Return images, shape (side, side), that an image transform may lose digits in, by name."""
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


@cache
def exact_bank(side):
    """Return the transform's definition as whole numbers: (pixels, coefficients), unit, band sizes.

    The matrix is made by the second implementation of the tests, not by the library.
    """
    columns = []
    for impulse in np.eye(side * side):
        bands = toolbox_bands(impulse.reshape(side, side), (4,))
        columns.append(np.concatenate([band.ravel() for band in bands]))
    matrix, unit = whole_numbers(np.array(columns))
    return matrix, unit, [band.size for band in bands]


def whole_numbers(values):
    """Return Python integers and a power of two that they are to be divided by; nothing is rounded."""
    exact = oracles.exact(values)
    unit = max(value.denominator for value in exact.flat)
    return np.frompyfunc(int, 1, 1)(exact * unit), unit


def exact_bands(image):
    """Return the bands of an image by the definition, in exact rationals."""
    matrix, unit, sizes = exact_bank(len(image))
    pixels, own = whole_numbers(image.ravel())
    products = np.array([Fraction(whole, unit * own) for whole in pixels @ matrix])
    return np.split(products, np.cumsum(sizes)[:-1])


def exact_deviation(band):
    """Return the sample deviation of a band."""
    offsets = band - band.sum() / len(band)
    return oracles.root((offsets**2).sum() / (len(band) - 1))


def bands(_):
    """Compare bands and their deviations with the transform's definition in exact rationals."""
    for name, image in hard_images(16).items():
        exact = exact_bands(image)
        largest = np.abs(image).max()
        found = Contourlet(levels=(4,)).forward(image).ravel()
        errors = off(found, np.concatenate(exact)) / largest
        yield Finding("images/contourlet bands against exact rationals", errors, name)
        deviations = [exact_deviation(band) for band in exact[1:]]
        errors = np.abs(directional_deviations(image[None])[0] - deviations) / largest
        label = f"{name}, deviations of the bands"
        yield Finding("images/deviations against exact rationals", errors, label)


def off(found, wanted):
    """Return how far numbers are from exact rationals."""
    return np.abs(oracles.exact(found) - wanted).astype(float)


def reconstruction(_):
    """Decompose hard images and put them together again."""
    images = hard_images(SIDE)
    names = list(images)
    yield Finding(
        "images/contourlet reconstruction",
        reconstruction_errors(np.stack(list(images.values()))),
        lambda row: names[row],
    )


def flat_images(generator):
    """Measure the sub-bands of images of one value: there is nothing in them."""
    side = int(generator.choice([16, 32, 64]))
    value = float(generator.choice([0.0, 1.0, 1e150, 10.0 ** generator.uniform(-300, 150)]))
    image = np.full((1, side, side), value)
    error = directional_deviations(image).max() / (value or 1.0)
    label = f"{side} × {side} pixels of {value:g}"
    yield Finding("images/deviations of flat images", error, label)


def images_in_other_units(generator):
    """Scale an image by powers of two, to the bit, and of ten."""
    image = generator.random((1, SIDE, SIDE))
    plain = directional_deviations(image)
    power = int(generator.integers(-900, 901))
    wrong = np.ldexp(plain, power) != directional_deviations(np.ldexp(image, power))
    yield Finding("images/scale by a power of two", wrong.any(), f"noise times 2^{power}")
    exponent = int(generator.choice([-150, -40, -8, 8, 40, 150]))
    factor = 10.0**exponent
    error = np.abs(directional_deviations(image * factor) / factor / plain - 1).max()
    yield Finding("images/scale by 1e±150", error, f"noise times 1e{exponent}")


def draw_sequence(generator):
    """Draw a sequence: of any values, nearly constant, or of any size."""
    kind = generator.integers(3)
    if kind == 0:
        level = pick(generator, 0.1, 10) * 10.0 ** generator.integers(-150, 151)
        steps = generator.integers(-3, 4, generator.integers(2, 9))
        return level * (1 + 10.0 ** generator.integers(-16, 1) * steps)
    values = generator.choice([-1e3, -1.0, 0.0, 1.0, 1e3], generator.integers(1, 13))
    drawn = generator.uniform(-1e3, 1e3, len(values))
    values = np.where(generator.random(len(values)) < 0.2, values, drawn)
    return values * 10.0 ** generator.integers(-150, 151) if kind == 1 else values


def sequence_moments(generator):
    """Compare deviation, root mean square and skewness of a sequence with exact rationals."""
    signal = draw_sequence(generator)
    found = summarise_signals(signal, 1)
    count = len(signal)
    _, second, _ = oracles.exact_moments(signal)
    rms = oracles.root((oracles.exact(signal) ** 2).sum() / count)
    deviation = oracles.root(second * count / max(count - 1, 1))
    label = f"{count} values, root mean square {rms:.3g}, deviation {deviation:.3g}"
    # What counts as constant may lose its deviation, which is 1e-12 of the rms or less.
    constant = deviation <= 1.01e-12 * rms * np.sqrt(count / max(count - 1, 1))
    wanted = 0.0 if constant and found[0] == 0 else deviation
    error = np.abs([found[0] - wanted, found[1] - rms]).max() / (rms or 1.0)
    yield Finding("images/moments of sequences against exact rationals", error, label)
    if constant or deviation <= 2e-12 * rms:
        # A deviation of half of what counts as constant must be without skewness.
        near = deviation > 0.5e-12 * rms and abs(found[2]) <= np.sqrt(count)
        error = 0.0 if found[2] == 0 or near else np.inf
    else:
        error = abs(found[2] - oracles.skewness(signal))
    yield Finding("images/skewness against exact rationals", error, label)
    if deviation > 0.01 * np.abs(signal).max():
        yield Finding("images/skewness of well spread sequences", error, label)


def wavelets(generator):
    """Compare the wavelet levels of a sequence with exact rationals."""
    exponent = int(generator.choice([0, -140, 140]))
    signal = generator.uniform(-1e3, 1e3, generator.integers(1, 10)) * 10.0**exponent
    wavelet = pywt.Wavelet("db2")
    extension = "zero" if generator.random() < 0.5 else "symmetric"
    wanted = oracles.exact_detail_levels(signal, wavelet.dec_lo, wavelet.dec_hi, 3, extension)
    found = wavelet_levels(signal[None], SequenceParameters(extension=extension))
    largest = np.abs(signal).max() or 1.0
    for level, (exact, computed) in enumerate(zip(wanted, found, strict=True), 1):
        error = off(computed[0], exact).max() / largest
        label = f"{len(signal)} values, db2, {extension}, level {level}, scale 1e{exponent}"
        yield Finding("images/wavelet levels against exact rationals", error, label)


def imprint_shapes(generator):
    """Compare mean, deviation and skewness of an imprint with exact rationals."""
    side = int(generator.choice([3, 8, 32]))
    relief = pick(generator, -6, 0)
    image = generator.random() + 10.0**relief * generator.normal(size=(side, side))
    image = np.clip(image, 0, 1).astype(np.float32)
    found = describe_imprint_shape(image[None])[0]
    mean, second, _ = oracles.exact_moments(image.ravel())
    deviation = oracles.root(second)
    errors = [abs(found[0] - float(mean)), abs(found[1] - deviation)]
    if deviation > 1e-6:
        errors.append(abs(found[2] - oracles.skewness(image.ravel())))
    label = f"{side} × {side}, relief 1e{relief:.1f}"
    yield Finding("images/shape of imprints against exact rationals", max(errors), label)


def stretched_imprints(generator):
    """Stretch signals to imprints: they stay images, and contact stays 1."""
    span = 10.0 ** pick(generator, -12, 0)
    signals = {
        "flat": np.full((8, 8), generator.random()),
        "one pixel": np.eye(64)[0].reshape(8, 8) * generator.random(),
        "saturated": np.ones((8, 8)),
        "ulp": 0.5 + 2.0**-53 * generator.integers(0, 3, (8, 8)),
        "noise": generator.random((8, 8)),
        "nothing": np.zeros((8, 8)),
    }
    for kind, signal in signals.items():
        image = stretch(signal[None], span)
        wrong = not np.isfinite(image).all() or image.min() < 0 or image.max() > 1
        wrong |= bool(signal.max() > 0) != bool(image.max() == 1.0)
        wrong |= kind in ("flat", "saturated") and bool((image != 1).any())
        label = f"{kind}, least span {span:.2g}"
        yield Finding("images/stretched imprints", wrong, label)
