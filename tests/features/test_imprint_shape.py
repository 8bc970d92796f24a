"""Statistics of imprints whose shape is known."""

import numpy as np
import pytest

from visuohaptic.features.imprint_shape import describe_imprint_shape
from visuohaptic.tables.phases import IMPRINT_FEATURES


def described(image):
    row = describe_imprint_shape(np.asarray(image)[None])[0]
    return dict(zip(IMPRINT_FEATURES, row, strict=True))


def grid(side=32):
    return np.meshgrid(np.linspace(-1, 1, side), np.linspace(-1, 1, side))


def test_flat_contact():
    features = described(np.ones((32, 32), dtype=np.float32))
    assert features["imprint_mean"] == features["imprint_contact"] == 1
    others = set(IMPRINT_FEATURES) - {"imprint_mean", "imprint_contact"}
    assert [features[name] for name in sorted(others)] == pytest.approx([0] * 11, abs=1e-12)


def test_quadric_is_recovered():
    u, v = grid()
    features = described(0.6 + 0.1 * u - 0.05 * v - 0.2 * u * u - 0.1 * v * v)
    assert features["imprint_bending"] == pytest.approx(-0.6)
    assert features["imprint_saddle"] == pytest.approx(0.2)
    assert features["imprint_upright_bending"] == pytest.approx(-0.2)
    assert features["imprint_tilt_columns"] == pytest.approx(0.1)
    assert features["imprint_tilt_rows"] == pytest.approx(0.05)
    assert features["imprint_roughness"] == pytest.approx(0, abs=1e-12)


def test_saddle_does_not_depend_on_the_direction_of_bending():
    u, v = grid()
    saddles = []
    for angle in (0, 0.4, 1.1):
        along = np.cos(angle) * u + np.sin(angle) * v
        saddles.append(described(0.9 - 0.4 * along**2)["imprint_saddle"])
    assert saddles == pytest.approx([0.8] * 3)


def test_edge_has_steps_across_it_only():
    u, _ = grid()
    features = described(np.where(u < 0, 1.0, 0.0))
    assert features["imprint_contact"] == features["imprint_empty"] == 0.5
    assert features["imprint_step_columns"] == pytest.approx(1 / 31)
    assert features["imprint_step_rows"] == 0
