"""The encoder of sequences: rounding never counts as a difference."""

from copy import copy

import numpy as np
import pytest

from visuohaptic.recognition.encoding import SequenceEncoder
from visuohaptic.recognition.maps import FeatureGroups
from visuohaptic.recognition.parameters import RecognitionParameters

SEQUENCES = np.random.default_rng(0).normal(size=(24, 5, 6))


def parameters(**som):
    return RecognitionParameters.model_validate({"self_organising_map": som})


def with_reduction(fitted, reduction):
    """Return the encoder with another map."""
    other = copy(fitted)
    other.reduction_ = reduction
    return other


def almost_alike(**som):
    """Return a touch of each of six objects, sequences of it that differ by rounding, and their encoder."""
    touch = np.random.default_rng(0).normal(size=(6, 22))
    alike = np.repeat(touch[:, None], 5, axis=1)
    alike *= 1 + 1e-15 * np.random.default_rng(1).uniform(-1, 1, alike.shape)
    return touch, alike, SequenceEncoder(parameters(**som)).fit(alike)


def test_touches_that_are_all_alike_are_so_after_reduction_even_where_a_groups_mean_is_small():
    touch, alike, fitted = almost_alike()
    scaled = fitted.touch_scaling_.apply(touch)
    # Between two features of one group there is a share at which they cancel all but a ten thousandth,
    # so that their rounding is large beside their mean.
    group = np.full((22, 1), 1 / 22)
    group[0] -= scaled[0] @ group[:, 0] * (1 - 1e-5) / scaled[0, 0]
    cancelling = with_reduction(fitted, FeatureGroups(group))
    assert 0 < abs(scaled[0] @ group[:, 0]) < 1e-4
    assert np.ptp(cancelling.reduce(alike), axis=1).max() == 0


def test_touches_that_are_all_alike_have_one_distance_from_a_unit():
    _, alike, fitted = almost_alike(output="unit_distances")
    assert np.ptp(fitted.reduction_.distances(fitted.touch_scaling_.apply(alike[0]))).max() > 0
    assert np.ptp(fitted.reduce(alike), axis=1).max() == 0


def scaled(values, scaling):
    settings = RecognitionParameters(touch_scaling=scaling)
    return SequenceEncoder(settings).fit(values)


def test_a_groups_mean_that_is_rounding_alone_is_0():
    values = SEQUENCES.copy()
    values[..., 1] = -values[..., 0] * (1 + 1e-15)
    pair = FeatureGroups(0.5 * np.eye(6)[:, :2].sum(axis=1, keepdims=True))
    assert not with_reduction(scaled(values, "none"), pair).reduce(values).any()


def test_touches_that_differ_keep_every_digit():
    fitted = scaled(SEQUENCES, "standardise")
    # As one product of all touches: a BLAS may round a product a sequence otherwise.
    plain = fitted.touch_scaling_.apply(SEQUENCES.reshape(-1, 6)) @ fitted.reduction_.weights
    assert np.array_equal(fitted.reduce(SEQUENCES).reshape(len(plain), -1), plain)


@pytest.mark.parametrize("scaling", ["standardise", "none"])
def test_training_sequences_are_encoded_in_the_fit_as_afterwards(scaling):
    values = np.random.default_rng(0).normal(size=(24, 5, 22))
    encoder = SequenceEncoder(RecognitionParameters(sequence_scaling=scaling))
    found = encoder.fit_transform(values)
    assert np.array_equal(found, encoder.transform(values))
    assert np.array_equal(found, SequenceEncoder(encoder.parameters).fit(values).transform(values))
