import numpy as np
import pytest
from contourlet_definition import PYRAMIDS, toolbox_pyramid

from contourlets import pyramid_filter_names, pyramid_filters
from contourlets.pyramid import analyse_pyramid


@pytest.mark.parametrize("name", PYRAMIDS)
@pytest.mark.parametrize("extension", ["periodic", "circular"])
@pytest.mark.parametrize("shape", [(32, 32), (16, 20), (4, 6), (2, 2)])
def test_periodic_pyramid_is_the_toolbox_pyramid(name, extension, shape, rng):
    image = rng.standard_normal(shape)
    coarse, detail = analyse_pyramid(image[..., None], pyramid_filters(name), extension)
    expected = toolbox_pyramid(image, name)
    np.testing.assert_allclose(coarse[..., 0], expected[0], atol=1e-13)
    np.testing.assert_allclose(detail[..., 0], expected[1], atol=1e-13)


@pytest.mark.parametrize("name", pyramid_filter_names())
def test_symmetric_pyramid_is_that_of_the_reflected_image(name, rng):
    filters = pyramid_filters(name)
    image = rng.standard_normal((16, 12))
    if filters.odd:
        mirrored = np.pad(image, ((0, 14), (0, 10)), mode="reflect")
    else:
        mirrored = np.pad(image, ((0, 16), (0, 12)), mode="symmetric")
    whole = analyse_pyramid(mirrored[..., None], filters, "periodic")
    coarse, detail = analyse_pyramid(image[..., None], filters, "symmetric")
    np.testing.assert_allclose(coarse, whole[0][:8, :6], atol=1e-13)
    np.testing.assert_allclose(detail, whole[1][:16, :12], atol=1e-13)
