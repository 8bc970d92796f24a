"""Views from within an object."""

import pytest
from numerics.hard_cases.attention import SIZE, judge_view
from numerics.recording import worst_of
from numerics.surfaces import ball, lopsided

from visuohaptic.attention.model import attend
from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.fixations.parameters import RenderingParameters
from visuohaptic.fixations.rendering import render_views
from visuohaptic.fixations.viewpoints import Camera
from visuohaptic.geometry.raycasting import RayCaster


@pytest.mark.parametrize("distance", [0.0, 1e-6, 0.3, 0.55, 0.9])
def test_a_camera_inside_the_object_sees_finite_things(recorder, distance):
    for surface in (ball(3), lopsided()):
        cameras = [Camera(azimuth, 20.0, distance, 40.0) for azimuth in (0.0, 135.0)]
        views = render_views(RayCaster(surface), cameras, RenderingParameters(resolution=SIZE))
        names = ("colour", "mask", "point", "normal", "face", "curvature")
        arrays = {name: getattr(views, name) for name in names}
        parameters = AttentionParameters()
        for row, found in enumerate(attend(**arrays, parameters=parameters)):
            view = {name: values[row : row + 1] for name, values in arrays.items()}
            label = f"camera at {distance:g} from the centre"
            recorder.take(map(worst_of, judge_view(view, found, label, parameters)))
