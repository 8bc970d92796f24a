import numpy as np
import pytest

from visuohaptic.sensor.cells import add_drift, add_hysteresis, respond_to_force, scatter_gains

PRESSURES = np.linspace(0, 1, 1001)


def test_conductance_is_linear_half_of_linear_at_saturation_and_one_at_full_scale():
    saturation = 0.25
    pressures = np.array([1e-9, 1.0, 1 / saturation])
    small, full, saturated = respond_to_force(pressures, 0.0, saturation)
    assert full == 1.0
    assert saturated == pytest.approx(0.5 * small / 1e-9 / saturation)
    response = respond_to_force(PRESSURES, 0.1, 0.0)
    np.testing.assert_array_equal(response, np.where(PRESSURES >= 0.1, PRESSURES, 0.0))


def test_hysteresis_loop_area_is_a_third_of_excess_times_peak_squared():
    excess, peak = 0.1, 0.8
    outputs = np.linspace(0, peak, 20_001)
    release = add_hysteresis(outputs, np.full_like(outputs, peak), excess)
    press = add_hysteresis(outputs, outputs, excess)
    area = np.trapezoid(release - press, outputs)
    assert area == pytest.approx(excess * peak**2 / 3, rel=1e-6)
    np.testing.assert_array_equal(press, outputs)
    assert release.max() <= peak
    at_half = add_hysteresis(np.array([0.3]), np.array([0.6]), excess)
    assert at_half == pytest.approx(0.33)


def test_drift_has_its_slope_in_decades_from_its_reference():
    outputs = [add_drift(np.array([0.4]), held, 0.1, 0.05)[0] for held in (1.0, 10.0, 100.0)]
    np.testing.assert_allclose(outputs, 0.4 * (1 + 0.05 * np.array([1, 2, 3])), rtol=1e-12)
    np.testing.assert_array_equal(add_drift(PRESSURES, 0.1, 1.0, 0.05), PRESSURES)


def test_gains_scatter_by_their_deviation_and_are_never_negative():
    deviates = np.random.default_rng(0).standard_normal((64, 64))
    ones = np.ones((2, 64, 64))
    gained = scatter_gains(ones, 0.06, deviates)
    assert gained[0].std() == pytest.approx(0.06, rel=0.05)
    np.testing.assert_array_equal(gained[0], gained[1])
    np.testing.assert_array_equal(scatter_gains(ones, 0.0, deviates), ones)
    assert scatter_gains(ones, 0.29, np.full((64, 64), -5.0)).min() == 0
