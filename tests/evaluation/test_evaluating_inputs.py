"""A classifier of one's own gets features, descriptors, or imprints and poses, on splits of one's own too."""

import io
import sys
import warnings
from functools import partial
from typing import ClassVar

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest
from evaluation.own_estimators import (
    Changing,
    Keeping,
    Locked,
    Naming,
    Ragged,
    Scoring,
    Sized,
    Unprintable,
    Untagged,
)
from recognition.synthetic import features_table
from sklearn import get_config
from sklearn.decomposition import PCA
from sklearn.discriminant_analysis import LinearDiscriminantAnalysis
from sklearn.ensemble import RandomForestClassifier, VotingClassifier
from sklearn.model_selection import (
    GridSearchCV,
    GroupKFold,
    GroupShuffleSplit,
    KFold,
    StratifiedGroupKFold,
)
from sklearn.naive_bayes import GaussianNB
from sklearn.neighbors import KNeighborsClassifier
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import FunctionTransformer, RobustScaler, StandardScaler
from sklearn.svm import SVC
from tqdm import tqdm

import visuohaptic as vh
from visuohaptic.base.errors import ParameterError, RecognitionError, RecognitionWarning
from visuohaptic.evaluation.intervals import compare_paired
from visuohaptic.evaluation.summary import summarise
from visuohaptic.recognition import flatten_touches, touch_arrays
from visuohaptic.recognition.experiment import run_pipeline
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.tables.phases import FEATURES, TANGENT_NAMES, TOUCHES
from visuohaptic.tables.schema import build_table, names_of, write_table

FEW = RecognitionParameters(protocol={"maximum_splits": 3})
SIDE = 4
FLAT = make_pipeline(FunctionTransformer(flatten_touches), GaussianNB())


@pytest.fixture(scope="module")
def features():
    return features_table(separation=0.6)


def touches_of(features, seed=0, side=SIDE):
    """Add imprints to touches: noise about the first contourlet's deviation."""
    generator = np.random.default_rng(seed)
    columns = {
        name: features.column(name)
        for name in names_of(FEATURES.columns)
        if name in names_of(TOUCHES.columns)
    }
    middle = np.clip(features.column("contourlet_01").to_numpy() / 4, 0, 0.9)
    noise = 0.1 * generator.random((len(features), side * side))
    images = (middle[:, None] + noise).astype(np.float32)
    columns |= {"image": images, "penetration": 0.0, "rank": features.column("touch")}
    return build_table(TOUCHES, columns | dict.fromkeys(TANGENT_NAMES, 0.5))


@pytest.fixture(scope="module")
def touches(features):
    return touches_of(features)


@pytest.fixture
def given(monkeypatch):
    monkeypatch.setattr(Keeping, "given", [])
    return Keeping.given


@pytest.mark.parametrize("name", ["linear_discriminant", "decision_tree"])
def test_descriptors_are_those_of_pipeline_order_free_and_so_is_the_figure(features, name):
    chosen = RecognitionParameters(
        protocol={"maximum_splits": 3}, order_free={"classifiers": [name]}
    )
    found = vh.evaluate(name, features, chosen, inputs="descriptors")
    tables = run_pipeline(features, chosen, 2018, "order_free")
    figure = summarise(*tables, chosen.intervals)["results"]["order_free"]["fixation"][name]
    assert (found.accuracy, found.low, found.high) == tuple(
        figure["accuracy"][end] for end in ("mean", "low", "high")
    )
    assert found.predictions.column("predicted") == tables[1].column("predicted")


def test_an_estimator_of_ones_own_needs_no_probabilities_for_descriptors(features, given):
    assert vh.evaluate(Keeping(), features, FEW, inputs="descriptors").accuracy == 0.25
    train, _, groups = given[0]
    assert train.ndim == 2
    assert len(groups) == len(train)


@pytest.mark.parametrize("inputs", ["features", "descriptors"])
def test_other_test_objects_change_nothing_that_an_estimator_is_fitted_on(features, inputs, given):
    tested = ["class0/object0", "class1/object0", "class2/object0", "class3/object0"]
    vh.evaluate(Keeping(), features, inputs=inputs, splits=[tested])
    frame = features.to_pandas()
    frame.loc[frame.object == "object0", ["x", "contourlet_03"]] = 0.123
    vh.evaluate(Keeping(), frame, inputs=inputs, splits=[tested])
    (first, _, _), (first_test, _, _), (second, _, _), (second_test, _, _) = given
    assert np.array_equal(first, second)
    assert not np.array_equal(first_test, second_test)


