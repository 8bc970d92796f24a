"""What the descriptors of a sequence depend on, and what not."""

import numpy as np
import pytest

from visuohaptic.base.errors import RecognitionError
from visuohaptic.recognition.descriptors import (
    POSE,
    describe_relations,
    describe_sequences,
    draw_waves,
    embed_poses,
)
from visuohaptic.recognition.parameters import OrderFreeParameters, RecognitionParameters

PARAMETERS = OrderFreeParameters()
WAVES = draw_waves(PARAMETERS, 1)
NAMES = ("contourlet_01", "imprint_mean", "sensor_size", "contact_full", *POSE)


def sequences(count=6, touches=5, seed=0):
    generator = np.random.default_rng(seed)
    values = generator.uniform(0, 1, size=(count, touches, len(NAMES)))
    values[..., 4:7] = generator.uniform(-0.7, 0.7, size=(count, touches, 3))
    normals = generator.normal(size=(count, touches, 3))
    values[..., 7:] = normals / np.linalg.norm(normals, axis=-1, keepdims=True)
    return values


def describe(values, names=NAMES, parameters=PARAMETERS):
    return describe_sequences(values, names, WAVES, RecognitionParameters(order_free=parameters))


def test_a_row_depends_on_its_own_sequence_alone_in_any_order_of_its_touches():
    values, other = sequences(), sequences(seed=9)
    other[0] = values[0, ::-1]
    np.testing.assert_allclose(describe(values)[0], describe(other)[0], atol=1e-12)


def test_products_of_embeddings_tend_to_the_gaussian_kernel():
    parameters = OrderFreeParameters(waves=5000, wave_length=0.5, normal_weight=0.25)
    many = draw_waves(parameters, 2)
    values = sequences(count=8, touches=1)
    embedded = embed_poses(values[..., 4:7], values[..., 7:], many)
    values[..., [4, 7]] = np.abs(values[..., [4, 7]])  # left and right are alike
    pose = values[:, 0, 4:] * np.array([1, 1, 1, 0.25, 0.25, 0.25])
    squares = np.square(pose[:, None] - pose).sum(axis=-1)
    expected = np.exp(-squares / (2 * 0.5**2))
    # A mean of 5000 terms of variance at most 1.5 is within .1 at more than five sigma.
    np.testing.assert_allclose(embedded @ embedded.T / 5000, expected, atol=0.1)


def test_relations_of_an_equilateral_triangle():
    angle = 2 * np.pi * np.arange(3) / 3
    points = np.stack([np.cos(angle), np.zeros(3), np.sin(angle)], axis=-1)[None]
    relations = describe_relations(points, np.broadcast_to([0.0, 1.0, 0.0], points.shape))[0]
    side = np.sqrt(3)
    assert relations[:6] == pytest.approx([side, 0, side, 1, 0, 0], abs=1e-12)
    assert relations[6:12] == pytest.approx(np.zeros(6), abs=1e-12)
    assert relations[-3:] == pytest.approx([0, np.sqrt(0.5), np.sqrt(0.5)], abs=1e-12)


def test_single_touch_and_coincident_touches_are_finite():
    values = sequences(touches=1)
    assert np.isfinite(describe(values)).all()
    assert np.isfinite(describe(np.repeat(values, 5, axis=1))).all()
    assert np.isfinite(describe(np.zeros((2, 5, len(NAMES))))).all()


def test_cues_choose_their_columns():
    values = sequences()
    full = describe(values)
    parts = [
        describe(values, parameters=OrderFreeParameters(cues=(cue,))) for cue in PARAMETERS.cues
    ]
    np.testing.assert_array_equal(np.concatenate(parts, axis=1), full)


def test_columns_that_a_table_lacks_are_left_out_or_named():
    values = sequences()[..., 4:]
    assert np.isfinite(describe(values, POSE)).all()
    with pytest.raises(RecognitionError, match="no descriptor of the cues imprint in frame full"):
        describe(values, POSE, OrderFreeParameters(cues=("imprint",)))
    with pytest.raises(RecognitionError, match="normal_z of the pose"):
        describe(values[..., :-1], POSE[:-1])
