"""Any classifier is evaluated on the experiment's own protocol."""

from functools import cache
from itertools import accumulate, cycle
from types import SimpleNamespace

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pytest
from recognition.synthetic import features_table
from sklearn.cluster import KMeans
from sklearn.discriminant_analysis import LinearDiscriminantAnalysis
from sklearn.ensemble import IsolationForest
from sklearn.naive_bayes import MultinomialNB
from sklearn.neighbors import KNeighborsClassifier
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.svm import SVC, SVR

import visuohaptic as vh
from visuohaptic.base.errors import ParameterError, RecognitionError
from visuohaptic.evaluation import evaluating
from visuohaptic.evaluation.evaluating import Seconds
from visuohaptic.evaluation.summary import summarise
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.experiment import run_pipeline
from visuohaptic.recognition.parameters import RecognitionParameters

FEW = RecognitionParameters(protocol={"maximum_splits": 3})
SMALL = {"rendering.resolution": 64}
SVM = "support_vector_machine"


@cache
def touched():
    return vh.example("bottle").touch(1, parameters=SMALL)


@pytest.fixture(scope="module")
def features():
    return features_table(separation=0.6)


def test_a_registered_classifier_has_the_figures_of_the_experiment(features):
    found, seed = vh.evaluate(SVM, features, FEW), ExperimentParameters().seed
    summary = summarise(*run_pipeline(features, FEW, seed), FEW.intervals)
    figure = summary["results"]["paper"]["fixation"][SVM]
    assert (found.accuracy, found.low, found.high) == tuple(
        figure["accuracy"][name] for name in ("mean", "low", "high")
    )
    assert found.splits == figure["splits"]
    assert set(found.by_object) == set(figure["by_object"])


def test_seconds_of_fits_and_of_predictions_are_summed_over_splits(features, monkeypatch):
    # Each split reads the clocks at its start, after the fit and at its end.
    processor, wall = (accumulate(cycle((step, 2 * step, 3 * step))) for step in (1.0, 10.0))
    clocks = {"process_time": processor.__next__, "perf_counter": wall.__next__}
    monkeypatch.setattr(evaluating, "time", SimpleNamespace(**clocks))
    found = vh.evaluate(SVM, features, FEW)
    assert found.splits > 1
    assert found.fit == Seconds(2.0 * found.splits, 20.0 * found.splits)
    assert found.predict == Seconds(3.0 * found.splits, 30.0 * found.splits)


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


def as_large_text(table):
    return table.cast(
        pa.schema(
            [
                field.with_type(pa.large_string()) if field.type == pa.string() else field
                for field in table.schema
            ]
        )
    )


def as_categories(table):
    for name in ("class", "object", "strategy", "contact_state"):
        index = table.schema.get_field_index(name)
        table = table.set_column(index, name, table.column(name).dictionary_encode())
    return table


OTHERS = {
    "large text": as_large_text,
    "text views": lambda table: table.set_column(
        0, "class", table.column("class").cast(pa.string_view())
    ),
    "categories": as_categories,
    "categories of pandas": lambda table: table.to_pandas().astype(
        {"class": "category", "object": "category"}
    ),
    "an index of pandas": lambda table: table.to_pandas().set_index(["class", "object"]),
    "a mapping": lambda table: {name: table.column(name).to_numpy() for name in table.column_names},
    "lists": lambda table: table.to_pydict(),
    "other widths": lambda table: table.to_pandas().astype(
        {"viewpoint": "int64", "touch": "float64"}
    ),
    "one more column": lambda table: table.append_column("mine", table.column("x")),
    "another order": lambda table: table.select(table.column_names[::-1]),
}


@pytest.mark.parametrize("kind", OTHERS)
def test_tables_of_every_kind_have_the_same_figure(features, kind):
    expected = vh.evaluate(SVM, features, FEW)
    assert vh.evaluate(SVM, OTHERS[kind](features), FEW).accuracy == expected.accuracy


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda table: table.drop_columns(["contourlet_01"]), "no column contourlet_01"),
        (lambda table: table.append_column("x", table.column("y")), "column x is there twice"),
        (
            lambda table: table.set_column(0, "class", pa.array([1] * len(table))),
            "class is int64 and does not fit string",
        ),
        (
            lambda table: table.to_pandas().assign(touch=0.5),
            "touch is double and does not fit int32",
        ),
        (lambda table: table.to_pandas().assign(x=True), "x is bool and does not fit double"),
        (
            lambda table: table.to_pandas().assign(x=float("nan")),
            "column x has .* missing values|NaN",
        ),
        (lambda table: {"x": [1.0], "y": [1.0, 2.0]}, "Arrow can't convert the given table"),
        (
            lambda table: table.filter(pc.equal(table["object"], "object0")),
            r"No class has two objects .* by fixation \(class0, class1, class2, class3: one object each\); at least two classes",
        ),
        (
            lambda table: table.filter(pc.equal(table["class"], "class1")),
            r"one class \(class1\) with enough objects; at least two classes",
        ),
        (lambda table: table.slice(0, 0), "The features hold no touches"),
        (
            lambda table: touched().touches,
            r"^This is table touches; evaluate reads results/features, or the table touches with inputs='touches'\.$",
        ),
        (lambda table: touched().views, "^This is table views; evaluate reads results/features"),
        (
            lambda table: touched().fixations.to_pandas(),
            "^This is table fixations; evaluate reads results/features",
        ),
        (lambda table: touched(), r"^This is an Exploration; .*: pass exploration\.features\.$"),
        (lambda table: [table, table], r"^This is a list; .*: join .* by pyarrow\.concat_tables"),
        (lambda table: [touched()], r"^This is a list; .*: join .* by pyarrow\.concat_tables"),
        (lambda table: [1, 2], "is given as list"),
        (lambda table: None, "is given as NoneType"),
    ],
)
def test_tables_that_lack_something_are_refused_in_a_sentence(features, change, sentence):
    with pytest.raises(RecognitionError, match=sentence):
        vh.evaluate(SVM, change(features), FEW)