def test_touches_are_imprints_and_poses_in_the_order_of_the_labels(touches, given):
    vh.evaluate(Keeping(), touches, FEW, inputs="touches")
    train, labels, groups = given[0]
    assert train.shape == (32, 5)
    assert train["imprint"].shape == (32, 5, SIDE, SIDE)
    assert train["pose"].shape == (32, 5, 6)
    assert {train[name].dtype for name in train.dtype.names} == {np.dtype("float32")}
    assert len(set(groups)) == 8
    rows = touches.to_pandas()
    for sequence in (0, 7, 31):
        owner = (f"class{labels[sequence]}", f"object{groups[sequence] % 3}")
        same = rows[(rows["class"] == owner[0]) & (rows["object"] == owner[1])]
        poses = same[["x", "y", "z", "normal_x", "normal_y", "normal_z"]].to_numpy(np.float32)
        at = np.flatnonzero((poses == train["pose"][sequence, 2]).all(axis=1))
        assert same["touch"].iloc[at[0]] == 2
        assert np.array_equal(same["image"].iloc[at[0]], train["imprint"][sequence, 2].ravel())


def test_arrays_have_rows_of_any_order_and_leave_short_views_out(touches):
    arrays, classes, objects = touch_arrays(touches)
    assert (len(arrays), len(set(classes)), len(set(objects))) == (48, 4, 12)
    mixed = touches.take(np.random.default_rng(1).permutation(len(touches)))
    assert np.array_equal(touch_arrays(mixed)[0], arrays)
    fewer, _, _ = touch_arrays(touches.slice(1))
    assert np.array_equal(fewer, arrays[1:])


def test_another_order_of_the_touches_moves_imprints_with_poses(touches):
    arrays, _, _ = touch_arrays(touches)
    drawn, _, _ = touch_arrays(touches, RecognitionParameters(order="shuffled"))
    moved = 0
    for kept, other in zip(arrays, drawn, strict=True):
        assert sorted(touch.tobytes() for touch in kept) == sorted(
            touch.tobytes() for touch in other
        )
        moved += not np.array_equal(kept, other)
    assert moved > len(arrays) / 2


def test_flat_touches_hold_imprint_pose_and_size_touch_by_touch(touches):
    arrays, _, _ = touch_arrays(touches)
    flat = flatten_touches(arrays).reshape(len(arrays), 5, SIDE * SIDE + 7)
    assert np.array_equal(flat[3, 1, : SIDE * SIDE], arrays["imprint"][3, 1].ravel())
    assert np.array_equal(flat[3, 1, SIDE * SIDE : -1], arrays["pose"][3, 1])
    assert (flat[..., -1] == np.float32(0.1)).all()


@pytest.mark.slow
def test_scikit_learn_estimators_take_flat_touches_with_the_same_result_in_two_processes(touches):
    first = vh.evaluate(FLAT, touches, FEW, inputs="touches")
    assert first.accuracy > 0.3
    second = vh.evaluate(FLAT, touches, FEW, inputs="touches", n_jobs=2)
    assert first.predictions == second.predictions


def test_nested_estimators_without_a_seed_get_one(features):
    forest = make_pipeline(FunctionTransformer(), RandomForestClassifier(3, max_depth=1))
    first, second = (vh.evaluate(forest, features, FEW) for _ in range(2))
    assert first.predictions == second.predictions
    other = vh.evaluate(forest, features, FEW, seed=1, splits=None)
    assert first.predictions != other.predictions


def test_a_seed_of_the_estimator_is_replaced_but_a_nested_seed_is_kept(features):
    first, second = (RandomForestClassifier(3, max_depth=1, random_state=seed) for seed in (1, 2))
    replaced = [vh.evaluate(one, features, FEW).predictions for one in (first, second)]
    assert replaced[0] == replaced[1]
    nested = [
        vh.evaluate(make_pipeline(FunctionTransformer(), one), features, FEW).predictions
        for one in (first, second)
    ]
    assert nested[0] != nested[1]


