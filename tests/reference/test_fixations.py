"""The product's fixations on its own saliency maps, and their rows in the tables, against docs/attention.md."""

import io

import numpy as np
import pyarrow.compute as pc
import pytest
from PIL import Image
from reference import fixations as reference
from reference.scenes import SCENES
from reference.views import render, ring_of_eyes

import visuohaptic as vh
from visuohaptic.attention import AttentionParameters, attend, scan
from visuohaptic.fixations.parameters import RenderingParameters, ViewpointParameters
from visuohaptic.fixations.rendering import render_views
from visuohaptic.fixations.viewpoints import place_cameras
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface

COUNT = 5 + reference.SPARE
SIZES = {"torus": 96, "thin plate": 128, "cup": 160}


def attended(name):
    scene = SCENES[name]
    number = 1 + 3 * (list(SCENES).index(name) % 5)
    camera = place_cameras(ViewpointParameters())[number]
    surface = Surface(scene.vertices, scene.faces, scene.colours)
    rendering = RenderingParameters(resolution=SIZES.get(name, 32))
    views = render_views(RayCaster(surface), [camera], rendering)
    found = attend(**views.attend_arguments(), parameters=AttentionParameters(fixations=COUNT))[0]
    return views, found


def compare(views, found):
    expected = reference.scan(
        found.saliency.astype(np.float64), views.mask[0], views.point[0], COUNT
    )
    path = found.scanpath
    assert list(zip(path.rows, path.columns, strict=True)) == [
        (fixation.row, fixation.column) for fixation in expected
    ]
    for index, fixation in enumerate(expected):
        pixel = fixation.row, fixation.column
        np.testing.assert_array_equal(path.points[index], views.point[0][pixel])
        np.testing.assert_array_equal(path.normals[index], views.normal[0][pixel])
        assert path.faces[index] == views.face[0][pixel]
        assert path.saliency[index] == found.saliency[pixel]
    return expected


# Fixations that several pixels could have had: their drives differ by 1e-4 at most, on parts of even saliency. All other
# fixations have one winner.
TIES = {
    "ball of one colour": 10,
    "ball with a dark spot": 1,
    "torus": 1,
    "thin plate": 9,
    "nine balls": 4,
    "nine balls, one red": 4,
    "cone": 2,
    "sheet of mixed windings": 1,
    "one triangle": 12,
    "far corner": 1,
}


@pytest.mark.parametrize("name", SCENES)
def test_fixations_of_a_view(name):
    expected = compare(*attended(name))
    assert sum(fixation.tied > 1 for fixation in expected) == TIES.get(name, 0)


@pytest.mark.parametrize("falloff", [0.0, 0.5])
def test_fixations_with_a_focus_in_the_image(falloff):
    views, found = attended("cup")
    size = views.mask.shape[1]
    pixels = np.stack(np.mgrid[:size, :size], axis=-1).astype(np.float64)
    parameters = AttentionParameters(
        fixations=9, inhibition="image", focus_fraction=0.07, inhibition_falloff=falloff
    )
    path = scan(
        found.saliency, views.mask[0], views.point[0], views.normal[0], views.face[0], parameters
    )
    expected = reference.scan(
        found.saliency.astype(np.float64), views.mask[0], pixels, 9, 0.07 * size, falloff
    )
    assert list(zip(path.rows, path.columns, strict=True)) == [(f.row, f.column) for f in expected]


@pytest.mark.parametrize("seed", range(2))
def test_outline_margin_on_an_object_of_thick_and_thin_parts(seed):
    # Spots of all widths, and a corner at the edge of the view. Only pixels near the outline are salient, so that the
    # fixations show which of them are allowed: the margin has 2.56 pixels, its disk a radius of 3.
    size = 160
    generator = np.random.default_rng(seed)
    noise = generator.normal(size=(size, size))
    for _ in range(6):
        noise += sum(np.roll(noise, step, axis) for step in (-1, 1) for axis in (0, 1))
    mask = noise > 0
    mask[:20, :25] = True
    near = reference.distance_from_outline(mask) < 3
    saliency = (generator.uniform(0.5, 1, mask.shape) * (0.1 + 0.9 * near)).astype(np.float32)
    points = np.stack([*np.mgrid[:size, :size], 0 * mask], axis=-1) / 1.0
    parameters = AttentionParameters(fixations=32, focus_radius=4.0)
    path = scan(saliency, mask, points, points, points[..., 0].astype(np.int64), parameters)
    expected = reference.scan(saliency.astype(np.float64), mask, points, 32, 4.0)
    assert list(zip(path.rows, path.columns, strict=True)) == [(f.row, f.column) for f in expected]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "radius"),
    [("two parts", 0.2), ("ball in halves", 0.2), ("cone", 0.8)],  # the last has no five places
)
def test_tables_of_an_object(name, radius):
    scene = SCENES[name]
    size = 24
    # The sensor of the touches that follow is small, because no test here reads them.
    parameters = {
        "rendering.resolution": size,
        "sensor.resolution": 8,
        "attention.focus_radius": radius,
    }
    seen = vh.load((scene.vertices, scene.faces), key=f"solid/{name}").touch(
        viewpoints=2, parameters=parameters
    )
    surface = seen.surface
    for number, eye in enumerate(ring_of_eyes(2, 20.0, 3.0)):
        row = seen.views.filter(pc.field("viewpoint") == number).to_pylist()[0]
        np.testing.assert_allclose([row[f"eye_{axis}"] for axis in "xyz"], eye, atol=1e-12)
        expected = render(surface.vertices, surface.faces, surface.face_colours / 255.0, eye, size)
        # 8 bits: the nearest of 256 levels.
        picture = np.asarray(Image.open(io.BytesIO(row["view"])), dtype=np.float64)
        assert np.abs(picture - 255 * expected.colour).max() <= 0.5 + 1e-3

        camera = place_cameras(ViewpointParameters(count=2))[number]
        views = render_views(RayCaster(surface), [camera], RenderingParameters(resolution=size))
        found = attend(**views.attend_arguments(), parameters=AttentionParameters(fixations=COUNT))[
            0
        ]
        drawn = np.asarray(Image.open(io.BytesIO(row["saliency"])), dtype=np.float64)
        assert np.abs(drawn - 255 * found.saliency).max() <= 0.5 + 1e-3
        saliency = found.saliency.astype(np.float64)
        path = reference.scan(saliency, expected.mask, expected.point, COUNT, radius)
        assert (len(path) < 5) == (radius > 0.5)
        assert row["distinct_fixations"] == min(len(path), 5)
        rows = seen.fixations.filter(pc.field("viewpoint") == number).to_pylist()
        assert [(r["touch"], r["pixel_row"], r["pixel_column"], r["strategy"]) for r in rows] == [
            (touch, f.row, f.column, "fixation") for touch, f in enumerate(path)
        ]
        for fixation, r in zip(path, rows, strict=True):
            pixel = fixation.row, fixation.column
            assert r["face"] == expected.face[pixel]
            place = [r[axis] for axis in "xyz"]
            np.testing.assert_allclose(place, expected.point[pixel], rtol=0, atol=1e-12)
            normal = [r[f"normal_{axis}"] for axis in "xyz"]
            np.testing.assert_allclose(normal, expected.normal[pixel], rtol=0, atol=1e-12)
            assert r["saliency"] == found.saliency[pixel]
