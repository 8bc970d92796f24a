import numpy as np
import pytest

from contourlets import (
    EXTENSIONS,
    Contourlet,
    ImageError,
    LevelsError,
    band_deviations,
    band_energies,
    band_names,
    directional_deviations,
)


@pytest.fixture(scope="module")
def imprints():
    """Images with the features of imprints: a smooth bump, an edge, unequal borders, noise."""
    rng = np.random.default_rng(3)
    i, j = np.indices((32, 32)) / 31
    slopes = rng.uniform(-1, 1, (1000, 2, 1, 1))
    edges = (slopes[:, 0] * (i - 0.5) + slopes[:, 1] * (j - 0.5) > 0) * rng.random((1000, 1, 1))
    return slopes[:, 0] * i + np.square(j) + edges + 0.01 * rng.standard_normal((1000, 32, 32))


@pytest.mark.parametrize("extension", EXTENSIONS)
@pytest.mark.parametrize("directional", ["pkva", "haar"])
@pytest.mark.parametrize("directions_log2", [0, 1, 2, 3, 4, 5])
def test_deviations_and_energies_are_those_of_the_transforms_bands(
    extension, directional, directions_log2, imprints
):
    images = imprints[:5]
    transform = Contourlet((directions_log2,), "9-7", directional, extension)
    bands = transform.forward(images).levels[0]
    deviations = np.stack([band.reshape(5, -1).std(axis=1, ddof=1) for band in bands], axis=1)
    energies = np.stack([np.square(band).sum(axis=(1, 2)) for band in bands], axis=1)
    arguments = (directions_log2, "9-7", directional, extension)
    np.testing.assert_allclose(directional_deviations(images, *arguments), deviations, rtol=1e-11)
    found = band_energies(images, transform)
    np.testing.assert_allclose(found, energies, rtol=1e-11)
    faint = band_energies(np.ldexp(images, -400), transform)
    np.testing.assert_array_equal(faint, np.ldexp(found, -800))


@pytest.mark.parametrize("extension", EXTENSIONS)
def test_an_image_does_not_depend_on_its_batch(extension, imprints):
    whole = directional_deviations(imprints, extension=extension)
    shuffled = np.random.default_rng(1).permutation(len(imprints))
    for count in (1, 2, 3, 5, 7, 80):
        for chosen in (slice(count), slice(-count, None), shuffled[:count]):
            few = directional_deviations(imprints[chosen], extension=extension)
            np.testing.assert_array_equal(few, whole[chosen])


def test_large_images_do_not_depend_on_their_batch(rng):
    images = rng.standard_normal((6, 64, 96))
    transform = Contourlet((3, 4))
    whole = band_deviations(images, transform)
    assert whole.shape == (6, 24)
    for count in (1, 2, 5):
        np.testing.assert_array_equal(band_deviations(images[:count], transform), whole[:count])
    bands = transform.forward(images[0]).bands[1:]
    np.testing.assert_allclose(whole[0], [band.std(ddof=1) for band in bands], rtol=1e-12)


def test_memory_layout_and_type_do_not_matter(imprints):
    images = imprints[:9]
    expected = directional_deviations(images)
    np.testing.assert_array_equal(directional_deviations(np.asfortranarray(images)), expected)
    wide = np.zeros((9, 32, 64))
    wide[..., ::2] = images
    np.testing.assert_array_equal(directional_deviations(wide[..., ::2]), expected)
    single = directional_deviations(images.astype(np.float32))
    assert single.dtype == np.float64
    np.testing.assert_array_equal(
        single, directional_deviations(images.astype(np.float32).astype(np.float64))
    )
    before = images.copy()
    directional_deviations(images)
    np.testing.assert_array_equal(images, before)


@pytest.mark.parametrize("extension", EXTENSIONS)
def test_deviations_follow_scale_and_ignore_offset(extension, imprints):
    images = imprints[:3]
    expected = directional_deviations(images, extension=extension)
    # Near the root of the range squares would overflow or lose digits.
    for exponent in (-1000, -600, -511, -509, -300, -1, 3, 300, 509, 511, 600, 1000):
        scaled = directional_deviations(np.ldexp(images, exponent), extension=extension)
        np.testing.assert_array_equal(scaled, np.ldexp(expected, exponent))
    for scale in (1e150, 1e-150):
        scaled = directional_deviations(images * scale, extension=extension)
        np.testing.assert_allclose(scaled, expected * scale, rtol=1e-12)
    lifted = directional_deviations(images + 10, extension=extension)
    np.testing.assert_allclose(lifted, expected, atol=1e-11)
    tiny = directional_deviations(images * 1e-310, extension=extension)
    np.testing.assert_allclose(tiny / 1e-310, expected, rtol=1e-10)


@pytest.mark.parametrize("extension", EXTENSIONS)
def test_constant_images_have_no_deviation(extension):
    images = np.full((2, 32, 32), [[[1.0]], [[0.0]]])
    deviations = directional_deviations(images, extension=extension)
    assert deviations[0].max() < 1e-13
    np.testing.assert_array_equal(deviations[1], 0)


def test_names_count_levels_from_the_finest():
    coarse = [f"level2_band0{number}" for number in (1, 2)]
    fine = [f"level1_band0{number}" for number in (1, 2, 3, 4)]
    assert band_names(Contourlet((1, 2))) == coarse + fine


def test_shapes_follow_the_images(rng):
    transform = Contourlet((2,))
    assert band_deviations(rng.standard_normal((2, 3, 8, 8)), transform).shape == (2, 3, 4)
    assert band_energies(rng.standard_normal((8, 8)), transform).shape == (4,)
    assert directional_deviations(np.zeros((0, 32, 32))).shape == (0, 16)


def test_wrong_calls_are_refused():
    with pytest.raises(ImageError, match=r"\(n, rows, columns\), not \(32, 32\)"):
        directional_deviations(np.zeros((32, 32)))
    with pytest.raises(LevelsError, match=r"\(2,\) leave one"):
        directional_deviations(np.zeros((1, 2, 2)), 2)