class Halves:
    """A splitter that is none of scikit-learn's, and needs groups."""

    def get_n_splits(self, rows=None, labels=None, groups=None):
        return 1

    def split(self, rows, labels=None, groups=None):
        first = np.isin(groups, np.unique(groups)[::2])
        yield np.flatnonzero(first), np.flatnonzero(~first)


KNN = KNeighborsClassifier()
GROUPED = GridSearchCV(KNN, {"n_neighbors": [3]}, cv=GroupKFold(2))


@pytest.mark.parametrize(
    "cv", [GroupKFold(2), Halves(), KFold(2), 2, None], ids=lambda cv: type(cv).__name__
)
def test_the_splitter_of_a_search_gets_the_objects_if_it_takes_groups(features, cv):
    search = GridSearchCV(KNN, {"n_neighbors": [3]}, cv=cv)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = vh.evaluate(search, features, splits=2)
    assert found.accuracy == vh.evaluate(KNeighborsClassifier(3), features, splits=2).accuracy


@pytest.mark.parametrize(
    "nested",
    [
        make_pipeline(FunctionTransformer(), GROUPED),
        VotingClassifier([("one", GROUPED)]),
        GridSearchCV(GROUPED, {"refit": [True]}, cv=GroupKFold(2)),
    ],
    ids=lambda estimator: type(estimator).__name__,
)
def test_groups_reach_the_splitter_of_a_search_within_an_estimator(features, nested):
    found = vh.evaluate(nested, features, splits=2)
    assert found.accuracy == vh.evaluate(KNeighborsClassifier(3), features, splits=2).accuracy
    assert not get_config()["enable_metadata_routing"]


class Recording(GroupKFold):
    """Keeps the groups of each split."""

    given: ClassVar = []

    def split(self, X, y=None, groups=None):
        self.given.append(np.array(groups))
        return super().split(X, y, groups)


def test_the_groups_of_an_inner_splitter_are_the_training_objects(features, monkeypatch):
    monkeypatch.setattr(Recording, "given", [])
    search = GridSearchCV(KNN, {"n_neighbors": [3]}, cv=Recording(2))
    vh.evaluate(make_pipeline(FunctionTransformer(), search), features, splits=1)
    [groups] = Recording.given
    # Eight training objects of 12, with four sequences each.
    assert np.unique(groups, return_counts=True)[1].tolist() == [4] * 8


def test_an_inner_splitter_without_a_seed_gets_one(features):
    search = GridSearchCV(KNN, {"n_neighbors": [1, 3, 5]}, cv=GroupShuffleSplit(2))
    first, second = (vh.evaluate(search, features, splits=4).predictions for _ in range(2))
    assert first.equals(second)
    assert search.cv.random_state is None


class Column(KNeighborsClassifier):
    """Predicts a column, as networks do."""

    def predict(self, X):
        return super().predict(X)[:, None]


def test_predictions_may_be_a_column(features):
    expected = vh.evaluate(KNeighborsClassifier(), features, splits=2)
    assert vh.evaluate(Column(), features, splits=2).predictions.equals(expected.predictions)


SCALED_TWICE = {
    "StandardScaler": make_pipeline(StandardScaler(), KNN),
    "RobustScaler": GridSearchCV(
        make_pipeline(RobustScaler(), KNN), {"kneighborsclassifier__p": [2]}, cv=2
    ),
    r"PCA\(whiten=True\)": make_pipeline(PCA(whiten=True), KNN),
}


@pytest.mark.parametrize("name", SCALED_TWICE)
def test_a_scaling_of_rotated_descriptors_is_noted(features, name):
    with pytest.warns(RecognitionWarning, match=f"^{name} brings all columns to one spread"):
        found = vh.evaluate(SCALED_TWICE[name], features, inputs="descriptors", splits=2)
    assert found.notes[0].startswith(name.replace("\\", ""))
    assert f"note: {found.notes[0]}" in repr(found)


@pytest.mark.parametrize(
    ("estimator", "inputs"),
    [
        (KNN, "descriptors"),
        (make_pipeline(StandardScaler(with_std=False), KNN), "descriptors"),
        (make_pipeline(PCA(), KNN), "descriptors"),
        (make_pipeline(StandardScaler(), KNN), "features"),
    ],
)
def test_other_classifiers_and_inputs_have_no_note(features, estimator, inputs):
    with warnings.catch_warnings():
        warnings.simplefilter("error", RecognitionWarning)
        found = vh.evaluate(estimator, features, inputs=inputs, splits=2)
    assert found.notes == ()


