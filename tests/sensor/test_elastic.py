import numpy as np
import pytest

from visuohaptic.geometry.layouts import sensing_offsets
from visuohaptic.sensor.elastic import (
    boussinesq_kernel,
    half_space_pressures,
    winkler_pressures,
)

MODULUS, POISSON, RADIUS, DEPTH = 2e5, 0.45, 0.02, 1e-4
REDUCED = MODULUS / (1 - POISSON**2)


def pressed_sphere(resolution=32, depth=DEPTH, width=3.0):
    """Indentation by a paraboloid, distance from the axis and cell edge, metres."""
    size = width * np.sqrt(RADIUS * depth)
    x, y = np.meshgrid(*(2 * [0.5 * size * sensing_offsets(resolution)]))
    distance = np.hypot(x, y)
    return depth - distance**2 / (2 * RADIUS), distance, size / resolution


@pytest.mark.parametrize("depth", [1e-5, 1e-4, 5e-4])
def test_hertz_force_and_pressures_within_two_per_cent(depth):
    indentation, distance, cell = pressed_sphere(depth=depth)
    pressure = half_space_pressures(indentation[None], np.array([cell]), MODULUS, POISSON)[0]
    force = 4 / 3 * REDUCED * np.sqrt(RADIUS) * depth**1.5
    assert pressure.sum() * cell**2 == pytest.approx(force, rel=0.02)
    peak, radius = 2 * REDUCED / np.pi * np.sqrt(depth / RADIUS), np.sqrt(RADIUS * depth)
    expected = peak * np.sqrt(np.maximum(1 - (distance / radius) ** 2, 0))
    within = distance < 0.9 * radius
    assert np.abs(pressure - expected)[within].max() < 0.02 * peak
    assert np.sqrt(np.mean((pressure - expected) ** 2)) < 0.02 * np.sqrt(np.mean(expected**2))
    assert (pressure[distance > radius + cell] == 0).all()


def test_a_loaded_cell_sinks_as_under_loves_uniform_square():
    # At the centre of a square of edge a: 4 a asinh(1) (Love 1929); nine cells make one of edge 3.
    kernel = boussinesq_kernel(4)
    assert kernel[0, 0] == pytest.approx(4 * np.arcsinh(1))
    around = [-1, 0, 1]
    assert kernel[np.ix_(around, around)].sum() == pytest.approx(3 * 4 * np.arcsinh(1))


def test_pressures_solve_the_contact_conditions():
    generator = np.random.default_rng(3)
    indentation = generator.normal(size=(4, 16, 16)) * 1e-4
    indentation[0, :3] = -np.inf
    cells = np.array([1e-4, 2e-4, 1e-3, 5e-4])
    pressure = half_space_pressures(indentation, cells, MODULUS, POISSON)
    kernel = boussinesq_kernel(16)
    lags = np.arange(16)[:, None] - np.arange(16)
    for row in range(4):
        sinking = np.einsum(
            "abcd,bd->ac", kernel[lags[:, :, None, None], lags[None, None]], pressure[row]
        )
        sinking *= cells[row] / (np.pi * REDUCED)
        loaded = pressure[row] > 0
        tolerance = 1e-4 * np.abs(sinking).max()
        np.testing.assert_allclose(sinking[loaded], indentation[row][loaded], atol=tolerance)
        assert (sinking[~loaded] >= indentation[row][~loaded] - tolerance).all()
    assert (pressure >= 0).all()


def test_without_contact_there_is_no_pressure():
    gaps = np.full((2, 8, 8), -np.inf)
    gaps[1] = -1e-6
    assert (half_space_pressures(gaps, np.array([1e-3, 1e-3]), MODULUS, POISSON) == 0).all()
    assert (winkler_pressures(gaps, MODULUS, POISSON, 0.003) == 0).all()


def test_winkler_force_of_a_sphere_grows_with_the_square_of_its_depth():
    thickness = 0.003
    confined = MODULUS * (1 - POISSON) / ((1 + POISSON) * (1 - 2 * POISSON))
    for depth in (5e-5, 1e-4):
        indentation, _, cell = pressed_sphere(depth=depth)
        force = winkler_pressures(indentation[None], MODULUS, POISSON, thickness).sum() * cell**2
        # Johnson (1985), equation 4.54 with the confined modulus: F = π K R δ² / h.
        assert force == pytest.approx(np.pi * confined * RADIUS * depth**2 / thickness, rel=2e-3)


def test_far_from_a_loaded_cell_the_half_space_sinks_as_under_a_point_load():
    lag = np.hypot(*np.indices((32, 32)))
    far = lag > 4
    np.testing.assert_allclose(boussinesq_kernel(32)[:32, :32][far], 1 / lag[far], rtol=5e-3)
