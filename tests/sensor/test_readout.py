import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from visuohaptic.sensor.readout import quantise, read_floating, read_grounded


def laplacian(conductances):
    """Kirchhoff's current law written out node by node: first the rows, then the columns."""
    size = len(conductances)
    system = np.zeros((2 * size, 2 * size))
    for (row, column), value in np.ndenumerate(conductances):
        for a, b in ((row, size + column), (size + column, row)):
            system[a, a] += value
            system[a, b] -= value
    return system


def nodal_reading(conductances, row, column, line_resistance):
    """Current of one column with 1 V on one row and all lines grounded through their resistance."""
    size, line = len(conductances), 1 / line_resistance
    currents = np.zeros(2 * size)
    currents[row] = line
    voltages = np.linalg.solve(laplacian(conductances) + line * np.eye(2 * size), currents)
    return line * voltages[size + column]


def floating_reading(conductances, row, column):
    """Effective conductance between two lines: 1 A in at the row, out at the column."""
    size = len(conductances)
    currents = np.zeros(2 * size)
    currents[row], currents[size + column] = 1.0, -1.0
    voltages = np.linalg.lstsq(laplacian(conductances), currents, rcond=None)[0]
    return 1 / (voltages[row] - voltages[size + column])


def readings(read, cells, *settings):
    return [[read(cells, row, column, *settings) for column in range(4)] for row in range(4)]


CELLS = np.random.default_rng(1).uniform(0, 1e-3, (4, 4))


@pytest.mark.parametrize("line_resistance", [1.0, 100.0, 5000.0])
def test_grounded_reading_obeys_kirchhoff_on_a_four_by_four_network(line_resistance):
    expected = readings(nodal_reading, CELLS, line_resistance)
    np.testing.assert_allclose(read_grounded(CELLS[None], line_resistance)[0], expected, rtol=1e-12)


def test_floating_reading_obeys_kirchhoff_on_a_four_by_four_network():
    expected = readings(floating_reading, CELLS + 1e-6)
    np.testing.assert_allclose(read_floating(CELLS[None], 1e-6)[0], expected, rtol=1e-10)


def test_a_uniform_floating_network_has_its_closed_form():
    # n² equal cells between n rows and n columns: 2n - 1 of n² resistances in effect.
    size, conductance = 6, 2e-4
    read = read_floating(np.full((1, size, size), conductance), 1e-12)[0]
    np.testing.assert_allclose(read, conductance * size**2 / (2 * size - 1), rtol=1e-6)


def test_without_line_resistance_each_cell_reads_as_it_is_and_an_untouched_array_nothing():
    cells = np.random.default_rng(3).uniform(0, 2, (5, 32, 32))
    np.testing.assert_array_equal(read_grounded(cells, 0.0), cells)
    np.testing.assert_array_equal(read_grounded(0 * cells, 0.3), 0)


def test_sneak_paths_make_an_untouched_cell_read():
    cells = np.full((1, 4, 4), 1e-3)
    cells[0, 1, 2] = 0.0
    read = read_floating(cells, 1e-9)[0]
    assert read[1, 2] > 0.3e-3
    assert read_grounded(cells, 1.0)[0, 1, 2] < 0.01e-3


@given(st.lists(st.floats(-0.5, 1.5), min_size=1, max_size=20), st.integers(1, 16))
def test_quantisation_stays_within_half_a_step(outputs, bits):
    outputs = np.array(outputs)
    levels = quantise(outputs, bits)
    clipped = np.clip(outputs, 0, 1)
    assert np.abs(levels - clipped).max() <= 0.5 / (2**bits - 1) * (1 + 1e-9)
    np.testing.assert_array_equal(quantise(levels, bits), levels)
    assert set(quantise(np.array([-1.0, 2.0]), bits)) == {0.0, 1.0}


def test_quantisation_error_of_even_outputs_has_a_variance_of_a_step_squared_over_twelve():
    outputs = np.random.default_rng(5).random(200_000)
    error = quantise(outputs, 8) - outputs
    assert error.var() == pytest.approx((1 / 255) ** 2 / 12, rel=0.02)