def test_notes_of_a_classifier_are_those_of_the_evaluation(features):
    found = vh.evaluate("quadratic_discriminant", features, splits=2)
    assert found.notes
    assert all("singular covariance" in note for note in found.notes)


def test_a_number_of_splits_is_a_balanced_sample_or_the_first_folds(features):
    whole = vh.evaluate(GaussianNB(), features)
    assert whole.splits == 81
    few = vh.evaluate(GaussianNB(), features, splits=3)
    assert (few.splits, len(few.by_object)) == (3, 12)
    assert set(few.weights.values()) == {0.25}
    folds = RecognitionParameters(protocol={"protocol": "grouped_folds", "folds": 3})
    assert vh.evaluate(GaussianNB(), features, folds, splits=1).splits == 1
    assert vh.evaluate(GaussianNB(), features, folds, splits=99).splits == 3


def test_own_splits_are_objects_or_a_splitter(features):
    halves = [[f"class{kind}/object{number}" for kind in range(4)] for number in range(2)]
    found = vh.evaluate(GaussianNB(), features, splits=halves)
    assert set(found.by_object) == {name for half in halves for name in half}
    folds = vh.evaluate(GaussianNB(), features, splits=StratifiedGroupKFold(3))
    assert (folds.splits, len(folds.by_object)) == (3, 12)


@pytest.mark.parametrize(
    ("splits", "error", "sentence"),
    [
        (0, ParameterError, "splits is 0; a whole number above 0 is needed"),
        (True, ParameterError, "splits is of type bool"),
        ("class0/object0", ParameterError, "splits is of type str"),
        ([], ParameterError, "splits is empty"),
        (["class0/object0"], ParameterError, "Split 0 is 'class0/object0'; a list"),
        (
            [["class0/none"]],
            ParameterError,
            "Split 0 tests class0/none, which has no whole sequence",
        ),
        (
            [(np.arange(8), np.arange(8, 12))],
            ParameterError,
            "Split 0 has a test object of type ndarray; .* not index arrays",
        ),
        ([[["class0/object0"]]], ParameterError, "Split 0 has a test object of type list; names"),
        ([[{}]], ParameterError, "Split 0 has a test object of type dict; names"),
        ([[]], RecognitionError, "Split 0 has no test object"),
        (
            [["class0/object0", "class0/object1", "class0/object2"]],
            RecognitionError,
            "Split 0 tests class class0, which has no training object",
        ),
        (StratifiedGroupKFold(13), RecognitionError, "can't divide the objects: .*n_splits=13"),
        (
            KFold(7, shuffle=True, random_state=0),
            RecognitionError,
            "Split 0 has class",
        ),
    ],
)
def test_splits_that_are_none_or_leak_are_refused(features, splits, error, sentence):
    with pytest.raises(error, match=sentence):
        vh.evaluate(GaussianNB(), features, splits=splits)


class OneSplit:
    """Splitter of one split: training and test objects, as `chosen` computes them from the object indices."""

    def __init__(self, chosen):
        self.chosen = chosen

    def get_n_splits(self):
        return 1

    def split(self, _rows, _labels, groups):
        yield self.chosen(groups)


def halves(groups):
    return np.flatnonzero(groups % 3), np.flatnonzero(groups % 3 == 0)


@pytest.mark.parametrize(
    "chosen",
    [
        lambda groups: (groups % 3 != 0, groups % 3 == 0),
        lambda groups: [list(part[::-1]) for part in halves(groups)],
    ],
)
def test_indices_of_a_splitter_may_be_masks_or_lists_in_any_order(features, chosen):
    expected = vh.evaluate(GaussianNB(), features, splits=OneSplit(halves))
    found = vh.evaluate(GaussianNB(), features, splits=OneSplit(chosen))
    assert found.predictions == expected.predictions


