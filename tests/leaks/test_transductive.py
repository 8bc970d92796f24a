"""Scalings, map and projections are fitted without test objects: what a test object felt changes no other's answer."""

from dataclasses import replace

import numpy as np
import pytest
from leaks.predicting import PARAMETERS, predict
from recognition.synthetic import features_table

from visuohaptic.recognition.sequences import gather_pipeline
from visuohaptic.recognition.splits import draw_splits


@pytest.mark.parametrize("pipeline", ["paper", "order_free"])
def test_noise_in_place_of_half_of_the_test_objects_changes_no_answer_about_the_others(pipeline):
    sequences = gather_pipeline(features_table(separation=2.0), PARAMETERS, pipeline)
    generator = np.random.default_rng(0)
    splits = draw_splits(sequences, PARAMETERS.protocol, 0)
    split = splits[generator.integers(len(splits))]
    tested = np.unique(sequences.object_index[split.test])
    is_noise = np.isin(sequences.object_index, tested[len(tested) // 2 :])
    values = sequences.features.copy()
    # What is fitted on such noise classifies nothing else correctly.
    values[is_noise] = generator.normal(scale=1e3, size=values[is_noise].shape)
    before = predict(sequences, split, pipeline)
    after = predict(replace(sequences, features=values), split, pipeline)
    kept = ~is_noise[split.test]
    assert kept.any()
    assert before
    for name in before:
        np.testing.assert_array_equal(after[name][kept], before[name][kept], name)
