"""`visuohaptic evaluate` names what the model has not learnt, and leaves the rows for the report."""

import json

import pytest
from cli.models import fit_on_nonsense
from evaluation.test_evaluating_inputs import touches_of
from recognition.synthetic import features_table

import visuohaptic as vh
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.tables.phases import FEATURES, TOUCHES
from visuohaptic.tables.schema import read_table, write_table
from visuohaptic.tables.studies import EVALUATION


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    """A model of two objects of two classes each."""
    return fit_on_nonsense(tmp_path_factory.mktemp("model"))


def write_features(run, objects):
    table = features_table(objects=objects, viewpoints=2)
    write_table(FEATURES, table, run / "results/features/all.parquet")


def test_the_shares_are_printed_and_the_rows_are_left_in_the_run(visuohaptic, model, tmp_path):
    write_features(tmp_path / "run", (4, 4))
    ended = visuohaptic("evaluate", model, "--run", "run")
    assert (ended.code, ended.err) == (0, "")
    head, one, two, file = ended.out.splitlines()
    assert head == "Touches by fixation, a model trained on 4 objects:"
    assert one.startswith("   1 view: ")
    assert two.startswith("   2 views: ")
    assert "of the sets, stated 90 %, with" in two
    assert read_table(EVALUATION, tmp_path / file).num_rows == 4 * (2 + 1)


def test_as_json_the_shares_have_their_intervals_and_a_single_object_none(
    visuohaptic, model, tmp_path
):
    write_features(tmp_path, (3, 3))
    rows = json.loads(visuohaptic("evaluate", model, "--json").out)
    assert [row["views"] for row in rows] == [1, 2]
    assert all(len(row["coverage"]) == 3 for row in rows)
    write_features(tmp_path, (3, 2))
    assert "nan" not in visuohaptic("evaluate", model).out


def test_objects_that_the_model_learnt_are_no_test(visuohaptic, model, tmp_path):
    write_features(tmp_path, (2, 2))
    ended = visuohaptic("evaluate", model)
    assert ended.code == 1
    assert "None of 4 objects touched by fixation is new to the model" in ended.err


@pytest.mark.parametrize("inputs", ["features", "descriptors"])
def test_a_classifier_is_trained_and_tested_on_the_splits_of_the_run(visuohaptic, tmp_path, inputs):
    write_features(tmp_path, (3, 3))
    chosen = ("--classifier", "support_vector_machine", "--inputs", inputs, "--splits", 3)
    row = json.loads(visuohaptic("evaluate", *chosen, "--json").out)
    table = read_table(FEATURES, tmp_path / "results/features")
    found = vh.evaluate("support_vector_machine", table, inputs=inputs, splits=3)
    assert row["accuracy"] == [found.accuracy, found.low, found.high]
    assert (row["objects"], row["splits"], row["inputs"]) == (6, 3, inputs)
    assert set(row["fit"]) == {"processor", "wall"}
    printed = visuohaptic("evaluate", *chosen)
    assert (printed.code, printed.err) == (0, "")
    assert f"on {inputs} of touches by fixation: {100 * found.accuracy:.1f} % (" in printed.out
    assert "s of processor" in printed.out


def test_the_parameters_of_the_run_hold(visuohaptic, tmp_path):
    write_features(tmp_path, (3, 3))
    (tmp_path / "params.yaml").write_text(
        "seed: 7\nrecognition: {touches: 2, protocol: {protocol: grouped_folds, folds: 3}}\n"
    )
    row = json.loads(visuohaptic("evaluate", "--classifier", "naive_bayes", "--json").out)
    chosen = RecognitionParameters(touches=2, protocol={"protocol": "grouped_folds", "folds": 3})
    table = read_table(FEATURES, tmp_path / "results/features")
    assert row["accuracy"][0] == vh.evaluate("naive_bayes", table, chosen, seed=7).accuracy
    assert row["splits"] == 3


def test_a_setting_counts_more_than_the_parameters_of_the_run(visuohaptic, tmp_path):
    write_features(tmp_path, (3, 3))
    (tmp_path / "params.yaml").write_text("recognition: {touches: 2}\n")
    chosen = ("evaluate", "--classifier", "naive_bayes", "--json")
    protocol = "recognition.protocol={protocol: grouped_folds, folds: 3}"
    row = json.loads(visuohaptic(*chosen, "--set", protocol, "--set", "seed=7").out)
    assert row["splits"] == 3
    (tmp_path / "params.yaml").write_text(
        "seed: 7\nrecognition: {touches: 2, protocol: {protocol: grouped_folds, folds: 3}}\n"
    )
    assert row["accuracy"] == json.loads(visuohaptic(*chosen).out)["accuracy"]


def test_imprints_need_the_touches_of_the_run(visuohaptic, tmp_path):
    write_features(tmp_path, (3, 3))
    chosen = ("evaluate", "--classifier", "naive_bayes", "--inputs", "touches")
    missing = visuohaptic(*chosen)
    assert missing.code == 1
    assert "The touches can't be used: there is no file results/touches" in missing.err
    touches = touches_of(read_table(FEATURES, tmp_path / "results/features"))
    write_table(TOUCHES, touches, tmp_path / "results/touches/all.parquet")
    ended = visuohaptic(*chosen)
    assert ended.code == 1
    assert "'naive_bayes' can't be fitted or tested on a structured array of shape" in ended.err


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (("--inputs", "touches"), "--inputs needs --classifier"),
        (("--splits", "3"), "--splits needs --classifier"),
        (("--set", "seed=1"), "--set needs --classifier"),
        (("--classifier", "none"), "'none' is no classifier"),
        (("--classifier", "naive_bayes", "--inputs", "pixels"), "'pixels' is not one of"),
        (("--classifier", "naive_bayes", "--splits", "0"), "greater than or equal to 1"),
        (("model.skops", "--classifier", "naive_bayes"), "exclude each other"),
    ],
)
def test_options_that_do_not_fit_are_refused(visuohaptic, tmp_path, options, sentence):
    write_features(tmp_path, (3, 3))
    (tmp_path / "model.skops").touch()
    ended = visuohaptic("evaluate", *options)
    assert ended.code != 0
    assert sentence in ended.err
