"""Statistics of imprints whose shape is known."""

import numpy as np
import pytest

from visuohaptic.features.imprint_shape import describe_imprint_shape
from visuohaptic.geometry.layouts import build_layout, grid_layout
from visuohaptic.geometry.pads import layout_of
from visuohaptic.tables.phases import IMPRINT_FEATURES


def described(image):
    row = describe_imprint_shape(np.asarray(image)[None])[0]
    return dict(zip(IMPRINT_FEATURES, row, strict=True))


U, V = np.meshgrid(np.linspace(-1, 1, 32), np.linspace(-1, 1, 32))


def test_flat_contact():
    features = described(np.ones((32, 32), dtype=np.float32))
    assert features.pop("imprint_mean") == features.pop("imprint_contact") == 1
    assert list(features.values()) == pytest.approx([0] * 11, abs=1e-12)


def test_quadric_is_recovered():
    features = described(0.6 + 0.1 * U - 0.05 * V - 0.2 * U * U - 0.1 * V * V)
    expected = {
        "imprint_bending": -0.6,
        "imprint_saddle": 0.2,
        "imprint_upright_bending": -0.2,
        "imprint_tilt_columns": 0.1,
        "imprint_tilt_rows": 0.05,
        "imprint_roughness": 0,
    }
    assert {name: features[name] for name in expected} == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("angle", [0, 0.4, 1.1])
def test_saddle_does_not_depend_on_the_direction_of_bending(angle):
    bent = 0.9 - 0.4 * (np.cos(angle) * U + np.sin(angle) * V) ** 2
    assert described(bent)["imprint_saddle"] == pytest.approx(0.8)


def test_edge_has_steps_across_it_only():
    features = described(np.where(U < 0, 1.0, 0.0))
    assert features["imprint_contact"] == features["imprint_empty"] == 0.5
    assert features["imprint_step_columns"] == pytest.approx(1 / 31)
    assert features["imprint_step_rows"] == 0


def test_a_quadric_on_taxels_has_its_own_coefficients_and_no_residual():
    layout = layout_of("finger", 2)
    u, v = layout.chart[:, 0], -layout.chart[:, 1]
    imprint = 0.4 + 0.1 * u - 0.05 * v + 0.02 * u * u + 0.03 * u * v - 0.04 * v * v
    names = dict(zip(IMPRINT_FEATURES, describe_imprint_shape(imprint[None], layout)[0], strict=True))  # fmt: skip
    assert names["imprint_mean"] == pytest.approx(imprint.mean())
    assert names["imprint_bending"] == pytest.approx(2 * (0.02 - 0.04))
    assert names["imprint_saddle"] == pytest.approx(2 * np.hypot(0.06, 0.03))
    assert names["imprint_tilt_columns"] == pytest.approx(0.1)
    assert names["imprint_tilt_rows"] == pytest.approx(0.05)
    assert names["imprint_roughness"] == pytest.approx(0, abs=1e-12)


def test_statistics_of_a_grid_given_as_taxels_are_nearly_those_of_the_square():
    """Terms run to the outermost taxel in the square, and to the outline in other layouts."""
    grid = grid_layout(16, 16)
    own = build_layout("own", grid.positions * 16 / 15, grid.directions)
    image = np.random.default_rng(3).random((2, 16, 16))
    square = describe_imprint_shape(image)
    taxels = describe_imprint_shape(image.reshape(2, -1), own)
    # The last two are steps: taxels have diagonal neighbours beside those along the axes.
    np.testing.assert_allclose(taxels[:, :11], square[:, :11], rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(taxels[:, 11:], square[:, 11:], rtol=0.15)


def test_steps_along_columns_are_those_between_taxels_beside_each_other():
    layout = layout_of("finger", 2)
    across = (layout.chart[:, 0] - layout.chart[:, 0].min()) / np.ptp(layout.chart[:, 0])
    steps = describe_imprint_shape(across[None], layout)[0, 11:]
    assert steps[0] > 4 * steps[1]