@pytest.mark.parametrize(
    ("change", "found"),
    [
        (lambda train, test: (train, test + 1000), "test index 1000"),
        (lambda train, test: (train, test - 48), "test index -48"),
        (lambda train, test: (train, [*test, test[1]]), "test index 1 more than once"),
        (lambda train, test: ([*train, train[0]], test), "training index 4 more than once"),
        (lambda train, test: (train + 0.0, test), "training indices of type float64"),
        (lambda train, test: (train, test > 0), "test indices of type bool"),
        (lambda train, test: (train, test[None]), r"test indices of type int64, shape \(1, 16\)"),
    ],
)
def test_indices_of_a_splitter_that_are_no_sequences_are_refused(features, change, found):
    splitter = OneSplit(lambda groups: change(*halves(groups)))
    with pytest.raises(RecognitionError, match=f"Split 0 has {found}.*; .* 0 to 47, each once"):
        vh.evaluate(GaussianNB(), features, splits=splitter)


@pytest.mark.parametrize(
    ("chosen", "reason"),
    [
        (lambda _: "ab" + 1, "concatenate"),
        (lambda _: None, "unpack"),
        (lambda groups: (*halves(groups), 1), "unpack"),
        (lambda _: ([[0], [1, 2]], [3]), "inhomogeneous"),
    ],
)
def test_a_splitter_that_fails_is_refused_with_the_reason(features, chosen, reason):
    with pytest.raises(RecognitionError, match=f"can't divide the objects: .*{reason}"):
        vh.evaluate(GaussianNB(), features, splits=OneSplit(chosen))


def test_a_splitter_without_training_sequences_is_refused(features):
    splitter = OneSplit(lambda groups: ([], halves(groups)[1]))
    with pytest.raises(RecognitionError, match="class0, which has no training object"):
        vh.evaluate(GaussianNB(), features, splits=splitter)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"n_jobs": 0}, "n_jobs is 0; a whole number other than 0 is needed"),
        ({"n_jobs": "two"}, "n_jobs is 'two'; a whole"),
        ({"n_jobs": 1.5}, "n_jobs is 1.5; a whole"),
        ({"n_jobs": None}, "n_jobs is None; a whole"),
        ({"seed": -1}, "seed is -1; a whole number of at least 0 is needed"),
        ({"seed": "a"}, "seed is 'a'; a whole"),
        ({"seed": 1.5}, "seed is 1.5; a whole"),
        ({"seed": None}, "seed is None; a whole"),
        ({"inputs": ["touches"]}, "inputs is of type list; features, descriptors, touches"),
        ({"inputs": np.array(["touches", "x"])}, "inputs is of type ndarray; features"),
    ],
)
def test_arguments_of_another_kind_are_refused_in_a_sentence(features, arguments, sentence):
    with pytest.raises(ParameterError, match=sentence):
        vh.evaluate(GaussianNB(), features, FEW, **arguments)


def test_whole_numbers_of_numpy_are_whole_numbers(features):
    expected = vh.evaluate(GaussianNB(), features, FEW, seed=3, n_jobs=1)
    found = vh.evaluate(GaussianNB(), features, FEW, seed=np.int64(3), n_jobs=np.int64(1))
    assert found.predictions == expected.predictions


def test_an_estimator_without_a_text_is_named_by_its_type(features):
    assert vh.evaluate(Unprintable(), features, FEW).accuracy == 0.25
    with pytest.raises(RecognitionError, match=r"^An object of type Unprintable predicted"):
        vh.evaluate(Unprintable(7), features, FEW)


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.mark.parametrize(("stream", "is_shown"), [(Terminal, True), (io.StringIO, False)])
def test_a_terminal_shows_how_many_splits_are_done(features, monkeypatch, stream, is_shown):
    monkeypatch.setattr(sys, "stderr", stream())
    # By default tqdm writes at most ten times a second.
    monkeypatch.setattr("visuohaptic.evaluation.evaluating.tqdm", partial(tqdm, mininterval=0))
    vh.evaluate(GaussianNB(), features, FEW)
    written = sys.stderr.getvalue()
    assert [f"| {done}/9 [" in written for done in (0, 1, 9)] == [is_shown] * 3
    assert bool(written) == is_shown


def test_seconds_of_fitting_and_predicting_are_counted_and_said(features):
    found = vh.evaluate(GaussianNB(), features, FEW)
    for spent in (found.fit, found.predict):
        assert spent.wall > 0
        assert spent.processor > 0
    assert "s of processor" in repr(found)


