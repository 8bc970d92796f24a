"""Pictures keep what they show, and stay small."""

import io

import numpy as np
from PIL import Image
from report.synthetic import png

from visuohaptic.pictures.encoding import imprint_sheet, imprint_strip, picture_size, shrink_picture


def decoded(data):
    return np.asarray(Image.open(io.BytesIO(data)).convert("RGB"))


def test_imprints_lie_side_by_side_without_loss():
    imprints = np.random.default_rng(0).random((5, 32, 32), dtype=np.float32)
    strip = decoded(imprint_strip(imprints))
    assert strip.shape == (32, 160, 3)
    np.testing.assert_array_equal(strip[:, 64:96, 0], np.rint(255 * imprints[2]).astype(np.uint8))


def test_a_view_shrinks_and_still_looks_alike():
    ramp = np.add.outer(np.arange(256), np.arange(256)) // 2
    picture = np.stack([ramp, 255 - ramp, np.full((256, 256), 90)], axis=-1).astype(np.uint8)
    data = shrink_picture(png(picture))
    assert picture_size(data) == (256, 256)
    assert len(data) < 6000
    assert np.abs(decoded(data).astype(int) - picture).mean() < 3


def test_a_sheet_has_each_imprint_in_its_cell():
    imprints = np.stack([np.full((16, 16), level, np.float32) for level in (0.25, 0.5, 1.0)])
    sheet = decoded(imprint_sheet(imprints, np.array([0, 2, 1]), np.array([1, 0, 1])))
    assert sheet.shape == (48, 32, 3)
    cells = sheet[..., 0].reshape(3, 16, 2, 16)[:, 4:-4, :, 4:-4].mean(axis=(1, 3))
    np.testing.assert_allclose(cells, [[0, 64], [0, 255], [128, 0]], atol=6)
