"""The example of tactile images: formats, invariance, and its published figure on real ones."""

import importlib.util
import os
import struct
import zlib
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


WHOLE = np.rint(252 * pressed((3, 4), 3, (8, 8)))


@pytest.mark.parametrize(
    ("name", "values", "scale"),
    [
        ("a.tif", (WHOLE / 252).astype(np.float32), None),
        ("a.tif", WHOLE.astype(np.float32), 252),
        ("a.tif", WHOLE.astype(np.int32), 252),
        ("a.tif", (16 * WHOLE).astype(np.uint16), 16 * 252),
        ("a.png", np.rint(WHOLE / 252 * 65535).astype(np.uint16), None),
        ("a.pgm", np.rint(WHOLE / 252 * 65535).astype(np.uint16), None),
        (
            "a.png",
            np.repeat(np.rint(WHOLE / 252 * 255).astype(np.uint8)[..., None], 3, axis=2),
            None,
        ),
        ("a.bmp", np.rint(WHOLE / 252 * 255).astype(np.uint8), None),
    ],
)
def test_readings_of_every_width_are_shares_of_their_full_scale(
    example, tmp_path, name, values, scale
):
    written(tmp_path, f"class/{name}", values)
    (image,), _ = example.read_tactile_images(tmp_path, scale)
    np.testing.assert_allclose(image, WHOLE / 252, atol=0.5 / 255)


@pytest.mark.parametrize(
    ("values", "says"),
    [
        (np.full((8, 8), 1.5, np.float32), "readings from 1.5 to 1.5"),
        (np.full((8, 8), np.nan, np.float32), "readings from nan"),
        (np.full((8, 8), -0.1, np.float32), "readings from -0.1"),
        (np.zeros((8, 8), np.int32), "32 bits a taxel"),
        (np.zeros((8, 8, 4), np.uint8), "is transparent"),
        (np.zeros((8, 9), np.uint8), "8 × 9 taxels and .* has 8 × 8"),
    ],
)
def test_images_of_unknown_scale_or_another_size_are_refused(example, tmp_path, values, says):
    with pytest.raises(ValueError, match="holds no <class>/<image>"):
        example.read_tactile_images(tmp_path)
    written(tmp_path, "a/1.png", np.zeros((8, 8), np.uint8))
    written(tmp_path, "b/2.tif", values)
    with pytest.raises(ValueError, match=rf"2\.tif .*{says}"):
        example.read_tactile_images(tmp_path)


def test_an_image_of_several_pages_or_that_is_none_is_refused(example, tmp_path):
    (tmp_path / "a").mkdir()
    pages = [Image.new("L", (8, 8), shade) for shade in (0, 100)]
    pages[0].save(tmp_path / "a/1.tif", save_all=True, append_images=pages[1:])
    with pytest.raises(ValueError, match=r"1\.tif has 2 pages"):
        example.read_tactile_images(tmp_path)
    (tmp_path / "a/1.tif").write_text("no image")
    with pytest.raises(ValueError, match=r"1\.tif can't be read as an image"):
        example.read_tactile_images(tmp_path)
    with pytest.raises(ValueError, match="full_scale is 0"):
        example.read_tactile_images(tmp_path, 0)


@pytest.mark.parametrize("side", [12_000, 20_000])
def test_images_are_refused_by_their_size_before_they_are_unpacked(
    example, tmp_path, monkeypatch, side
):
    monkeypatch.setattr(Image.Image, "load", None)
    (tmp_path / "a").mkdir()
    header = struct.pack(">II5B", side, side, 8, 0, 0, 0, 0)
    chunk = b"IHDR" + header
    (tmp_path / "a/1.png").write_bytes(
        b"\x89PNG\r\n\x1a\n"
        + struct.pack(">I", 13)
        + chunk
        + struct.pack(">I", zlib.crc32(chunk))
        + struct.pack(">I", 4)
        + b"IDAT"
        + bytes(4)
        + struct.pack(">I", zlib.crc32(b"IDAT" + bytes(4)))
    )
    with pytest.raises(ValueError, match=r"1\.png (has|can't be read)"):
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
