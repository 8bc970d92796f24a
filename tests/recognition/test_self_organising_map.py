"""The batch map against MiniSom's, and against what a map must do."""

import numpy as np
import pytest
from minisom import MiniSom

from visuohaptic.recognition.self_organising_map import (
    ORDERING_EPOCHS,
    RADII,
    _principal_weights,
    fit_batch_map,
    fit_online_map,
    lattice,
    line,
)


def touches(count=120, columns=22, seed=0):
    generator = np.random.default_rng(seed)
    return generator.normal(size=(count, columns)) @ generator.normal(size=(columns, columns))


def minisom_batch(data, shape, initial, radii):
    """MiniSom's own batch training, with this map's start and radii."""
    som = MiniSom(
        *shape, data.shape[1], learning_rate=1.0, decay_function=lambda rate, _t, _n: rate
    )
    som.get_weights()[:] = initial.reshape(*shape, -1)
    som._sigma_decay_function = lambda _sigma, step, _steps: radii[step]
    som.train_batch_offline(data, len(radii))
    return som.get_weights().reshape(-1, data.shape[1])


@pytest.mark.parametrize(("places", "shape"), [(line(5), (5, 1)), (lattice(2, 3), (3, 3))])
def test_ordering_passes_equal_minisom_batch_training(places, shape):
    data = touches()
    fitted = fit_batch_map(data, places, settling_epochs=1)
    radii = [*np.geomspace(*RADII, ORDERING_EPOCHS), RADII[1]]
    expected = minisom_batch(data, shape, _principal_weights(data, places), radii)
    np.testing.assert_allclose(fitted.weights, expected, rtol=1e-10, atol=1e-10)


def test_batch_map_is_converged():
    data = touches()
    settled = fit_batch_map(data, line(5))
    longer = fit_batch_map(data, line(5), settling_epochs=1000)
    np.testing.assert_array_equal(settled.weights, longer.weights)
    neighbourhood = np.exp(-((line(5) - line(5).T) ** 2) / (2 * 0.5**2))
    won = np.eye(5)[settled.nearest(data)]
    fixed_point = (neighbourhood @ (won.T @ data)) / (neighbourhood @ won.sum(axis=0))[:, None]
    np.testing.assert_allclose(settled.weights, fixed_point, rtol=1e-12, atol=1e-12)


def test_distances_and_nearest_unit_agree():
    data = touches()
    fitted = fit_batch_map(data, line(5))
    expected = np.linalg.norm(data[:, None, :] - fitted.weights, axis=2)
    np.testing.assert_allclose(fitted.distances(data), expected)
    np.testing.assert_array_equal(fitted.nearest(data), expected.argmin(axis=1))


def test_online_map_depends_on_the_seed_alone():
    data = touches()
    first, again, other = (
        fit_online_map(data, line(5), np.random.default_rng(seed)).weights for seed in (3, 3, 4)
    )
    np.testing.assert_array_equal(first, again)
    assert not np.array_equal(first, other)


TWO_PLACES = np.repeat([[0.0, 0.0], [1.0, 1.0]], 5, axis=0)


@pytest.mark.parametrize(
    ("data", "radii"),
    [(touches(count=1), RADII), (touches(count=4), RADII), (TWO_PLACES, (0.02, 0.01))],
)
def test_units_without_touches_are_finite(data, radii):
    assert np.isfinite(fit_batch_map(data, line(5), radii).weights).all()
