"""`visuohaptic images`: features of tactile images of any size, and random splits of single images."""

import json

import numpy as np
import pyarrow.parquet as pq
import pytest
from features.pressed_images import pressed, written

from visuohaptic.cli.tactile_images import (
    describe_tactile_images,
    read_tactile_images,
    split_accuracies,
)
from visuohaptic.errors import RecognitionError


def test_images_are_read_by_class_and_scaled_to_one(tmp_path):
    written(tmp_path, "ball", "b.png", pressed((9, 15), 4))
    written(tmp_path, "ball", "a.png", np.ones((20, 37)), bits=16)
    written(tmp_path, "arm", "c.bmp", np.zeros((20, 37)))
    read = read_tactile_images(tmp_path)
    assert read.classes == ("arm", "ball", "ball")
    assert read.names == ("c.bmp", "a.png", "b.png")
    assert read.images.shape == (3, 20, 37)
    assert read.images[1].min() == read.images[1].max() == 1
    np.testing.assert_allclose(read.images[2], pressed((9, 15), 4), atol=1 / 255)


def test_a_folder_without_images_or_with_broken_or_unlike_ones_is_refused(tmp_path):
    with pytest.raises(RecognitionError, match="holds no <class>/<image>"):
        read_tactile_images(tmp_path)
    written(tmp_path, "a", "1.png", np.ones((8, 8)))
    written(tmp_path, "b", "2.png", np.ones((8, 9)))
    with pytest.raises(RecognitionError, match=r"has 8 × 9 taxels and .* has 8 × 8"):
        read_tactile_images(tmp_path)
    (tmp_path / "b" / "2.png").write_bytes(b"none")
    with pytest.raises(RecognitionError, match="can't be read as an image"):
        read_tactile_images(tmp_path)


@pytest.mark.parametrize("size", [(4, 4), (28, 50), (61, 5)])
def test_images_of_any_size_have_the_same_finite_features(size):
    images = np.random.default_rng(0).random((3, *size))
    groups = describe_tactile_images(images)
    assert [one.shape for one in groups.values()] == [(3, k) for k in (28, 4, 16, 18, 276)]
    assert all(np.isfinite(values).all() for values in groups.values())


def test_an_image_is_described_by_itself_alone_and_an_empty_one_too():
    images = np.stack([pressed((9, 15), 4), np.zeros((20, 37)), pressed((5, 25), 3)])
    together = describe_tactile_images(images)
    for place in range(3):
        alone = describe_tactile_images(images[place : place + 1])
        for name, values in together.items():
            np.testing.assert_allclose(values[place], alone[name][0], rtol=1e-12, atol=1e-12)


def test_a_shift_changes_neither_pressure_nor_shape():
    places = (9, 12), (11, 20)
    first, moved = (describe_tactile_images(pressed(one, 4)[None]) for one in places)
    for name in ("pressure", "ordered", "shape"):
        np.testing.assert_allclose(first[name], moved[name], rtol=1e-9, atol=1e-9)


def test_levels_set_the_number_of_bands():
    images = np.random.default_rng(0).random((2, 28, 50))
    assert describe_tactile_images(images, (3, 4))["contourlet"].shape == (2, 8 + 16)


def blobs(separation, classes=4, images=20):
    generator = np.random.default_rng(0)
    labels = np.repeat(np.arange(classes), images)
    centres = separation * generator.normal(size=(classes, 6))
    rows = centres[labels] + generator.normal(size=(len(labels), 6))
    noise = generator.normal(size=(len(labels), 200))
    return {"few": rows, "noise": noise}, [f"class{label}" for label in labels]


def test_classes_that_lie_apart_are_separated_also_beside_a_wide_group_of_noise():
    groups, classes = blobs(5.0)
    assert split_accuracies(groups, classes, 5, 0.8, np.random.default_rng(0)).mean() > 0.95
    groups, classes = blobs(0.0)
    found = split_accuracies(groups, classes, 20, 0.8, np.random.default_rng(0))
    assert found.shape == (20,)
    assert 0.1 < found.mean() < 0.4


def test_too_few_images_or_classes_are_refused():
    groups, classes = blobs(1.0, classes=2, images=2)
    with pytest.raises(RecognitionError, match="class0 has 2 images, which can't be divided"):
        split_accuracies(groups, classes, 1, 0.8, np.random.default_rng(0))
    with pytest.raises(RecognitionError, match="one class"):
        split_accuracies(groups, ["a"] * 4, 1, 0.8, np.random.default_rng(0))


def test_a_folder_becomes_a_table_and_is_classified(visuohaptic, tmp_path):
    generator = np.random.default_rng(0)
    for number in range(10):
        for kind, radius in (("small", 2), ("large", 6)):
            centre = generator.uniform(6, 12), generator.uniform(6, 30)
            written(tmp_path / "in", kind, f"{number}.png", pressed(centre, radius))
    ended = visuohaptic("images", "in", "--out", "f.parquet", "--splits", 3, "--json")
    values = json.loads(ended.out)
    assert [values[name] for name in ("images", "classes", "rows", "columns")] == [20, 2, 20, 37]
    assert values["accuracy"] == 1
    table = pq.read_table(tmp_path / "f.parquet")
    assert table.column_names[:3] == ["class", "image", "contourlet_01"]
    assert table.column("image").to_pylist()[:2] == ["0.png", "1.png"]


def test_wrong_levels_and_folders_are_refused(visuohaptic, tmp_path):
    assert visuohaptic("images", tmp_path, "--levels", "x").code == 2
    assert visuohaptic("images", tmp_path).code == 1
