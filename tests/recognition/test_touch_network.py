"""The network of touches or of pairs of touches, and pipeline `learned`."""

import numpy as np
import pyarrow.compute as pc
import pytest
from recognition.synthetic import features_table
from scipy.spatial.transform import Rotation
from sklearn.base import clone
from sklearn.svm import SVC

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
from visuohaptic.recognition.stored_models import load_model, save_model
from visuohaptic.recognition.touch_network import (
    ELEMENTS,
    MOST_ELEMENTS,
    learned_rows,
    pair_elements,
    touch_elements,
)

FEW = LearnedParameters(units=16, passes=10, pair_passes=10)
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
    assert fitted.network_.t_ == len(rows) * MOST_ELEMENTS * FEW.passes
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


@pytest.mark.parametrize("frame", ELEMENTS)
@pytest.mark.parametrize("touches", [1, 3])
def test_the_passes_are_those_of_the_elements_that_are_learnt(frame, touches):
    learned = LearnedParameters(units=4, passes=3, pair_passes=2)
    parameters = RecognitionParameters(frame=frame, touches=touches, learned=learned)
    sequences = sequences_of(parameters)
    rows = rows_of(sequences, parameters)
    fitted = classifier_of(parameters).fit(rows, sequences.labels)
    has_pairs = rows["elements"].shape[1] == 6
    assert has_pairs == (frame in {"none", "centre"} and touches > 1)
    assert fitted.network_.n_iter_ == (2 if has_pairs else 3)


def test_a_single_touch_is_its_own_element_where_pairs_are_learnt():
    parameters = parameters_of(frame="none", touches=1)
    assert rows_of(sequences_of(parameters), parameters)["elements"].shape[1] == 1


def one_object(table, **chosen):
    """Return the rows of one object of a table, and of chosen values of further columns."""
    wanted = {"class": "class1", "object": "object0", **chosen}
    for name, value in wanted.items():
        table = table.filter(pc.equal(table.column(name), value))
    return table


@pytest.fixture(scope="module", params=ELEMENTS)
def model(request):
    parameters = RecognitionParameters(frame=request.param, learned=FEW)
    table = features_table(objects=(4, 4, 4), separation=3.0)
    return fit_model(table, "learned", TOUCH_NETWORK, parameters, 1)


def test_a_model_is_saved_and_answers_the_same_bit_for_bit(model, tmp_path):
    save_model(model, tmp_path / "model.skops")
    touched = one_object(features_table(objects=(4, 4, 4), separation=3.0))
    answer = model.answer(touched)
    assert load_model(tmp_path / "model.skops").answer(touched) == answer
    assert next(iter(answer.probabilities)) == "class1"
    assert "class1" in answer.candidates
    assert answer.compared == 12


def test_a_viewpoint_of_a_single_touch_counts_only_where_touches_are_learnt(model):
    single = one_object(features_table(objects=(4, 4, 4), separation=3.0), viewpoint=0, touch=0)
    if ELEMENTS[model.parameters.frame] is touch_elements:
        assert sum(model.recognise(single).values()) == pytest.approx(1)
    else:
        with pytest.raises(RecognitionError, match="No viewpoint has 2 touches"):
            model.recognise(single)


def test_a_shorter_sequence_counts_beside_whole_ones(model):
    touched = one_object(features_table(objects=(4, 4, 4), separation=3.0))
    is_cut = pc.and_(
        pc.equal(touched.column("viewpoint"), 0), pc.greater(touched.column("touch"), 1)
    )
    assert sum(model.recognise(touched.filter(pc.invert(is_cut))).values()) == pytest.approx(1)


def test_a_classifier_of_another_pipeline_is_refused():
    with pytest.raises(
        RecognitionError, match="learned has no classifier naive_bayes; touch_network"
    ):
        fit_model(features_table(), "learned", "naive_bayes", RecognitionParameters(), 0)


def test_a_file_with_a_machine_inside_the_network_is_refused_before_the_machine_reads(tmp_path):
    table = features_table(objects=(2, 2), separation=3.0)
    model = fit_model(table, "learned", TOUCH_NETWORK, RecognitionParameters(learned=FEW), 1)
    inner = model.estimator[-1].calibrated_classifiers_[0].estimator
    inner.discriminant_ = SVC(probability=True)
    save_model(model, tmp_path / "model.skops")
    with pytest.raises(RecognitionError, match="network of touches are of other types"):
        load_model(tmp_path / "model.skops")
