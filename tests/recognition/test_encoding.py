"""A remembered map is the map that would have been fitted, and leaves chance as fitting it does."""

from dataclasses import replace

import numpy as np
import pytest

from visuohaptic.recognition.encoding import fit_sequence_encoder
from visuohaptic.recognition.maps import MAPS, FeatureGroups
from visuohaptic.recognition.memory import FitMemory
from visuohaptic.recognition.parameters import RecognitionParameters

SEQUENCES = np.random.default_rng(0).normal(size=(24, 5, 6))


def parameters(**som):
    return RecognitionParameters.model_validate({"self_organising_map": som})


def check_memory(memory, settings, sequences=SEQUENCES):
    """Fit with and without memory: encoder and random generator are the same."""
    drawn, alone = np.random.default_rng(7), np.random.default_rng(7)
    remembered = fit_sequence_encoder(sequences, settings, drawn, memory)
    fitted = fit_sequence_encoder(sequences, settings, alone)
    np.testing.assert_array_equal(remembered.encode(SEQUENCES), fitted.encode(SEQUENCES))
    assert drawn.bit_generator.state == alone.bit_generator.state


@pytest.mark.parametrize("training", ["batch", "online"])
def test_outputs_that_share_a_map_are_as_without_memory(training):
    memory = FitMemory(1000)
    # MiniSom has two axes at most.
    outputs = [name for name in MAPS.names if (name, training) != ("lattice", "online")]
    for output in ("feature_groups", *outputs):
        check_memory(memory, parameters(output=output, training=training))
    assert len(memory._held) == len(outputs) - 1  # one is another, read in another way


UNITS = {"output": "unit_distances"}


@pytest.mark.parametrize(
    "other",
    [
        RecognitionParameters(touch_scaling="standardise", self_organising_map=UNITS),
        parameters(**UNITS, training="online"),
        parameters(**UNITS, outputs=3),
    ],
)
def test_other_ways_to_a_map_are_not_confused(other):
    memory = FitMemory(1000)
    check_memory(memory, parameters(**UNITS))
    check_memory(memory, other)
    check_memory(memory, parameters(**UNITS), SEQUENCES[:12])


def almost_alike(**som):
    """Give a touch of each of six objects, sequences of it that differ by rounding, and their encoder."""
    touch = np.random.default_rng(0).normal(size=(6, 22))
    alike = np.repeat(touch[:, None], 5, axis=1)
    alike *= 1 + 1e-15 * np.random.default_rng(1).uniform(-1, 1, alike.shape)
    return touch, alike, fit_sequence_encoder(alike, parameters(**som), np.random.default_rng(0))


def test_touches_that_are_all_alike_are_so_after_reduction_even_where_a_groups_mean_is_small():
    touch, alike, fitted = almost_alike()
    scaled = fitted.touch_scaling.apply(touch)
    # Between two features of one group there is a share at which they cancel all but a ten thousandth,
    # so that their rounding is large beside their mean.
    group = np.full((22, 1), 1 / 22)
    group[0] -= scaled[0] @ group[:, 0] * (1 - 1e-5) / scaled[0, 0]
    cancelling = replace(fitted, reduction=FeatureGroups(group))
    assert 0 < abs(scaled[0] @ group[:, 0]) < 1e-4
    assert np.ptp(cancelling.reduce(alike), axis=1).max() == 0


def test_touches_that_are_all_alike_have_one_distance_from_a_unit():
    _, alike, fitted = almost_alike(output="unit_distances")
    assert np.ptp(fitted.reduction.distances(fitted.touch_scaling.apply(alike[0]))).max() > 0
    assert np.ptp(fitted.reduce(alike), axis=1).max() == 0


def scaled(values, scaling):
    settings = RecognitionParameters(touch_scaling=scaling)
    return fit_sequence_encoder(values, settings, np.random.default_rng(0))


def test_a_groups_mean_that_is_rounding_alone_is_0():
    values = SEQUENCES.copy()
    values[..., 1] = -values[..., 0] * (1 + 1e-15)
    pair = FeatureGroups(0.5 * np.eye(6)[:, :2].sum(axis=1, keepdims=True))
    assert not replace(scaled(values, "none"), reduction=pair).reduce(values).any()


def test_touches_that_differ_keep_every_digit():
    fitted = scaled(SEQUENCES, "standardise")
    # As one product of all touches: a BLAS may round a product a sequence otherwise.
    plain = fitted.touch_scaling.apply(SEQUENCES.reshape(-1, 6)) @ fitted.reduction.weights
    assert np.array_equal(fitted.reduce(SEQUENCES).reshape(len(plain), -1), plain)
