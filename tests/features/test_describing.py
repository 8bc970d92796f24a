import numpy as np
import pytest

from visuohaptic.errors import ParameterError
from visuohaptic.features.describing import describe_imprints
from visuohaptic.features.parameters import FeatureParameters


@pytest.mark.parametrize("resolution", [2, 4, 12, 34, 255, 256, 3, 5, 7, 8, 9, 16, 23, 24, 40])
def test_resolutions_that_the_contourlet_cannot_divide_are_refused_in_one_sentence(resolution):
    imprints = np.random.default_rng(0).random((1, resolution, resolution), np.float32)
    if resolution % 8 == 0 or resolution % 2:
        assert describe_imprints(imprints, FeatureParameters()).shape == (1, 16)
        return
    sentence = (
        rf"^sensor\.resolution is {resolution}; multiples of 8, and odd numbers from 3 on, .*\.$"
    )
    with pytest.raises(ParameterError, match=sentence):
        describe_imprints(imprints, FeatureParameters())


def test_levels_choose_the_bands_and_the_default_is_one_level_of_sixteen():
    from contourlets import directional_deviations

    imprints = np.random.default_rng(0).random((3, 32, 32), np.float32)
    one = describe_imprints(imprints, FeatureParameters())
    np.testing.assert_array_equal(one, directional_deviations(imprints, 4, "9-7", "pkva12"))
    several = describe_imprints(imprints, FeatureParameters(levels=(2, 2, 3)))
    assert several.shape == (3, 16)
    assert describe_imprints(imprints, FeatureParameters(levels=(2, 3))).shape == (3, 12)


def test_more_bands_than_columns_are_refused():
    with pytest.raises(ValueError, match="28 bands are more than the 16"):
        FeatureParameters(levels=(2, 3, 4))
