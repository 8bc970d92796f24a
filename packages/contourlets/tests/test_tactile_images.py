"""The example of tactile images: formats, invariance, and its published figure on real ones."""

import importlib.util
import os
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

EXAMPLE = Path(__file__).parents[1] / "examples/tactile_images.py"
REAL = os.environ.get("TACTILE_IMAGES")


@pytest.fixture(scope="module")
def example():
    spec = importlib.util.spec_from_file_location("tactile_images", EXAMPLE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def pressed(centre, radius, size=(20, 37)):
    y, x = np.mgrid[: size[0], : size[1]]
    return np.clip(1.2 - np.hypot(y - centre[0], x - centre[1]) / radius, 0, 1)


def written(folder, name, values):
    (folder / name).parent.mkdir(exist_ok=True)
    Image.fromarray(values).save(folder / name)


def test_images_of_8_and_16_bits_are_read_by_class_as_shares_of_the_full_scale(example, tmp_path):
    values = pressed((9, 15), 4)
    written(tmp_path, "ball/b.png", np.rint(255 * values).astype(np.uint8))
    written(tmp_path, "arm/a.tif", np.rint(65535 * values).astype(np.uint16))
    images, classes = example.read_tactile_images(tmp_path)
    assert classes == ["arm", "ball"]
    np.testing.assert_allclose(images[0], values, atol=0.5 / 65535)
    np.testing.assert_allclose(images[1], values, atol=0.5 / 255)


@pytest.mark.parametrize(
    ("values", "says"),
    [
        (np.zeros((8, 8), np.float32), "32 bits a taxel"),
        (np.zeros((8, 8), np.int32), "32 bits a taxel"),
        (np.zeros((8, 9), np.uint8), "8 × 9 taxels and .* has 8 × 8"),
    ],
)
def test_images_of_unknown_scale_or_another_size_are_refused(example, tmp_path, values, says):
    with pytest.raises(ValueError, match="holds no <class>/<image>"):
        example.read_tactile_images(tmp_path)
    written(tmp_path, "a/1.png", np.zeros((8, 8), np.uint8))
    written(tmp_path, "b/2.tif", values)
    with pytest.raises(ValueError, match=says):
        example.read_tactile_images(tmp_path)


@pytest.mark.parametrize("size", [(4, 4), (28, 50), (61, 5)])
def test_images_of_any_size_have_the_same_finite_features(example, size):
    groups = example.describe(np.random.default_rng(0).random((3, *size)))
    assert [values.shape for values in groups.values()] == [(3, k) for k in (28, 4, 16, 18, 276)]
    assert all(np.isfinite(values).all() for values in groups.values())


def test_a_shift_changes_neither_pressure_nor_shape(example):
    first, moved = (example.describe(pressed(place, 4)[None]) for place in ((9, 12), (11, 20)))
    for name in ("pressure", "ranks", "shape"):
        np.testing.assert_allclose(first[name], moved[name], rtol=1e-9, atol=1e-9)


def test_small_and_large_contacts_are_told_apart_and_chance_is_not_beaten(example):
    generator = np.random.default_rng(0)
    places = [(generator.uniform(6, 12), generator.uniform(6, 30)) for _ in range(40)]
    images = np.array([pressed(place, 2 + 4 * (k % 2)) for k, place in enumerate(places)])
    groups, classes = example.describe(images), ["small", "large"] * 20
    assert example.split_accuracies(groups, classes, 5).mean() == 1
    drawn = generator.permutation(classes).tolist()
    assert 0.3 < example.split_accuracies(groups, drawn, 20).mean() < 0.7


@pytest.mark.slow
@pytest.mark.skipif(not REAL, reason="TACTILE_IMAGES names no folder of the published images")
def test_the_published_images_are_classified_as_published(example):
    images, classes = example.read_tactile_images(REAL)
    assert images.shape == (1100, 28, 50)
    shares = 100 * example.split_accuracies(example.describe(images), classes)
    # One of 220 test images in one of 20 splits is 0.02 points.
    assert shares.mean() == pytest.approx(94.2, abs=0.1)
    assert shares.std(ddof=1) == pytest.approx(1.1, abs=0.1)
