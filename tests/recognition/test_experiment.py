"""The paper's pipeline from table to tables."""

import itertools

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pytest
from recognition.synthetic import PAPER_FEATURES, features_table, with_column
from sklearn.naive_bayes import GaussianNB

from visuohaptic import recognition
from visuohaptic.base.errors import RecognitionError
from visuohaptic.evaluation.summary import select
from visuohaptic.recognition.classifiers import CLASSIFIERS, Classifier
from visuohaptic.recognition.experiment import (
    SplitPrediction,
    predict_splits,
    prediction_tables,
)
from visuohaptic.recognition.maps import MAPS
from visuohaptic.recognition.parameters import (
    ProtocolParameters,
    RecognitionParameters,
    SelfOrganisingMapParameters,
    unread_by,
)
from visuohaptic.recognition.pipelines import PaperPipeline
from visuohaptic.recognition.sequences import gather_pipeline, shuffle_touches
from visuohaptic.recognition.splits import Split, draw_splits
from visuohaptic.tables.phases import PREDICTIONS
from visuohaptic.tables.schema import check_table

SMALL = RecognitionParameters(
    protocol=ProtocolParameters(protocol="leave_one_object_a_class_out", maximum_splits=4)
)


def predictions_of(table, parameters=SMALL, seed=1):
    return recognition.run_pipeline(table, parameters, seed)[1]


def test_same_seed_gives_the_same_tables_whatever_the_order_of_rows():
    table = features_table()
    shuffled = table.take(np.random.default_rng(0).permutation(table.num_rows))
    first = recognition.run_pipeline(table, SMALL, 1)
    second = recognition.run_pipeline(shuffled, SMALL, 1)
    assert first[0].equals(second[0])
    assert first[1].equals(second[1])


OTHER_VALUES = {
    "classifiers": ["naive_bayes"],
    "cues": ["position"],
    "touch_scaling": "standardise",
    "sequence_scaling": "none",
    "self_organising_map": {"outputs": 3},
    "sequence": {"levels": 1},
    "classifier": {"neighbours": 1},
    "frame": "vertical",
    "order_free": {"waves": 7},
    "learned": {"units": 3},
}


@pytest.mark.parametrize("pipeline", ["paper", "order_free"])
def test_a_pipeline_reads_no_parameter_that_is_said_to_be_unread(pipeline):
    table, unread = features_table(), unread_by(pipeline)
    expected = recognition.run_pipeline(table, SMALL, 1, pipeline)
    for names, is_same in ((unread, True), (OTHER_VALUES.keys() - unread, False)):
        values = {name: OTHER_VALUES[name] for name in names}
        other = RecognitionParameters.model_validate({**values, "protocol": SMALL.protocol})
        found = recognition.run_pipeline(table, other, 1, pipeline)
        assert all(map(pa.Table.equals, found, expected)) == is_same


def test_strategies_are_tested_on_the_same_splits():
    objects = (4, 4, 4, 4)
    keys = ["split", "class", "object"]
    first, second = (
        predictions_of(features_table(name, objects, seed=seed)).select(keys).to_pylist()
        for seed, name in enumerate(["fixation", "random"])
    )
    assert first == second


@pytest.mark.parametrize("output", MAPS.names)
@pytest.mark.parametrize("training", ["batch", "online"])
def test_every_reading_of_the_map_runs_or_says_why_not(output, training):
    settings = SelfOrganisingMapParameters(output=output, training=training, lattice_levels=2)
    parameters = SMALL.model_copy(update={"self_organising_map": settings})
    table = features_table(separation=3.0)
    if (output, training) == ("lattice", "online"):
        with pytest.raises(RecognitionError, match="5 axes"):
            recognition.run_pipeline(table, parameters, 1)
        return
    scores, _ = recognition.run_pipeline(table, parameters, 1)
    assert scores.column("accuracy").to_numpy().mean() > 0.4


def test_singular_covariance_is_regularised_and_said():
    scores, _ = recognition.run_pipeline(features_table(), SMALL, 1)
    notes = select(scores, classifier="quadratic_discriminant").column("note")
    assert set(notes.to_pylist()) == {"singular covariance: Ledoit-Wolf shrinkage of every class"}
    others = scores.filter(pc.not_equal(scores["classifier"], "quadratic_discriminant"))
    assert set(others.column("note").to_pylist()) == {None}


