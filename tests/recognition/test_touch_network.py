"""The network of touches or of pairs of touches, and pipeline `learned`."""

import numpy as np
import pytest
from recognition.synthetic import features_table
from scipy.spatial.transform import Rotation
from sklearn.base import clone

from visuohaptic.base.errors import RecognitionError
from visuohaptic.recognition.descriptors import draw_waves
from visuohaptic.recognition.experiment import run_pipeline
from visuohaptic.recognition.model import fit_model
from visuohaptic.recognition.parameters import (
    TOUCH_NETWORK,
    LearnedParameters,
    ProtocolParameters,
    RecognitionParameters,
)
from visuohaptic.recognition.pipelines import LearnedPipeline
from visuohaptic.recognition.sequences import gather_pipeline
from visuohaptic.recognition.touch_network import (
    ELEMENTS,
    MOST_ELEMENTS,
    learned_rows,
    pair_elements,
    touch_elements,
)

FEW = LearnedParameters(units=16, passes=10)
FOLDS = ProtocolParameters(protocol="grouped_folds", folds=2)
POSE = ("x", "y", "z", "normal_x", "normal_y", "normal_z")


def parameters_of(**changes):
    return RecognitionParameters(learned=FEW, protocol=FOLDS, **changes)


def sequences_of(parameters, **table):
    return gather_pipeline(features_table(**table), parameters, "learned")


def rows_of(sequences, parameters, features=None):
    """Return the rows of sequences, or of other features with the same columns."""
    waves = draw_waves(parameters.order_free, 0)
    chosen = sequences.features if features is None else features
    return learned_rows(chosen, sequences.feature_names, waves, parameters)


def classifier_of(parameters, **changes):
    return clone(LearnedPipeline.of(parameters, 0).classifiers[TOUCH_NETWORK]).set_params(
        random_state=0, **changes
    )


@pytest.mark.parametrize("frame", ELEMENTS)
def test_neither_the_order_of_touches_nor_a_copy_of_all_changes_the_network(frame):
    parameters = parameters_of(frame=frame)
    sequences = sequences_of(parameters)
    rows = rows_of(sequences, parameters)
    network = classifier_of(parameters, discriminant_weight=0.0).fit(rows, sequences.labels)
    expected = network.predict_proba(rows)
    turned = rows_of(sequences, parameters, sequences.features[:, ::-1])
    np.testing.assert_allclose(network.predict_proba(turned), expected, atol=1e-5)
    if ELEMENTS[frame] is touch_elements:
        copied = rows_of(sequences, parameters, np.repeat(sequences.features, 3, axis=1))
        np.testing.assert_allclose(network.predict_proba(copied), expected, atol=1e-5)


def test_no_rotation_and_no_translation_changes_the_pairs_where_nothing_is_known():
    parameters = parameters_of(frame="none")
    sequences = sequences_of(parameters)
    names, waves = sequences.feature_names, draw_waves(parameters.order_free, 0)
    moved = sequences.features.copy()
    x, _, _, normal_x, _, _ = (names.index(name) for name in POSE)
    turn = Rotation.from_rotvec([0.3, -1.1, 0.7]).as_matrix().T
    moved[..., x : x + 3] = moved[..., x : x + 3] @ turn + [0.2, 0.1, -0.4]
    moved[..., normal_x : normal_x + 3] = moved[..., normal_x : normal_x + 3] @ turn
    still = pair_elements(sequences.features, names, waves, "none")
    np.testing.assert_allclose(pair_elements(moved, names, waves, "none"), still, atol=1e-9)


def test_the_seed_decides_the_fit():
    parameters = parameters_of()
    sequences = sequences_of(parameters)
    rows = rows_of(sequences, parameters)
    fits = [
        classifier_of(parameters).set_params(random_state=seed).fit(rows, sequences.labels)
        for seed in (3, 3, 4)
    ]
    first, again, other = (fitted.predict_proba(rows) for fitted in fits)
    assert np.array_equal(first, again)
    assert not np.allclose(first, other)


def test_the_network_learns_a_class_that_shows_only_in_how_two_numbers_of_a_touch_go_together():
    generator = np.random.default_rng(0)
    labels = generator.integers(2, size=200)
    signs = generator.choice([-1.0, 1.0], size=(200, 6))
    together = np.where(labels, 1.0, -1.0)[:, None] * signs
    rows = np.empty(200, dtype=[("descriptors", float, 2), ("elements", np.float32, (6, 2))])
    rows["elements"] = np.stack([signs, together], axis=-1)
    rows["descriptors"] = generator.normal(size=(200, 2))
    parameters = RecognitionParameters(learned=LearnedParameters(units=32, passes=200))
    fitted = classifier_of(parameters).fit(rows[:100], labels[:100])
    assert (fitted.predict(rows[100:]) == labels[100:]).mean() > 0.95


def test_the_weight_lets_the_discriminant_decide():
    parameters = parameters_of()
    sequences = sequences_of(parameters, separation=0.3)
    rows, labels = rows_of(sequences, parameters), sequences.labels
    heavy = classifier_of(parameters, discriminant_weight=1e6).fit(rows, labels)
    assert np.array_equal(heavy.predict(rows), heavy.discriminant_.predict(rows["descriptors"]))


def test_a_long_sequence_trains_with_a_sample_of_its_pairs_and_is_tested_with_all():
    parameters = parameters_of(frame="none", touches=8)
    sequences = sequences_of(parameters, touches=8)
    rows = rows_of(sequences, parameters)
    assert rows["elements"].shape[1] == 8 * 7
    fitted = classifier_of(parameters).fit(rows, sequences.labels)
    assert fitted.scaling_.n_samples_seen_ == len(rows) * MOST_ELEMENTS
    changed = rows.copy()
    changed["elements"][:, -1] += 5
    assert not np.allclose(fitted.predict_proba(changed), fitted.predict_proba(rows))


@pytest.mark.parametrize("frame", ELEMENTS)
@pytest.mark.parametrize("touches", [1, 5])
def test_the_experiment_has_scores_and_probabilities_of_the_network(frame, touches):
    parameters = parameters_of(frame=frame, touches=touches)
    scores, predictions = run_pipeline(features_table(separation=5.0), parameters, 1, "learned")
    assert set(scores.column("classifier").to_pylist()) == {TOUCH_NETWORK}
    assert scores.column("accuracy").to_numpy().mean() > 0.5
    assert predictions.column("probability").null_count == 0


def test_a_single_touch_is_its_own_element_where_pairs_are_learnt():
    parameters = parameters_of(frame="none", touches=1)
    assert rows_of(sequences_of(parameters), parameters)["elements"].shape[1] == 1


def test_no_model_is_trained_in_this_pipeline():
    with pytest.raises(RecognitionError, match="No model can be trained in pipeline learned; pip"):
        fit_model(features_table(), "learned", TOUCH_NETWORK, RecognitionParameters(), 0)