def test_nobody_is_told_to_delete_a_file_of_their_own(tmp_path):
    (tmp_path / "mine.csv").write_text("class,object\n" * 9)
    for name, sentence in (
        ("mine.csv", "can't be read as Parquet"),
        ("none.parquet", "there is no file"),
    ):
        with pytest.raises(RecognitionError, match=sentence) as error:
            vh.evaluate(SVM, tmp_path / name, FEW)
        assert "; delete" not in str(error.value)


class Failing(SVC):
    """A classifier that can be fitted and can't predict."""

    def predict(self, _rows):
        return self.nothing


class Predicting(SVC):
    """A classifier whose predictions a function changes."""

    def __init__(self, change=None):
        super().__init__()
        self.change = change

    def predict(self, rows):
        return self.change(super().predict(rows))


class Duck:
    """A classifier that knows scikit-learn's names only."""

    def get_params(self, deep=True):
        return {}

    def set_params(self, **_):
        return self

    def fit(self, _rows, labels):
        self.classes_ = np.unique(labels)
        return self

    def predict(self, rows):
        return np.zeros(len(rows), dtype=int)


@pytest.mark.parametrize(
    ("estimator", "sentence"),
    [
        (SVC, r"SVC is a class; .* SVC\(\)"),
        (None, "None is without get_params"),
        (SVR(), "is of estimator type regressor"),
        (KMeans(), "is of estimator type clusterer"),
        (StandardScaler(), "is of estimator type None"),
        (make_pipeline(StandardScaler(), SVR()), "is of estimator type regressor"),
        (IsolationForest(), "is of estimator type outlier_detector"),
        (SVC(kernel="precomputed"), "can't be fitted or tested .* square matrix"),
        (KNeighborsClassifier(10_000), "can't be fitted or tested .* n_neighbors"),
        (MultinomialNB(), "can't be fitted or tested .* Negative"),
        (LinearDiscriminantAnalysis(solver="eigen"), "can't be fitted or tested"),
        (Failing(), "can't be fitted or tested .* 'nothing'"),
    ],
)
def test_what_is_no_classifier_or_does_not_fit_is_refused_with_the_reason(
    features, estimator, sentence
):
    with pytest.raises(RecognitionError, match=sentence):
        vh.evaluate(estimator, features, FEW)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda labels: labels == 1, "predicted labels of type bool; whole numbers, as in y"),
        (
            lambda labels: (labels == 1).astype(object),
            "predicted labels of type object; whole numbers",
        ),
        (lambda labels: labels + 0j, "predicted labels of type complex128; whole numbers"),
        (
            lambda labels: np.ma.array(labels, mask=labels == 1),
            "predicted labels with masked values",
        ),
        (lambda labels: labels + 9, "predicted the label"),
    ],
)
def test_predictions_that_are_no_labels_are_refused(features, change, sentence):
    with pytest.raises(RecognitionError, match=sentence):
        vh.evaluate(Predicting(change), features, FEW)


@pytest.mark.parametrize("kind", [np.int8, np.float64, object])
def test_labels_of_any_type_of_numbers_are_predictions(features, kind):
    expected = vh.evaluate(SVC(), features, FEW)
    found = vh.evaluate(Predicting(lambda labels: labels.astype(kind)), features, FEW)
    assert found.predictions.equals(expected.predictions)


def test_an_object_with_the_names_of_a_classifier_is_one(features):
    assert vh.evaluate(Duck(), features, FEW).accuracy == pytest.approx(0.25)


def test_parameters_of_another_section_are_refused(features):
    with pytest.raises(ParameterError, match="parameters is of type dict"):
        vh.evaluate(SVM, features, {"touches": 3})


def without(table, *names):
    """Leave out the second and third object of classes."""
    keys = pc.binary_join_element_wise(table["class"], table["object"], "/")
    gone = [f"{name}/object{number}" for name in names for number in (1, 2)]
    return table.filter(pc.invert(pc.is_in(keys, pa.array(gone))))


def test_classes_of_one_object_are_left_out_and_named(features):
    found = vh.evaluate(SVC(), without(features, "class1", "class3"), FEW)
    assert {name.split("/")[0] for name in found.by_object} == {"class0", "class2"}
    [note] = found.notes
    assert note.startswith("classes class1, class3 left out: fewer than two objects")
    assert f"; note: {note}" in repr(found)


def test_one_class_of_two_objects_is_refused_by_the_reason(features):
    with pytest.raises(
        RecognitionError,
        match=r"^Only class class2 has two objects .*; class0, class1, class3 have fewer; at least two",
    ):
        vh.evaluate(SVC(), without(features, "class0", "class1", "class3"), FEW)


def test_objects_that_were_loaded_without_a_key_need_one():
    bottle = vh.example("bottle").surface
    unnamed = vh.load((bottle.vertices, bottle.faces)).touch(1, parameters=SMALL)
    with pytest.raises(RecognitionError, match=r"^All objects are of class unknown; .* vh.load"):
        vh.evaluate(SVC(), unnamed.features)
