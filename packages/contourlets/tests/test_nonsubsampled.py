import numpy as np
import pytest
from contourlet_definition import check_grating_sweep, frequency_directions, special_images

from contourlets import NonsubsampledContourlet
from contourlets.lattice import directional_tables

EXTENSIONS = ["periodic", "symmetric"]


@pytest.mark.parametrize("extension", EXTENSIONS)
@pytest.mark.parametrize("directional", ["pkva", "pkva6", "haar"])
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_reconstruction_is_perfect(extension, directional, dtype, rng):
    tolerance = {np.float64: 1e-12, np.float32: 1e-5}[dtype]
    for pyramid in ["9-7", "haar", "bior3.3"]:
        for levels, shape in [
            ((4,), (32, 32)),
            ((3, 2), (17, 24)),
            ((0, 1), (5, 2)),
            ((5,), (16, 9)),
        ]:
            images = np.stack(list(special_images(shape, rng).values())).astype(dtype)
            transform = NonsubsampledContourlet(levels, pyramid, directional, extension)
            rebuilt = transform.inverse(transform.forward(images))
            assert rebuilt.dtype == dtype
            error = np.abs(rebuilt - images).max() / np.abs(images).max()
            assert error < tolerance, (pyramid, levels, shape)


@pytest.mark.parametrize("scale", [1e150, 1e-150, 1e-310])
def test_reconstruction_is_perfect_at_the_ends_of_the_range(scale, rng):
    image = rng.uniform(-1, 1, (16, 16)) * scale
    transform = NonsubsampledContourlet((3,), extension="symmetric")
    error = np.abs(transform.inverse(transform.forward(image)) - image).max() / scale
    assert error < 1e-12


@pytest.mark.parametrize("directional", ["pkva", "haar"])
@pytest.mark.parametrize("pyramid", ["9-7", "haar"])
def test_commutes_with_circular_shifts(directional, pyramid, rng):
    image = rng.standard_normal((24, 30))
    transform = NonsubsampledContourlet((2, 4), pyramid, directional)
    original = transform.forward(image)
    for shift in [(1, 0), (0, 1), (7, -11)]:
        moved = transform.forward(np.roll(image, shift, (0, 1)))
        for band, other in zip(original.bands, moved.bands, strict=True):
            assert band.shape == image.shape
            np.testing.assert_allclose(other, np.roll(band, shift, (0, 1)), atol=1e-10)


@pytest.mark.parametrize("depth", range(6))
def test_sampled_bands_are_those_of_the_decimated_bank(depth, rng):
    """Noble identities: filtering and then sampling equals sampling and then filtering."""
    image = rng.standard_normal((32, 64))
    transform = NonsubsampledContourlet((depth,), "5-3")
    coefficients = transform.forward(image)
    smooth = np.convolve([-1, 2, 6, 2, -1], [1, 2, 1]) / 32

    def spread(x, axis):
        return sum(t * np.roll(x, k - 3, axis) for k, t in enumerate(smooth))

    detail = image - spread(spread(image, 0), 1)
    expected = frequency_directions(detail, depth, "pkva")
    pixels = directional_tables((32, 64), depth, "pkva", "circular").bands
    for band, place, reference in zip(coefficients.levels[0], pixels, expected, strict=True):
        sampled = 2 ** (depth / 2) * band.ravel()[place]
        np.testing.assert_allclose(sampled, reference, atol=1e-12)


def test_symmetric_and_periodic_agree_away_from_the_borders(rng):
    image = rng.standard_normal((160, 160))
    periodic, symmetric = (
        NonsubsampledContourlet((3,), directional_filter="pkva6", extension=extension).forward(
            image
        )
        for extension in EXTENSIONS
    )
    for a, b in zip(periodic.bands, symmetric.bands, strict=True):
        np.testing.assert_allclose(a[70:-70, 70:-70], b[70:-70, 70:-70], atol=1e-13)


@pytest.mark.parametrize("extension", EXTENSIONS)
def test_constant_images_leak_rounding_alone(extension):
    coefficients = NonsubsampledContourlet((3, 4), extension=extension).forward(np.ones((32, 32)))
    np.testing.assert_allclose(coefficients.coarse, 1, rtol=1e-12)
    assert max(np.abs(band).max() for band in coefficients.bands[1:]) < 1e-13


@pytest.mark.slow
@pytest.mark.parametrize("extension", EXTENSIONS)
@pytest.mark.parametrize("directions_log2", [3, 4])
def test_the_band_of_a_gratings_direction_is_the_strongest(extension, directions_log2):
    transform = NonsubsampledContourlet((directions_log2,), extension=extension)
    check_grating_sweep(transform, 96, 0.6)
