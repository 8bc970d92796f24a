"""Dark and light of imprints are said as the sensor makes them."""

import numpy as np
import pytest

import visuohaptic as vh
from visuohaptic.pictures.imprint_scale import imprint_scale
from visuohaptic.scene.parameters import PRESETS, Scene
from visuohaptic.sensor.parameters import SensorParameters

PER_IMPRINT, ABSOLUTE = SensorParameters(), SensorParameters(normalisation="absolute")


def test_each_normalisation_has_its_own_words_with_and_without_a_cover():
    bare, covered = Scene(), Scene(preset="fsr400")
    assert str(imprint_scale(PER_IMPRINT, bare)) == (
        "dark: the imprint's farthest point (0); light: the imprint's nearest point (1)"
    )
    assert str(imprint_scale(ABSOLUTE, bare)) == (
        "dark: a gap of 0.1 object radii or more (0); light: contact with the sensor's plane (1)"
    )
    assert str(imprint_scale(PER_IMPRINT, covered)) == (
        "dark: the imprint's lowest pressure (0); light: the imprint's highest pressure (1)"
    )
    assert str(imprint_scale(ABSOLUTE, covered)) == (
        "dark: no pressure (0); light: 100000 Pa or more (1)"
    )
    off = Scene(preset="fsr400", effects={"elastic_cover": "never"})
    assert imprint_scale(ABSOLUTE, off) == imprint_scale(ABSOLUTE, bare)
    every = imprint_scale(PER_IMPRINT, *(Scene(preset=name) for name in PRESETS))
    assert every.light == "the imprint's nearest point or the imprint's highest pressure"


@pytest.mark.slow
def test_imprints_of_the_default_sensor_are_stretched_and_absolute_ones_are_not():
    """At the edge of a face most of the square is far from the object: its light is still 1 and its dark 0."""
    chair = vh.example("chair")
    places = chair.surface.triangles.mean(axis=1)[::300]
    own = chair.touch(at=places).imprints
    kept = chair.touch(at=places, parameters={"sensor.normalisation": "absolute"}).imprints
    ends = np.stack([own.min(axis=(1, 2)), own.max(axis=(1, 2))])
    uneven = np.ptp(kept, axis=(1, 2)) > 0.01
    assert uneven.sum() > 1
    np.testing.assert_allclose(ends[:, uneven], [[0] * uneven.sum(), [1] * uneven.sum()])
    assert np.any((kept.min(axis=(1, 2)) > 0) & uneven)
