"""Any classifier is evaluated on the experiment's own protocol."""

import pytest
from recognition.synthetic import features_table
from sklearn.svm import SVC

import visuohaptic as vh
from visuohaptic.base.errors import RecognitionError
from visuohaptic.evaluation.summary import summarise
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.experiment import run_pipeline
from visuohaptic.recognition.parameters import RecognitionParameters

FEW = RecognitionParameters(protocol={"maximum_splits": 3}, intervals={"bootstrap_samples": 200})
SVM = "support_vector_machine"


@pytest.fixture(scope="module")
def features():
    return features_table(separation=0.6)


def test_a_registered_classifier_has_the_figures_of_the_experiment(features):
    found, seed = vh.evaluate(SVM, features, FEW), ExperimentParameters().seed
    summary = summarise(*run_pipeline(features, FEW, seed), FEW.intervals, seed)
    figure = summary["results"]["paper"]["fixation"][SVM]
    assert (found.accuracy, found.low, found.high) == tuple(
        figure["accuracy"][name] for name in ("mean", "low", "high")
    )
    assert found.splits == figure["splits"]
    assert set(found.by_object) == set(figure["by_object"])


@pytest.mark.parametrize("given", [lambda table: table, lambda table: table.to_pandas()])
def test_an_estimator_is_tested_on_the_same_sequences_of_a_table_or_a_data_frame(features, given):
    registered, found = vh.evaluate(SVM, features, FEW), vh.evaluate(SVC(), given(features), FEW)
    for name in ("class", "object", "viewpoint", "split", "predicted"):
        assert found.predictions.column(name) == registered.predictions.column(name)
    assert found.accuracy == registered.accuracy
    assert "% correctly classified (" in repr(found)


def test_columns_that_are_missing_are_named(features):
    with pytest.raises(RecognitionError, match="contourlet_01"):
        vh.evaluate(SVC(), features.to_pandas().drop(columns="contourlet_01"), FEW)
