"""The batch map against MiniSom's, and against what a map must do."""

import numpy as np
import pytest
from minisom import MiniSom

from visuohaptic.recognition import self_organising_map
from visuohaptic.recognition.self_organising_map import (
    ORDERING_EPOCHS,
    RADII,
    _principal_weights,
    _weighted_means,
    fit_batch_map,
    fit_map,
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


def test_a_batch_map_is_fitted_once_per_content_layout_and_lattice(monkeypatch):
    monkeypatch.setattr(self_organising_map, "_remembered", {})
    data = touches()
    changed = data.copy()
    changed[-1, -1] += 1e-9
    other_rows = [data.reshape(60, 44), np.asfortranarray(data), changed]
    fitted = fit_map(data, line(5), "batch", None)
    np.testing.assert_array_equal(fitted.weights, fit_batch_map(data, line(5)).weights)
    assert fit_map(data.copy(), line(5), "batch", None) is fitted
    for rows in other_rows:
        found = fit_map(rows, line(5), "batch", None)
        np.testing.assert_array_equal(found.weights, fit_batch_map(rows, line(5)).weights)
    for positions in (line(4), lattice(5, 1)):
        found = fit_map(data, positions, "batch", None)
        np.testing.assert_array_equal(found.positions, positions)
    assert len(self_organising_map._remembered) == 6


def test_of_too_many_remembered_maps_the_earliest_is_forgotten(monkeypatch):
    monkeypatch.setattr(self_organising_map, "_remembered", {})
    monkeypatch.setattr(self_organising_map, "MOST_REMEMBERED", 2)
    first, second, third = (touches(seed=seed) for seed in range(3))
    maps = [fit_map(rows, line(5), "batch", None) for rows in (first, second, third)]
    assert fit_map(second, line(5), "batch", None) is maps[1]
    assert fit_map(third, line(5), "batch", None) is maps[2]
    assert fit_map(first, line(5), "batch", None) is not maps[0]
    assert len(self_organising_map._remembered) == 2


def test_an_online_map_is_fitted_each_time():
    data = touches()
    maps = [fit_map(data, line(5), "online", np.random.default_rng(seed)) for seed in range(2)]
    assert (maps[0].weights != maps[1].weights).any()


def test_a_unit_that_no_touch_reaches_keeps_its_weights():
    data, previous = touches(10, 3), np.arange(9.0).reshape(3, 3) + 1
    # Each unit is its only neighbour, and the first unit is nearest to every touch.
    weights = _weighted_means(data, np.zeros(10, dtype=int), np.eye(3), previous)
    np.testing.assert_allclose(weights[0], data.mean(axis=0), rtol=1e-12)
    np.testing.assert_array_equal(weights[1:], previous[1:])
