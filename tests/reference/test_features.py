"""Phase features against the reference, which gets the product's imprints, places and normals."""

from functools import cache

import numpy as np
import pytest
from reference import features as reference
from reference.touch_scenes import scenes

import contourlets
import visuohaptic as vh

# Some 200 sums and products per coefficient of values below 4: 1e-13 would be expected at worst.
DEVIATION = 1e-13
# Moments and least squares over 64 to 1,600 values of at most 1: 1e-13 in orthogonal terms. Steep quadrics
# with coefficients up to 4 lose a digit.
STATISTIC = 1e-12
BANDS = [f"contourlet_{band:02d}" for band in range(1, 17)]
STATISTICS = [
    *("imprint_mean", "imprint_deviation", "imprint_skewness", "imprint_empty", "imprint_contact"),
    *("imprint_bending", "imprint_saddle", "imprint_upright_bending"),
    *("imprint_tilt_columns", "imprint_tilt_rows", "imprint_roughness"),
    *("imprint_step_columns", "imprint_step_rows"),
]
POSE = ["x", "y", "z", "normal_x", "normal_y", "normal_z"]
CASES = {
    "cube": 32, "cup": 8, "torus": 16, "two boxes": 24, "spike": 32, "close plates": 8, "waves": 32,
    "fine relief": 16, "flat relief": 8, "blade": 32, "wide groove": 16, "leaning wall": 40,
}  # fmt: skip


@cache
def explored(scene):
    return vh.load(scenes()[scene]).touch(
        1, "random_anywhere", {"sensor.resolution": CASES[scene], "rendering.resolution": 64}
    )


@pytest.mark.parametrize("scene", CASES)
def test_features_are_those_of_the_reference(scene):
    exploration = explored(scene)
    touches, features = exploration.touches.to_pylist(), exploration.features.to_pylist()
    assert len(touches) == len(features) == 5
    for touch, row in zip(touches, features, strict=True):
        image = np.reshape(np.array(touch["image"], float), (CASES[scene], CASES[scene]))
        expected = reference.touch_features(
            image, [touch[name] for name in POSE[:3]], [touch[name] for name in POSE[3:]]
        )
        found = np.array([row[name] for name in BANDS + POSE])
        np.testing.assert_allclose(found[:16], expected[:16], rtol=0, atol=DEVIATION)
        np.testing.assert_array_equal(found[16:], expected[16:])
        statistics = reference.imprint_statistics(image)
        np.testing.assert_allclose(
            [row[name] for name in STATISTICS], statistics, rtol=0, atol=STATISTIC
        )
        assert row["sensor_size"] == touch["sensor_size"]
        assert row["contact_state"] == touch["contact_state"]
        assert {name: touch[name] for name in ("object", "viewpoint", "strategy", "touch")} == {
            name: row[name] for name in ("object", "viewpoint", "strategy", "touch")
        }


def test_scenes_have_imprints_with_and_without_relief():
    images = np.array(
        [
            image
            for scene in ("cube", "spike", "waves", "blade")
            for image in explored(scene).imprints
        ]
    )
    relief = np.ptp(images, axis=(1, 2))
    assert (relief == 0).sum() >= 3
    assert (relief > 0.5).sum() >= 5


@pytest.mark.parametrize("size", [8, 16, 24, 32, 40])
def test_bands_of_noise_are_those_of_the_reference(size):
    """An imprint lights few bands; noise lights all, and each value has its own place."""
    image = np.random.default_rng(size).random((size, size))
    coefficients = contourlets.Contourlet(levels=(4,)).forward(image)
    bands = reference.directional_bands(reference.detail_image(image))
    for found, expected in zip(coefficients.levels[0], bands, strict=True):
        assert found.shape == expected.shape
        np.testing.assert_allclose(found, expected, rtol=0, atol=DEVIATION)


@pytest.mark.parametrize("size", [8, 16, 32])
def test_every_pixel_reaches_the_bands_as_in_the_reference(size):
    """The transform is linear, so its matrix on a grid of single pixels shows every tap and every border."""
    transform = contourlets.Contourlet(levels=(4,))
    for pixel in np.random.default_rng(size).choice(size * size, 12, replace=False):
        image = np.zeros(size * size)
        image[pixel] = 1
        image = image.reshape(size, size)
        bands = reference.directional_bands(reference.detail_image(image))
        for found, expected in zip(transform.forward(image).levels[0], bands, strict=True):
            np.testing.assert_allclose(found, expected, rtol=0, atol=DEVIATION)
