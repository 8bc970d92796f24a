"""Pictures keep what they show, and stay small."""

import io

import numpy as np
import pyarrow as pa
import pytest
from PIL import Image
from report.synthetic import png

from visuohaptic.fixations.viewpoints import Camera
from visuohaptic.report.pictures import imprint_sheet, imprint_strip, picture_size, shrink_picture
from visuohaptic.report.projecting import project, squares_in_view


def decoded(data):
    return np.asarray(Image.open(io.BytesIO(data)).convert("RGB"))


@pytest.mark.parametrize("projection", ["perspective", "orthographic"])
def test_projecting_undoes_casting(projection):
    camera = Camera(30.0, 20.0, 3.0, 40.0, projection)
    origins, directions = camera.rays(16)
    places = project(camera, origins + 2.7 * directions, 16)
    rows, columns = np.divmod(np.arange(256), 16)
    np.testing.assert_allclose(places, np.column_stack([columns, rows]) + 0.5, atol=1e-9)


def test_squares_have_the_size_of_the_sensor_and_lie_around_their_touch():
    camera = Camera(0.0, 0.0, 3.0, 40.0, "orthographic")
    columns = {"x": 0.1, "y": 0.2, "z": 0.9, "normal_x": 0.0, "normal_y": 0.0, "normal_z": 1.0}
    columns |= {"tangent_x": 1.0, "tangent_y": 0.0, "tangent_z": 0.0, "sensor_size": 0.3}
    touch = pa.table({name: [value] for name, value in columns.items()})
    (corners,) = squares_in_view(camera, touch, 100)
    unit = 100 / (2 * np.tan(np.radians(20)) * 3.0)
    edges = np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1)
    np.testing.assert_allclose(edges, 4 * [0.3 * unit])
    np.testing.assert_allclose(corners.mean(axis=0), [50 + 0.1 * unit, 50 - 0.2 * unit])
    np.testing.assert_allclose(corners[0], [50 - 0.05 * unit, 50 - 0.35 * unit])


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
