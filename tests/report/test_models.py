"""Models of the page are thin, alike, and come back from their bytes."""

import base64
import gzip
import itertools

import numpy as np
from report.synthetic import ball

from visuohaptic.report.models import COORDINATE_STEPS, pack_model, plotly_library, thin


def test_a_thin_ball_is_still_a_ball_with_its_colours():
    surface = ball(60)
    thinned = thin(surface, 1000)
    assert len(surface.faces) > 10_000
    assert len(thinned.faces) <= 1000
    radii = np.linalg.norm(thinned.vertices, axis=1)
    assert radii.min() > 0.97
    assert radii.max() < 1.03
    red = thinned.face_colours[:, 0] == 255
    sides = thinned.triangles.mean(axis=1)[:, 0]
    assert np.all(sides[red] < 0.1)
    assert np.all(sides[~red] > -0.1)


def test_a_small_surface_stays_as_it_is():
    surface = ball(4)
    assert thin(surface, 1000) is surface


def test_a_packed_model_reads_back():
    surface = ball(6)
    touches = np.random.default_rng(0).uniform(-1, 1, (7, 10))
    packed = pack_model(surface, touches, 1000)
    data = gzip.decompress(base64.b64decode(packed.text))
    sizes = [6 * packed.vertices, 20 * packed.touches, 12 * packed.faces, 3 * packed.faces]
    assert len(data) == sum(sizes)
    bounds = np.cumsum([0, *sizes])
    parts = [data[start:end] for start, end in itertools.pairwise(bounds)]
    vertices = np.frombuffer(parts[0], "<i2").reshape(-1, 3) / COORDINATE_STEPS
    corners = np.frombuffer(parts[2], "<u4").reshape(-1, 3)
    np.testing.assert_allclose(vertices[corners], surface.triangles, atol=1 / COORDINATE_STEPS)
    np.testing.assert_allclose(
        np.frombuffer(parts[1], "<i2").reshape(-1, 10) / COORDINATE_STEPS,
        touches,
        atol=1 / COORDINATE_STEPS,
    )
    np.testing.assert_array_equal(
        np.frombuffer(parts[3], "u1").reshape(-1, 3), surface.face_colours
    )


def test_the_pages_parts_fit_their_budgets():
    """12 objects of 16 views within 10 MB: the library once, a model each, 12 kB a view."""
    model = pack_model(ball(60), np.random.default_rng(0).uniform(-1, 1, (160, 10)), 4000)
    library = len(plotly_library().packed)
    assert library + 12 * (len(model.text) + 16 * 12_000) < 10_000_000
    assert library + 142 * 60_000 < 25_000_000
    assert len(model.text) < 120_000
