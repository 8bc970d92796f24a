"""Descriptors of imprints that do not feel the sensor's roll."""

import numpy as np
import pytest

from visuohaptic.features.imprint_shape import describe_imprint_shape
from visuohaptic.recognition.roll_free import (
    DIRECTED_IMPRINT,
    ROLL_FREE_IMPRINT,
    roll_free_bands,
    roll_free_imprint,
)
from visuohaptic.tables.phases import IMPRINT_FEATURES

NAMES = tuple(IMPRINT_FEATURES)


@pytest.mark.parametrize("step", range(1, 16))
def test_magnitudes_over_direction_do_not_feel_a_cyclic_shift(step):
    bands = np.random.default_rng(0).uniform(size=(3, 5, 16))
    shifted = roll_free_bands(np.roll(bands, step, axis=-1))
    np.testing.assert_allclose(shifted, roll_free_bands(bands), atol=1e-15)


def test_magnitudes_tell_one_direction_from_two_and_from_all():
    one, two, everywhere = np.zeros(16), np.zeros(16), np.full(16, 1 / 16)
    one[3], two[[3, 11]] = 1, 0.5
    magnitudes = roll_free_bands(np.stack([one, two, everywhere]))
    np.testing.assert_allclose(magnitudes[:, 0], 1 / 16)
    np.testing.assert_allclose(magnitudes[:, 1], [1 / 16, 0, 0], atol=1e-15)
    np.testing.assert_allclose(magnitudes[:, 2], [1 / 16, 1 / 16, 0], atol=1e-15)


def test_a_quarter_turn_of_an_imprint_changes_no_statistic_that_is_kept():
    imprints = np.random.default_rng(0).uniform(size=(20, 32, 32))
    imprints *= np.linspace(0.2, 1, 32)[:, None]  # slopes along rows only
    upright, turned = map(describe_imprint_shape, (imprints, np.rot90(imprints, axes=(1, 2))))
    kept, kept_turned = (roll_free_imprint(values, NAMES) for values in (upright, turned))
    np.testing.assert_allclose(kept_turned, kept, atol=1e-11)
    assert np.abs(turned - upright).max() > 0.1


def test_a_slope_is_as_steep_in_every_direction():
    angles = np.linspace(0, np.pi, 7)[:, None, None]
    v, u = np.meshgrid(np.linspace(-1, 1, 32), np.linspace(-1, 1, 32), indexing="ij")
    slopes = 0.5 + 0.3 * (np.cos(angles) * u + np.sin(angles) * v)
    directed = roll_free_imprint(describe_imprint_shape(slopes), NAMES)[:, len(ROLL_FREE_IMPRINT) :]
    np.testing.assert_allclose(directed, np.broadcast_to([0.3, 0.6 / 31], (7, 2)))


def test_every_statistic_of_the_imprint_is_kept_joined_or_left_out_knowingly():
    joined = {name for names in DIRECTED_IMPRINT for name in names}
    assert {*ROLL_FREE_IMPRINT} | joined | {"imprint_upright_bending"} == {*NAMES}


def test_without_columns_nothing_is_described():
    values = np.zeros((2, 5, 0))
    assert roll_free_bands(values).shape == roll_free_imprint(values, ()).shape == (2, 5, 0)