@pytest.mark.parametrize("pipeline", ["paper", "order_free"])
@pytest.mark.parametrize("objects", [(2, 2), (2, 5, 3)])
def test_uneven_classes_the_smallest_set_and_constant_columns_run(objects, pipeline):
    table = features_table(objects=objects, viewpoints=8)
    table = with_column(table, "contourlet_05", np.zeros(table.num_rows))
    scores, predictions = recognition.run_pipeline(table, SMALL, 1, pipeline)
    chosen = SMALL if pipeline == "paper" else SMALL.order_free
    assert scores.num_rows == 4 * len(chosen.classifiers)
    without = predictions.num_rows if pipeline == "paper" else 0
    for name in ("probability", "voted"):
        assert predictions.column(name).null_count == without


def run_few_sequences(names, pipeline):
    """Run classifiers on classes of a single training sequence."""
    chosen = RecognitionParameters(
        protocol=SMALL.protocol, classifiers=names, order_free={"classifiers": names}
    )
    table = features_table(objects=(2, 2), viewpoints=1)
    return recognition.run_pipeline(table, chosen, 1, pipeline)


@pytest.mark.parametrize("pipeline", ["paper", "order_free"])
def test_a_classifier_that_can_not_be_fitted_is_a_gap_and_said(pipeline, caplog):
    names = ("k_nearest_neighbours", "quadratic_discriminant", "naive_bayes")
    for table in run_few_sequences(names, pipeline):
        assert set(table["classifier"].to_pylist()) == {"naive_bayes"}
    assert "quadratic_discriminant is left out: quadratic_discriminant fits cov" in caplog.text
    assert "k_nearest_neighbours is left out: Expected n_neighbors <= n_samples_fit" in caplog.text


class FailingOnce(GaussianNB):
    """Fails at the third fit."""

    fits = itertools.count()

    def fit(self, X, y):
        if next(self.fits) == 2:
            raise RecognitionError("not this time")
        return super().fit(X, y)


def test_a_classifier_that_can_not_be_fitted_in_one_split_has_no_row():
    entries = {
        "failing": Classifier.of("failing", FailingOnce()),
        "naive_bayes": CLASSIFIERS["naive_bayes"],
    }
    sequences = gather_pipeline(features_table(), SMALL, "paper")
    splits = draw_splits(sequences, SMALL.protocol, 1)
    predictions = predict_splits(sequences, PaperPipeline.of(SMALL, entries), splits, 1)
    for table in prediction_tables(sequences, predictions, "paper", "fixation"):
        assert set(table["classifier"].to_pylist()) == {"naive_bayes"}


@pytest.mark.parametrize("pipeline", ["paper", "order_free"])
def test_a_view_with_fewer_touches_is_left_out_and_said(pipeline, caplog):
    table = features_table(objects=(2, 2))
    short = pc.and_(pc.equal(table["object"], "object1"), pc.equal(table["viewpoint"], 2))
    table = table.filter(pc.invert(pc.and_(short, pc.greater(table["touch"], 2))))
    _, predictions = recognition.run_pipeline(table, SMALL, 1, pipeline)
    assert set(select(predictions, object="object1")["viewpoint"].to_pylist()) == {0, 1, 3}
    assert (
        "class0/object1 is left out of recognition by fixation from viewpoint 2, because"
        in caplog.text
    )
    assert recognition.fit_model(table, pipeline, "naive_bayes", SMALL, 1).touches == 5


@pytest.mark.parametrize("pipeline", ["paper", "order_free"])
def test_where_no_classifier_can_be_fitted_the_reason_is_given(pipeline):
    with pytest.raises(RecognitionError, match="at least 2 are needed"):
        run_few_sequences(("quadratic_discriminant",), pipeline)


def test_constant_feature_changes_no_answer():
    table = features_table()
    constant = with_column(table, "contourlet_05", np.zeros(table.num_rows))
    almost = with_column(table, "contourlet_05", np.full(table.num_rows, 0.1))
    scaled = SMALL.model_copy(update={"touch_scaling": "standardise"})
    assert predictions_of(constant, scaled).equals(predictions_of(almost, scaled))


def test_features_that_are_all_constant_are_refused():
    table = features_table()
    for name in PAPER_FEATURES:
        table = with_column(table, name, np.full(table.num_rows, 0.5))
    with pytest.raises(RecognitionError, match="one feature that varies is needed"):
        recognition.run_pipeline(table, SMALL, 1)


def test_class_that_is_one_and_the_same_touch_is_answered_by_all():
    table = features_table(objects=(2, 2))
    frozen = pc.equal(table["class"], "class0")
    for name in PAPER_FEATURES:
        table = with_column(table, name, pc.if_else(frozen, 0.25, table[name]))
    predictions = select(predictions_of(table), **{"class": "class0"})
    assert set(predictions["predicted"].to_pylist()) == {"class0"}


