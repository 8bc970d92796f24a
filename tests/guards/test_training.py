"""The guards of training and of random places become rows of a table."""

import pytest
from recognition.synthetic import features_table
from report.synthetic import write_run

from visuohaptic.guards.training import make_training_guards
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.tables.guards import GUARDS
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table, write_table


def guarded(folder, features):
    files = write_run(folder)
    write_table(FEATURES, features, folder / "guarded.parquet")
    make_training_guards(
        features=[folder / "guarded.parquet"],
        fixations=files.fixations,
        meshes={},
        output=folder / "guards_of_training.parquet",
        pipelines=["paper"],
        recognition=RecognitionParameters(),
        seed=1,
    )
    rows = read_table(GUARDS, folder / "guards_of_training.parquet").to_pylist()
    return {row["guard"]: row for row in rows}


@pytest.mark.slow
def test_every_guard_has_a_row(tmp_path):
    found = guarded(tmp_path, features_table(separation=2.0))
    outcomes = [row["outcome"] for row in found.values()]
    assert sorted(outcomes) == ["held"] * 2 + ["not tested"]
    assert "are needed" in found["random places are uniform by area"]["found"]


def test_a_run_with_too_few_objects_says_so(tmp_path):
    row = guarded(tmp_path, features_table(objects=(2, 1)))["test objects and training"]
    assert row["outcome"] == "not tested"
    assert "one class" in row["found"]
