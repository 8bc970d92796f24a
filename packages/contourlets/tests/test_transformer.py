import numpy as np
import pytest
from sklearn.base import clone
from sklearn.exceptions import NotFittedError

from contourlets import (
    Contourlet,
    ImageError,
    LevelsError,
    band_energies,
    directional_deviations,
    wavelet_deviations,
)
from contourlets.transformer import ContourletDeviations, WaveletDeviations


def test_transformer_gives_named_deviations(rng):
    images = rng.standard_normal((6, 32, 32))
    transformer = ContourletDeviations().fit(images)
    np.testing.assert_array_equal(transformer.transform(images), directional_deviations(images))
    names = transformer.get_feature_names_out()
    assert names.shape == (16,)
    assert (names[0], names[15]) == ("level1_band01_deviation", "level1_band16_deviation")


def test_transformer_gives_energies(rng):
    images = rng.standard_normal((6, 32, 32))
    transformer = ContourletDeviations((2, 3), statistic="energy", extension="symmetric")
    expected = band_energies(images, Contourlet((2, 3), extension="symmetric"))
    np.testing.assert_array_equal(transformer.fit_transform(images), expected)
    assert transformer.get_feature_names_out()[4] == "level1_band01_energy"


def test_wavelet_transformer_gives_named_deviations(rng):
    images = rng.standard_normal((4, 32, 32))
    transformer = WaveletDeviations("db2", levels=2)
    expected = wavelet_deviations(images, "db2", 2)
    np.testing.assert_array_equal(transformer.fit_transform(images), expected)
    assert transformer.get_feature_names_out()[0] == "level2_horizontal_deviation"


def test_wrong_use_is_refused(rng):
    images = rng.standard_normal((2, 32, 32))
    with pytest.raises(NotFittedError):
        ContourletDeviations().transform(images)
    with pytest.raises(LevelsError, match="9"):
        ContourletDeviations((9,)).fit(images)
    with pytest.raises(ImageError, match="'entropy'"):
        ContourletDeviations(statistic="entropy").fit(images)
    with pytest.raises(ImageError, match=r"32 × 32 and .* images of 16 × 16"):
        ContourletDeviations().fit(images).transform(images[:, :16, :16])
    with pytest.raises(ImageError, match=r"\(2, 1024\)"):
        ContourletDeviations().fit(images.reshape(2, -1))


def test_a_clone_names_the_columns_of_a_frame(rng):
    transformer = clone(ContourletDeviations((3,))).set_output(transform="pandas")
    frame = transformer.fit_transform(rng.standard_normal((6, 16, 24)))
    assert frame.columns[7] == "level1_band08_deviation"
