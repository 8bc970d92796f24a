"""A remembered map is the map that would have been fitted, and leaves chance as fitting it does."""

import numpy as np
import pytest

from visuohaptic.recognition.encoding import ReductionMemory, fit_sequence_encoder
from visuohaptic.recognition.parameters import RecognitionParameters

SEQUENCES = np.random.default_rng(0).normal(size=(24, 5, 6))


def parameters(**som):
    return RecognitionParameters.model_validate({"self_organising_map": som})


@pytest.mark.parametrize("training", ["batch", "online"])
def test_outputs_that_share_a_map_are_as_without_memory(training):
    memory = ReductionMemory()
    for output in ("unit_distances", "one_hot", "feature_groups", "unit_distances"):
        settings = parameters(output=output, training=training, online_epochs=1)
        drawn, alone = np.random.default_rng(7), np.random.default_rng(7)
        remembered = fit_sequence_encoder(SEQUENCES, settings, drawn, memory)
        fitted = fit_sequence_encoder(SEQUENCES, settings, alone)
        np.testing.assert_array_equal(remembered.encode(SEQUENCES), fitted.encode(SEQUENCES))
        assert drawn.bit_generator.state == alone.bit_generator.state
    assert len(memory._held) == 2


@pytest.mark.parametrize(
    "change",
    [
        {"touch_scaling": "none"},
        {"self_organising_map": {"final_radius": 0.4}},
        {"self_organising_map": {"output": "lattice", "outputs": 3}},
    ],
)
def test_other_ways_to_a_map_are_not_confused(change):
    memory = ReductionMemory()
    for settings in (parameters(), RecognitionParameters.model_validate(change)):
        remembered = fit_sequence_encoder(SEQUENCES, settings, np.random.default_rng(7), memory)
        fitted = fit_sequence_encoder(SEQUENCES, settings, np.random.default_rng(7))
        np.testing.assert_array_equal(remembered.encode(SEQUENCES), fitted.encode(SEQUENCES))


def test_other_touches_have_another_map():
    memory = ReductionMemory(most=1)
    for sequences in (SEQUENCES, SEQUENCES[:12], SEQUENCES):
        remembered = fit_sequence_encoder(sequences, parameters(), np.random.default_rng(7), memory)
        fitted = fit_sequence_encoder(sequences, parameters(), np.random.default_rng(7))
        np.testing.assert_array_equal(remembered.encode(SEQUENCES), fitted.encode(SEQUENCES))
    assert len(memory._held) == 1
