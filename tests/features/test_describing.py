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
