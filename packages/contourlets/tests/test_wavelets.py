import numpy as np
import pytest
import pywt

from contourlets import FilterError, LevelsError, wavelet_band_names, wavelet_deviations


@pytest.mark.parametrize(("wavelet", "levels"), [("db2", 3), ("bior4.4", 1)])
@pytest.mark.parametrize("mode", ["periodization", "symmetric"])
def test_deviations_are_those_of_pywavelets_bands(wavelet, levels, mode, rng):
    images = rng.standard_normal((3, 32, 32))
    found = wavelet_deviations(images, wavelet, levels, mode)
    for row, image in zip(found, images, strict=True):
        details = pywt.wavedec2(image, wavelet, mode, levels)[1:]
        expected = [band.std(ddof=1) for level in details for band in level]
        np.testing.assert_allclose(row, expected, rtol=1e-12)


def test_names_say_which_structure_a_band_answers_to():
    i, j = np.indices((32, 32))
    stripes = {"horizontal": (-1.0) ** i, "vertical": (-1.0) ** j, "diagonal": (-1.0) ** (i + j)}
    names = wavelet_band_names(1)
    for name, image in stripes.items():
        faded = image * np.linspace(0, 1, 32)[:, None] * np.linspace(1, 2, 32)
        assert names[wavelet_deviations(faded, "db2", 1).argmax()] == f"level1_{name}"


def test_images_do_not_depend_on_their_batch_and_scale_alike(rng):
    images = rng.standard_normal((20, 32, 32))
    whole = wavelet_deviations(images)
    assert whole.shape == (20, len(wavelet_band_names())) == (20, 9)
    np.testing.assert_array_equal(wavelet_deviations(images[3:4]), whole[3:4])
    np.testing.assert_array_equal(
        wavelet_deviations(np.ldexp(images, -1000)), np.ldexp(whole, -1000)
    )


@pytest.mark.parametrize(
    ("arguments", "error", "culprit"),
    [
        (("morl",), FilterError, "'morl'"),
        (("db2", 3, "wrap"), FilterError, "'wrap'; the names are"),
        (("db2", 0), LevelsError, "not 0"),
        (("db1", 3), LevelsError, "8 × 8"),
    ],
)
def test_wrong_calls_are_refused(arguments, error, culprit):
    with pytest.raises(error, match=culprit):
        wavelet_deviations(np.ones((1, 8, 8)), *arguments)