def test_two_evaluations_compare_in_pairs_over_objects(features):
    first, second = (vh.evaluate(one, features, FEW) for one in (SVC(), Keeping()))
    compared = first.compare(second)
    names = list(first.by_object)
    expected = compare_paired(
        np.array([first.by_object[name] for name in names]),
        np.array([second.by_object[name] for name in names]),
        np.array([first.weights[name] for name in names]),
        FEW.intervals,
        [name.split("/")[0] for name in names],
    )
    assert compared == expected
    assert compared.difference.mean == pytest.approx(first.accuracy - second.accuracy)
    assert compared.objects == 12


@pytest.mark.parametrize(
    ("estimator", "touches_each", "sentence"),
    [
        (Changing(), 5, r"can't be copied by sklearn.base.clone: .*; its constructor"),
        (
            Sized(),
            3,
            r"can't be fitted or tested on a structured array of shape \(32, 3\) with the ",
        ),
        (Keeping(7), 5, "predicted the label 7; only labels of y, which are 0 to 3, are allowed"),
        (Keeping(0.5), 5, "predicted the label 0.5; only"),
        (Naming(), 5, "predicted the label class0; only"),
        (Ragged(), 5, r"Ragged\(\) predicted labels that can't be read: .* one label of y"),
        (Keeping(pd.NA), 5, r"Keeping\(label=<NA>\) predicted labels that can't be read: .*NA"),
        (Untagged(), 5, r"Untagged\(\) gives no scikit-learn tags: no tags; a scikit-learn"),
        (Scoring(), 5, r"predicted an array of shape \(16, 4\) for 16 sequences"),
        (LinearDiscriminantAnalysis(), 5, r"can't be fitted or tested on a structured array"),
    ],
)
@pytest.mark.parametrize("n_jobs", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_estimators_that_do_not_fit_are_refused_with_the_reason(
    touches, estimator, touches_each, sentence, n_jobs
):
    chosen = FEW.model_copy(update={"touches": touches_each})
    with pytest.raises(RecognitionError, match=sentence):
        vh.evaluate(estimator, touches, chosen, inputs="touches", n_jobs=n_jobs)


@pytest.mark.slow
def test_an_estimator_that_no_other_process_can_take_is_refused(touches):
    assert vh.evaluate(Locked(), touches, FEW, inputs="touches").splits == 9
    with pytest.raises(RecognitionError, match=r"can't be shared between processes: .*n_jobs to 1"):
        vh.evaluate(Locked(), touches, FEW, inputs="touches", n_jobs=2)


def test_tables_without_imprints_are_refused(features, touches, tmp_path):
    write_table(FEATURES, features, tmp_path / "features.parquet")
    for table in (features, tmp_path, str(tmp_path / "features.parquet")):
        with pytest.raises(
            RecognitionError,
            match=r"^This is table features; evaluate reads results/touches with inputs='touches'\.$",
        ):
            vh.evaluate(FLAT, table, FEW, inputs="touches")
    without = touches.drop_columns(["image"])
    with pytest.raises(RecognitionError, match=r"touches can't be used: .* no column image"):
        vh.evaluate(FLAT, without, FEW, inputs="touches")
    with pytest.raises(RecognitionError, match=r"no imprints .*results/touches"):
        touch_arrays(without)


def test_imprints_of_several_sizes_are_refused(touches):
    frame = touches.to_pandas()
    frame.at[0, "image"] = frame.at[0, "image"][:9]
    with pytest.raises(RecognitionError, match="images have"):
        vh.evaluate(FLAT, frame, FEW, inputs="touches")


def test_inputs_of_another_name_are_refused(features):
    with pytest.raises(ParameterError, match="inputs is 'pixels'; features, descriptors, touches"):
        vh.evaluate(SVC(), features, FEW, inputs="pixels")


def test_touches_of_a_pad_without_rows_and_columns_give_one_reading_per_taxel(touches):
    values = np.stack(touches.column("image").to_pylist()).astype(np.float32)[:, :13]
    index = touches.schema.get_field_index("image")
    lists = pa.array(values.tolist(), touches.schema.field("image").type)
    pads = touches.set_column(index, touches.schema.field("image"), lists)
    arrays, _, _ = touch_arrays(pads)
    assert arrays["imprint"].shape[2:] == (13,)
    assert flatten_touches(arrays).shape == (len(arrays), arrays.shape[1] * (13 + 7))
    assert vh.evaluate(FLAT, pads, FEW, inputs="touches").predictions.num_rows > 0
