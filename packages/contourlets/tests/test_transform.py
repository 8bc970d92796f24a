import numpy as np
import pytest
from contourlet_definition import check_grating_sweep, special_images, toolbox_bands

from contourlets import (
    EXTENSIONS,
    Coefficients,
    CoefficientsError,
    Contourlet,
    ContourletError,
    ImageError,
    LevelsError,
    NonsubsampledContourlet,
)

BOTH = pytest.mark.parametrize("transform", [Contourlet, NonsubsampledContourlet])
EVERY = pytest.mark.parametrize("extension", EXTENSIONS)
SIZES = {
    Contourlet: [
        ((4,), (32, 32)), ((3, 4), (64, 32)), ((0, 2, 1), (40, 24)), ((5,), (16, 48)),
        ((2,), (2, 6)), ((2, 3), (33, 47)),
    ],
    NonsubsampledContourlet: [
        ((4,), (32, 32)), ((3, 2), (17, 24)), ((0, 1), (5, 2)), ((5,), (16, 9)),
    ],
}  # fmt: skip


@pytest.mark.parametrize("levels", [(4,), (3, 4), (2, 3), (0, 1, 2), (5,), (5, 5)])
@pytest.mark.parametrize("directional", ["pkva", "pkva8", "pkva6", "haar"])
@pytest.mark.parametrize("pyramid", ["9-7", "5-3", "haar"])
def test_bands_are_the_toolboxs(levels, directional, pyramid, rng):
    for shape in ((32, 32), (64, 32), (32, 96)):
        image = rng.standard_normal(shape)
        coefficients = Contourlet(levels, pyramid, directional).forward(image)
        expected = toolbox_bands(image, levels, pyramid, directional)
        for band, reference in zip(coefficients.bands, expected, strict=True):
            np.testing.assert_allclose(band, reference, atol=1e-12, strict=True)


@BOTH
@EVERY
@pytest.mark.parametrize("directional", ["pkva", "pkva8", "pkva6", "haar"])
@pytest.mark.parametrize(("dtype", "tolerance"), [(np.float64, 1e-12), (np.float32, 1e-5)])
def test_reconstruction_is_perfect(transform, extension, directional, dtype, tolerance, rng):
    pyramids = ["9-7", "haar", "bior5.5"]
    if directional == "pkva":
        pyramids += ["5-3", "bior2.2", "bior3.3", "rbio6.8"]
    for levels, shape in SIZES[transform]:
        images = np.stack(list(special_images(shape, rng).values())).astype(dtype)
        for pyramid in pyramids:
            made = transform(levels, pyramid, directional, extension)
            rebuilt = made.inverse(made.forward(images))
            assert rebuilt.dtype == dtype
            error = np.abs(rebuilt - images).max() / np.abs(images).max()
            assert error < tolerance, (pyramid, levels, shape)


@BOTH
@EVERY
@pytest.mark.parametrize("scale", [1e150, 1e-150, 1e305, 1e-300, 1e-310])
def test_reconstruction_is_perfect_at_the_ends_of_the_range(transform, extension, scale, rng):
    made = transform((3, 4), extension=extension)
    for name, image in special_images((32, 32), rng).items():
        scaled = image / (np.abs(image).max() or 1.0) * scale
        error = np.abs(made.inverse(made.forward(scaled)) - scaled).max() / scale
        assert error < 1e-12, name


def test_the_smallest_numbers_come_back_to_within_their_spacing(rng):
    quanta = rng.integers(-1000, 1001, (32, 32)) * np.finfo(np.float64).smallest_subnormal
    transform = Contourlet((4,))
    error = np.abs(transform.inverse(transform.forward(quanta)) - quanta).max()
    assert error <= 4 * np.finfo(np.float64).smallest_subnormal


def test_scaling_by_a_power_of_two_changes_no_digit(rng):
    image = rng.standard_normal((32, 32))
    transform = Contourlet((4,), extension="symmetric")
    original = transform.forward(image).ravel()
    for exponent in (-700, -3, 5, 900):
        scaled = transform.forward(np.ldexp(image, exponent)).ravel()
        np.testing.assert_array_equal(scaled, np.ldexp(original, exponent))


@EVERY
@pytest.mark.parametrize("directional", ["pkva", "pkva8", "pkva6", "haar"])
@pytest.mark.parametrize("pyramid", ["9-7", "haar", "bior3.3"])
def test_adjoint_is_the_transpose(extension, directional, pyramid, rng):
    for levels, shape in (((0, 1, 2), (24, 40)), ((3,), (16, 24)), ((4, 5), (64, 32))):
        transform = Contourlet(levels, pyramid, directional, extension)
        image = rng.standard_normal(shape)
        bands = transform.forward(image)
        other = bands.map(lambda band: rng.standard_normal(band.shape))
        product = bands.ravel() @ other.ravel()
        transposed = float((transform.adjoint(other) * image).sum())
        assert transposed == pytest.approx(product, rel=1e-11, abs=1e-11)


@EVERY
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_an_image_does_not_depend_on_its_batch(extension, dtype, rng):
    images = rng.standard_normal((300, 32, 32)).astype(dtype)
    transform = Contourlet((2, 4), extension=extension)
    together = transform.forward(images)
    for chosen in [slice(0, 1), slice(7, 12), slice(150, 290)]:
        alone = transform.forward(images[chosen])
        np.testing.assert_array_equal(alone.ravel(), together.ravel()[chosen])
        np.testing.assert_array_equal(transform.inverse(alone), transform.inverse(together)[chosen])


