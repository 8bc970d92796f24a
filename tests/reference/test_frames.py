"""Descriptors of frames `none`, `centre` and `vertical` against the plain ones of `frames.py`."""

import numpy as np
import pytest
from reference import frames as plain

from visuohaptic.recognition import RecognitionParameters
from visuohaptic.recognition.descriptors import POSE, describe_sequences, draw_waves

# Sums of a few hundred numbers of size 1 in another order.
TOLERANCE = 1e-12


def sequences(touches, seed):
    generator = np.random.default_rng(seed)
    points = generator.uniform(-0.7, 0.7, size=(3, touches, 3))
    normals = generator.normal(size=points.shape)
    return points, normals / np.linalg.norm(normals, axis=-1, keepdims=True)


@pytest.mark.parametrize("touches", [1, 2, 5])
@pytest.mark.parametrize("frame", ["none", "centre", "vertical"])
def test_descriptors_of_a_pose_that_is_known_in_part(frame, touches):
    cues = ("pose", "relations", "embedding")
    parameters = RecognitionParameters(frame=frame, order_free={"cues": cues, "waves": 20})
    waves = draw_waves(parameters.order_free, 5)
    points, normals = sequences(touches, seed=touches)
    found = describe_sequences(np.concatenate([points, normals], axis=-1), POSE, waves, parameters)
    for row, point, normal in zip(found, points, normals, strict=True):
        wanted = plain.descriptors(frame, point, normal, waves.directions, waves.phases)
        np.testing.assert_allclose(row, wanted, rtol=0, atol=TOLERANCE)
