import numpy as np
import pytest

from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.scene.parameters import PRESETS, Scene
from visuohaptic.sensor import SensorParameters, hard_probes, touch_gallery


@pytest.mark.parametrize("preset", sorted(PRESETS))
def test_every_hard_place_can_be_touched_in_every_scene(preset):
    for probe, touches in touch_gallery(SensorParameters(), Scene(preset=preset)):
        assert np.isfinite(touches.images).all(), probe.name
        assert np.isfinite(touches.size).all(), probe.name
        assert touches.images.max() > 0, probe.name


def test_probed_points_lie_on_their_surfaces_within_the_unit_sphere():
    for probe in hard_probes():
        assert np.linalg.norm(probe.surface.vertices, axis=1).max() <= 1.0
        normal = np.array([probe.normal])
        np.testing.assert_allclose(np.linalg.norm(normal), 1.0, atol=1e-12)
        # Slightly inwards, for some points are on an open rim.
        above = (1 - 1e-6) * np.array([probe.point]) + 0.02 * normal
        distance = RayCaster(probe.surface).first_hits(above, -normal).distance[0]
        assert distance == pytest.approx(0.02, abs=2e-3), probe.name
