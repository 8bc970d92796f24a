import numpy as np
import pytest
from contourlet_definition import frequency_directions

from contourlets import NonsubsampledContourlet
from contourlets.lattice import directional_tables


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
    transforms = (
        NonsubsampledContourlet((3,), directional_filter="pkva6", extension=extension)
        for extension in ("periodic", "symmetric")
    )
    periodic, symmetric = (transform.forward(image) for transform in transforms)
    for a, b in zip(periodic.bands, symmetric.bands, strict=True):
        np.testing.assert_allclose(a[70:-70, 70:-70], b[70:-70, 70:-70], atol=1e-13)
