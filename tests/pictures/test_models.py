"""Models of the page are thin, alike, and come back from their bytes."""

import gzip

import numpy as np
from report.synthetic import ball

from visuohaptic.geometry.surface import Surface
from visuohaptic.pictures.models import COORDINATE_STEPS, pack_model, thin
from visuohaptic.report.shown import faces_of_model


def test_a_thin_ball_is_still_a_ball_with_its_colours_and_a_small_one_stays_as_it_is():
    small = ball(4)
    assert thin(small, 1000) is small
    thinned = thin(ball(60), 1000)
    assert len(thinned.faces) <= 1000
    np.testing.assert_allclose(np.linalg.norm(thinned.vertices, axis=1), 1, atol=0.03)
    red = thinned.face_colours[:, 0] == 255
    sides = thinned.triangles.mean(axis=1)[:, 0]
    assert np.all(sides[red] < 0.1)
    assert np.all(sides[~red] > -0.1)


def test_a_packed_model_reads_back():
    whole = ball(6)
    # The first vertex belongs to no face.
    vertices = np.vstack([[[0, 0, 0]], whole.vertices])
    surface = Surface(vertices, whole.faces + 1, whole.face_colours)
    touches = np.random.default_rng(0).uniform(-1, 1, (7, 10))
    packed = pack_model(surface, touches, 1000)
    counts = [3 * packed["vertices"], 10 * packed["touches"], *2 * [3 * packed["faces"]]]
    kinds = [np.dtype(kind) for kind in ("<i2", "<i2", "<u4", "u1")]
    data, parts = gzip.decompress(packed["model"]), []
    for kind, count in zip(kinds, counts, strict=True):
        parts.append(np.frombuffer(data, kind, count))
        data = data[kind.itemsize * count :]
    assert data == b""
    vertices, poses, corners, colours = parts
    step = 1 / COORDINATE_STEPS
    corner_places = step * vertices.reshape(-1, 3)[corners.reshape(-1, 3)]
    np.testing.assert_allclose(corner_places, surface.triangles, atol=step)
    np.testing.assert_allclose(step * poses.reshape(-1, 10), touches, atol=step)
    np.testing.assert_array_equal(colours.reshape(-1, 3), surface.face_colours)


def test_the_pages_parts_fit_their_budgets():
    """12 objects of 16 views within 5 MB: a model each, 12 kB a view."""
    packed = pack_model(ball(60), np.random.default_rng(0).uniform(-1, 1, (160, 10)), 4000)
    model = 4 / 3 * len(packed["model"])
    assert 12 * (model + 16 * 12_000) < 5_000_000
    assert model < 120_000


def test_models_share_the_faces_of_the_page():
    faces = {objects: faces_of_model(objects) for objects in (0, 30, 60, 500)}
    assert faces == {0: 4000, 30: 4000, 60: 2000, 500: 1200}
