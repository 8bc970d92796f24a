"""The 60 features of a sequence; numerics compares moments and wavelets with exact rationals."""

import numpy as np
import pytest

from visuohaptic.base.errors import RecognitionError
from visuohaptic.recognition.parameters import SequenceParameters
from visuohaptic.recognition.sequence_features import (
    sequence_features,
    summarise_signals,
    wavelet_levels,
)


@pytest.mark.parametrize("constant", [0.0, 0.1, 1e-300, 1e300])
@pytest.mark.parametrize("length", [1, 5, 7])
def test_constant_sequence_has_no_deviation_and_no_skewness(constant, length):
    found = summarise_signals(np.full(length, constant), 1)
    np.testing.assert_allclose(found, [0, constant, 0], rtol=1e-15)


@pytest.mark.parametrize("scale", [1e-200, 1.0, -1e150])
def test_skewness_does_not_depend_on_scale(scale):
    found = summarise_signals(scale * np.array([0.0, 0.0, 0.0, 0.0, 1.0]), 1)
    # One in five: m2 = p(1-p), m3 = p(1-p)(1-2p), p = 1/5, skewness (1-2p)/sqrt(p(1-p)) = 3/2.
    assert found[2] == pytest.approx(1.5 * np.sign(scale), rel=1e-12)


@pytest.mark.parametrize("degrees", ["sample", "population"])
def test_five_sequences_of_five_touches_give_sixty_features(degrees):
    sequences = np.random.default_rng(2).normal(size=(7, 5, 5))
    parameters = SequenceParameters(degrees_of_freedom=degrees)
    features = sequence_features(sequences, parameters)
    assert features.shape == (7, 60)
    # By output, then level, then statistic.
    of_third, features = sequences[:, :, 2], features.reshape(7, 5, 4, 3)[:, 2]
    deviation = of_third.std(axis=1, ddof=int(degrees == "sample"))
    np.testing.assert_allclose(features[:, 0, 0], deviation)
    detail = wavelet_levels(of_third, parameters)[1]
    np.testing.assert_allclose(features[:, 2, 1], np.sqrt((detail**2).mean(axis=1)))


def test_unknown_wavelet_is_refused_by_name():
    with pytest.raises(RecognitionError, match="'db99'"):
        wavelet_levels(np.zeros((1, 5)), SequenceParameters(wavelet="db99"))


def test_details_of_equal_touches_are_zero_up_to_their_last_digit():
    generator = np.random.default_rng(0)
    touch = generator.normal(size=(20, 1, 5))
    equal = np.repeat(touch, 5, axis=1) * (1 + 1e-15 * generator.uniform(-1, 1, (20, 5, 5)))
    parameters = SequenceParameters(extension="symmetric")
    features = sequence_features(equal, parameters).reshape(20, 5, 4, 3)
    assert not features[:, :, 1:].any()
    np.testing.assert_allclose(features[:, :, 0, 1], np.abs(touch[:, 0]), rtol=1e-14)


def test_small_details_of_touches_that_differ_stay():
    sequences = 1.0 + 1e-9 * np.random.default_rng(0).normal(size=(20, 5, 5))
    parameters = SequenceParameters(extension="symmetric")
    details = sequence_features(sequences, parameters).reshape(20, 5, 4, 3)[:, :, 1]
    assert (details != 0).all()
