"""Projections of too few rows."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numerics.tolerances import U64

from visuohaptic.recognition.tuning import fit_projection

SEEDS = st.integers(0, 2**32 - 1)


@given(seed=SEEDS, rows=st.integers(2, 12), exponent=st.sampled_from([-8, 0, 8]))
def test_a_projection_of_too_few_rows_keeps_distances(hold, seed, rows, exponent):
    generator = np.random.default_rng(seed)
    values = generator.normal(size=(rows, 40)) * 10.0 ** (exponent * (np.arange(40) % 2))
    projection = fit_projection(values, 64)
    scaled = projection.scaling.apply(values)
    found = projection.apply(values)
    wanted = np.linalg.norm(scaled[:, None] - scaled[None], axis=2)
    error = np.abs(np.linalg.norm(found[:, None] - found[None], axis=2) - wanted)
    assert projection.components.shape[1] <= rows
    # Directions below 1e-9 of the largest are left out on purpose.
    assert error.max() <= 4e-8 * max(wanted.max(), 1) + 64 * U64