def test_leading_axes_are_kept(rng):
    images = rng.standard_normal((2, 3, 16, 24))
    transform = Contourlet((2,))
    coefficients = transform.forward(images)
    assert coefficients.coarse.shape == (2, 3, 8, 12)
    assert coefficients.levels[0][3].shape == (2, 3, 8, 12)
    one = transform.forward(images[1, 2])
    np.testing.assert_array_equal(coefficients.levels[0][1][1, 2], one.levels[0][1])
    np.testing.assert_allclose(transform.inverse(coefficients), images, atol=1e-13)
    empty = transform.forward(np.zeros((0, 16, 24)))
    assert empty.ravel().shape == (0, 480)
    assert transform.inverse(empty).shape == (0, 16, 24)


def test_odd_images_are_padded_by_half_sample_reflection(rng):
    image = rng.standard_normal((31, 45))
    transform = Contourlet((3,), extension="symmetric")
    assert transform.padded_shape((31, 45)) == (32, 48)
    padded = np.pad(image, ((0, 1), (0, 3)), mode="symmetric")
    np.testing.assert_array_equal(
        transform.forward(image).ravel(), transform.forward(padded).ravel()
    )


@BOTH
@EVERY
@pytest.mark.parametrize(
    ("pyramid", "leak"), [("9-7", 2e-13), ("5-3", 2e-15), ("haar", 2e-15), ("bior6.8", 4e-15)]
)
@pytest.mark.parametrize("directional", ["pkva", "haar"])
def test_constant_images_leak_rounding_alone(transform, extension, pyramid, leak, directional):
    coefficients = transform((3, 4), pyramid, directional, extension).forward(np.ones((64, 64)))
    value = 4 if transform is Contourlet else 1
    np.testing.assert_allclose(coefficients.coarse, value, rtol=1e-12)
    assert max(np.abs(band).max() for band in coefficients.bands[1:]) < leak


def test_symmetric_extension_does_not_join_opposite_edges():
    """A ramp has a step where it wraps; its reflection has a kink there instead."""
    ramp = np.linspace(0, 1, 64)[None, :] * np.ones((64, 1))
    sums = {}
    for extension in EXTENSIONS:
        bands = Contourlet((4,), extension=extension).forward(ramp).levels[0]
        sums[extension] = sum(float(np.square(band).sum()) for band in bands)
    assert sums["periodic"] == pytest.approx(18.7, abs=0.05)
    assert sums["symmetric"] == pytest.approx(0.012, abs=5e-4)


@pytest.mark.slow
@EVERY
@pytest.mark.parametrize("level", [3, 4])
@pytest.mark.parametrize(
    ("transform", "side", "least_share"),
    [(Contourlet, 128, 0.4), (NonsubsampledContourlet, 96, 0.6)],
)
def test_the_band_of_a_gratings_direction_is_the_strongest(
    transform, side, least_share, level, extension
):
    check_grating_sweep(transform((level,), extension=extension), side, least_share)


@pytest.mark.parametrize(
    ("image", "culprit"),
    [
        (np.ones((8, 8), int), "int64"),
        (np.ones((8, 8), complex), "complex128"),
        (np.ones((8, 8), np.float16), "float16"),
        (np.ones((1, 64)), r"2 rows and 2 columns, not \(1, 64\)"),
        (np.ones(64), r"\(64,\)"),
        (np.full((8, 8), np.nan), "NaN"),
        (np.full((8, 8), -np.inf), "infinite"),
    ],
)
def test_wrong_images_are_refused(image, culprit):
    with pytest.raises(ImageError, match=culprit):
        Contourlet((2,)).forward(image)


@pytest.mark.parametrize(
    ("wrong", "culprit"),
    [({"levels": wrong}, str(wrong)) for wrong in ([4], ())]
    + [({"levels": (wrong,)}, f"from 0 to 5, not {wrong!r}") for wrong in (6, -1, 2.0, True)]
    + [({"pyramid_filter": "sym4"}, "sym4"), ({"directional_filter": "cd"}, "cd")]
    + [({"extension": "zero"}, "zero.*periodic, circular and symmetric")],
)
def test_wrong_parameters_are_refused(wrong, culprit):
    with pytest.raises(ContourletError, match=culprit.replace("[", r"\[").replace("()", r"\(\)")):
        Contourlet(**wrong)


@pytest.mark.parametrize(
    ("levels", "shape", "multiple"), [((5, 5, 5), (32, 32), 64), ((4,), (36, 32), 8)]
)
def test_sizes_that_the_levels_do_not_allow_are_refused(levels, shape, multiple):
    with pytest.raises(LevelsError, match=f"multiples of {multiple} .*not {shape[0]} × {shape[1]}"):
        Contourlet(levels).forward(np.ones(shape))


def test_wrong_coefficients_are_refused(rng):
    transform = Contourlet((2,))
    good = transform.forward(rng.standard_normal((8, 8)))
    cut = Coefficients(good.coarse[:2], good.levels, good.image_shape)
    with pytest.raises(CoefficientsError, match="8 × 8"):
        transform.inverse(cut)
    mixed = Coefficients(good.coarse.astype(np.float32), good.levels, good.image_shape)
    with pytest.raises(CoefficientsError, match="float32"):
        transform.inverse(mixed)
    with pytest.raises(LevelsError, match="7 × 8"):
        transform.adjoint(transform.forward(rng.standard_normal((7, 8))))


def test_map_changes_directional_bands_alone(rng):
    coefficients = Contourlet((2,)).forward(rng.standard_normal((8, 8)))
    silent = coefficients.map(np.zeros_like)
    np.testing.assert_array_equal(silent.coarse, coefficients.coarse)
    assert not any(band.any() for band in silent.levels[0])
