import numpy as np
import pytest

from visuohaptic.scene import PRESETS, Scene
from visuohaptic.sensor import SensorParameters, hard_probes, touch_gallery


@pytest.mark.parametrize("preset", sorted(PRESETS))
def test_every_hard_place_can_be_touched_in_every_scene(preset):
    for probe, touches in touch_gallery(SensorParameters(), Scene(preset=preset)):
        assert np.isfinite(touches.images).all(), probe.name
        assert np.isfinite(touches.size).all(), probe.name
        assert touches.images.max() > 0, probe.name


def test_probed_points_lie_on_their_surfaces_within_the_unit_sphere():
    for probe in hard_probes():
        surface = probe.surface
        assert np.linalg.norm(surface.vertices, axis=1).max() <= 1.0
        centroid_distance = np.linalg.norm(surface.triangles.mean(axis=1) - probe.point, axis=1)
        nearest = surface.triangles[np.argsort(centroid_distance)[:50]]
        corners = np.linalg.norm(nearest - np.array(probe.point), axis=2)
        assert corners.min() < 0.35, probe.name
        np.testing.assert_allclose(np.linalg.norm(probe.normal), 1.0, atol=1e-12)
