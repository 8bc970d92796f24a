import numpy as np
import pytest
from contourlet_definition import PYRAMIDS, toolbox_pyramid

from contourlets import EXTENSIONS, pyramid_filter_names, pyramid_filters
from contourlets.pyramid import adjoin_pyramid, analyse_pyramid, synthesise_pyramid


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


@pytest.mark.parametrize("name", pyramid_filter_names())
@pytest.mark.parametrize("extension", EXTENSIONS)
def test_synthesis_undoes_analysis_and_adjoint_is_the_transpose(name, extension, rng):
    filters = pyramid_filters(name)
    images = rng.standard_normal((12, 8, 2))
    coarse, detail = analyse_pyramid(images, filters, extension)
    rebuilt = synthesise_pyramid(coarse, detail, filters, extension)
    np.testing.assert_allclose(rebuilt, images, atol=4e-13)
    other = [rng.standard_normal(part.shape) for part in (coarse, detail)]
    product = float((coarse * other[0]).sum() + (detail * other[1]).sum())
    transposed = float((adjoin_pyramid(*other, filters, extension) * images).sum())
    assert transposed == pytest.approx(product, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("name", ["9-7", "haar"])
@pytest.mark.parametrize("extension", EXTENSIONS)
def test_dual_frame_projects_coefficients_that_belong_to_no_image(name, extension, rng):
    """The inverse is a projection: noise that belongs to no image is partly removed."""
    filters = pyramid_filters(name)
    coarse, detail = rng.standard_normal((4, 4, 1)), rng.standard_normal((8, 8, 1))
    image = synthesise_pyramid(coarse, detail, filters, extension)
    again = synthesise_pyramid(*analyse_pyramid(image, filters, extension), filters, extension)
    np.testing.assert_allclose(again, image, atol=1e-12)
