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


def test_without_line_resistance_each_cell_reads_as_it_is_and_an_untouched_array_nothing():
    cells = np.random.default_rng(3).uniform(0, 2, (5, 32, 32))
    np.testing.assert_array_equal(read_grounded(cells, 0.0), cells)
    np.testing.assert_array_equal(read_grounded(0 * cells, 0.3), 0)


@given(st.lists(st.floats(-0.5, 1.5), min_size=1, max_size=20), st.integers(1, 16))
def test_quantisation_gives_the_nearest_level_from_0_to_1(outputs, bits):
    levels = quantise(np.array(outputs), bits)
    steps = levels * (2**bits - 1)
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-9)
    away = np.abs(levels - np.clip(outputs, 0, 1))
    assert away.max() <= 0.5 / (2**bits - 1) * (1 + 1e-9)
    np.testing.assert_array_equal(quantise(levels, bits), levels)