def test_object_under_two_names_is_noted():
    table = features_table(objects=(2, 2))
    twin = with_column(table.slice(0, 20), "object", ["twin"] * 20)
    scores, _ = recognition.run_pipeline(pa.concat_tables([table, twin]), SMALL, 1)
    assert all(
        "touches are identical for class0/object0 and class0/twin" in note
        for note in scores.column("note").to_pylist()
    )


def test_every_repeat_draws_splits_of_its_own():
    protocol = ProtocolParameters(protocol="grouped_folds", folds=2, fold_rounds=1, repeats=2)
    parameters = RecognitionParameters(protocol=protocol, classifiers=("naive_bayes",))
    table = features_table(objects=(6, 6), viewpoints=2)
    scores, predictions = recognition.run_pipeline(table, parameters, 1)
    assert scores.num_rows == 4
    check_table(PREDICTIONS, predictions)
    first, second = (select(predictions, seed=seed, split=0) for seed in (0, 1))
    assert first.column("object") != second.column("object")


def test_order_free_votes_by_probability_and_says_how_sure_it_is():
    table = features_table(separation=3.0)
    scores, predictions = recognition.run_pipeline(table, SMALL, 1, "order_free")
    assert set(scores.column("pipeline").to_pylist()) == {"order_free"}
    assert scores.column("accuracy").to_numpy().mean() > 0.8
    probability = predictions.column("probability").to_numpy()
    assert probability.min() >= 0.25 - 1e-9
    assert probability.max() <= 1
    right = pc.equal(predictions["class"], predictions["voted"]).to_numpy()
    votes = scores.column("object_accuracy").to_numpy()
    np.testing.assert_allclose(right.reshape(-1, 16).mean(axis=1), votes)


def test_unknown_pipeline_is_refused_by_name():
    with pytest.raises(
        RecognitionError, match="no pipeline worst; paper, order_free and learned are"
    ):
        recognition.run_pipeline(features_table(), SMALL, 1, "worst")


@pytest.mark.parametrize("pipeline", ["paper", "order_free"])
def test_both_pipelines_take_the_order_that_is_asked_for(pipeline):
    kept, shuffled = (
        gather_pipeline(features_table(), RecognitionParameters(order=order), pipeline, seed=4)
        for order in ("kept", "shuffled")
    )
    np.testing.assert_array_equal(shuffled.features, shuffle_touches(kept, 4).features)
    assert not np.array_equal(shuffled.features, kept.features)


@pytest.mark.parametrize("protocol", ["grouped_folds", "new_viewpoint"])
def test_each_repeat_tests_every_sequence_once(protocol):
    settings = ProtocolParameters(protocol=protocol, folds=2, fold_rounds=1, repeats=2)
    parameters = RecognitionParameters(protocol=settings, classifiers=("naive_bayes",))
    table = features_table(objects=(6, 6), viewpoints=4)
    scores, predictions = recognition.run_pipeline(table, parameters, 1)
    assert (scores.num_rows, predictions.num_rows) == (4, 2 * 12 * 4)


def test_objects_are_voted_by_the_mean_of_log_probabilities_of_all_their_sequences():
    table = features_table(objects=(2, 2, 2), viewpoints=3)
    sequences = gather_pipeline(table, SMALL, "order_free", 1)
    split = Split(0, 0, np.zeros(0, np.int64), np.flatnonzero(sequences.object_index < 3))
    generator = np.random.default_rng(4)
    shares = generator.dirichlet([0.4, 0.4, 0.4], len(split.test))
    prediction = SplitPrediction(split, "naive_bayes", shares.argmax(axis=1), np.log(shares))
    scores, predictions = prediction_tables(sequences, [prediction], "order_free", "fixation")
    # By hand: the class with the largest product of probabilities over an object's three sequences.
    owners = sequences.object_index[split.test]
    voted = [np.prod(shares[owners == owner], axis=0).argmax() for owner in owners]
    first = [shares[owners == owner][0].argmax() for owner in owners]
    assert voted != first
    assert predictions["voted"].to_pylist() == [f"class{number}" for number in voted]
    right = [number == sequences.labels[row] for number, row in zip(voted, split.test, strict=True)]
    assert 0 < np.mean(right) < 1
    assert scores["object_accuracy"].to_pylist() == [pytest.approx(np.mean(right))]
