"""`visuohaptic evaluate` names what the model has not learnt, and leaves the rows for the report."""

import json

import pytest
from cli.models import fit_on_nonsense
from recognition.synthetic import features_table

from visuohaptic.tables.phases import FEATURES
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
    assert head == "Touches by fixation, a model that learnt 4 objects:"
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
    assert "Of 4 objects touched by fixation none is of a class that the model knows" in ended.err
