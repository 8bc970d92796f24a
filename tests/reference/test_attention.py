"""The saliency maps of the product against tests/reference/attention.py, step by step.

Each step of the reference gets the product's inputs of that step, so that one difference fails one test.
"""

from functools import cache

import numpy as np
import pytest
from reference import attention as reference
from reference.scenes import SCENES

from visuohaptic.attention import AttentionParameters, attend, conspicuity_maps, prepare_view
from visuohaptic.attention.plain_filters import plain_filters
from visuohaptic.fixations.parameters import RenderingParameters, ViewpointParameters
from visuohaptic.fixations.rendering import render_views
from visuohaptic.fixations.viewpoints import place_cameras
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface

# The product computes with float32: a plane with values up to 1 differs by some 1e-7 a step.
PLANE = 1e-6
# In the operator N a pixel becomes a maximum over a thousandth of the range, so a vote differs by a thousand times the
# rounding, 1e-4. N multiplies the whole map by the square of one minus the mean of the votes. Of the map's maximum:
MAP = 1e-3
# Faint differences are scaled up a hundredfold, to FAINT_PEAK.
FAINT = 1e-6
# Sums of maps, and one division by a maximum.
SALIENCY = 2e-6
# Rows of the view of each scene: enlarged, unchanged, and shrunk to the working image.
SIZES = {"torus off the centre": 128, "nine balls, one red": 256, "cup": 150, "stairs": 48}


@cache
def seen(name):
    """Return a scene's view, what the product computed of it, and its working image, conspicuity by channel."""
    scene = SCENES[name]
    number = 2 + 3 * (list(SCENES).index(name) % 5)
    camera = place_cameras(ViewpointParameters())[number]
    surface = Surface(scene.vertices, scene.faces, scene.colours)
    rendering = RenderingParameters(resolution=SIZES.get(name, 32))
    return look(RayCaster(surface), camera, rendering)


def look(caster, camera, rendering):
    views = render_views(caster, [camera], rendering)
    parameters = AttentionParameters()
    attended = attend(**views.attend_arguments(), parameters=parameters)[0]
    with plain_filters():  # as `attend` has it; other filters differ by 1e-5 of saliency
        working = prepare_view(views.colour[0], views.mask[0], views.curvature[0])
        maps = conspicuity_maps(working, tuple(attended.conspicuity), parameters)
    return views, attended, working, maps


def planes_of(working):
    """Return the product's working image as the reference has it."""
    red, green, blue = working.colour
    planes = {
        "certainty": working.certainty,
        "red": red,
        "green": green,
        "blue": blue,
        "intensity": working.intensity,
        "backdrop": working.backdrop,
        "curvature": working.curvature,
    }
    return {name: plane.astype(np.float64) for name, plane in planes.items()}


def check_working_image(views, working):
    expected = reference.prepare(
        views.colour[0].astype(np.float64), views.mask[0], views.curvature[0].astype(np.float64)
    )
    for name, plane in planes_of(working).items():
        np.testing.assert_allclose(plane, expected[name], rtol=0, atol=PLANE, err_msg=name)


def check_channels(views, attended, working, maps):
    running = reference.running_channels(views.colour[0], views.mask[0], views.curvature[0])
    assert list(attended.conspicuity) == running
    planes = planes_of(working)
    for channel in running:
        expected = reference.conspicuity(channel, planes)
        allowed = MAP * expected.max() + FAINT
        np.testing.assert_allclose(maps[channel], expected, rtol=0, atol=allowed, err_msg=channel)
        np.testing.assert_allclose(
            attended.conspicuity[channel],
            reference.to_view(maps[channel], views.mask[0], reference.linear),
            rtol=0,
            atol=PLANE,
            err_msg=channel,
        )


def check_saliency(views, attended, maps):
    expected = reference.saliency(maps, views.mask[0])
    np.testing.assert_allclose(attended.saliency, expected, rtol=0, atol=SALIENCY)


@pytest.mark.parametrize("name", SCENES)
def test_working_image(name):
    views, _, working, _ = seen(name)
    check_working_image(views, working)


@pytest.mark.parametrize("name", SCENES)
def test_conspicuity_of_each_channel(name):
    check_channels(*seen(name))


@pytest.mark.parametrize("name", SCENES)
def test_saliency_map(name):
    views, attended, _, maps = seen(name)
    check_saliency(views, attended, maps)


def test_saliency_map_with_weights():
    views, _, _, maps = seen("two parts")
    weights = {
        "colour": 0.25,
        "intensity": 2.0,
        "orientation": 0.5,
        "contrast": 3.0,
        "curvature": 1.5,
    }
    parameters = AttentionParameters(weights=weights)
    attended = attend(**views.attend_arguments(), parameters=parameters)[0]
    expected = reference.saliency(maps, views.mask[0], weights)
    np.testing.assert_allclose(attended.saliency, expected, rtol=0, atol=SALIENCY)
