"""What a run's guards found becomes a table; a guard that failed becomes an error in one sentence."""

import pytest
from recognition.synthetic import features_table
from report.synthetic import write_run

from visuohaptic.errors import GuardError
from visuohaptic.geometry.surface import meshes_in
from visuohaptic.guards.files import make_guards, make_training_guards
from visuohaptic.guards.table import failed_guards, require_guards
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.tables.guards import GUARDS
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import build_table, read_table, write_table


def guarded(folder, **rows):
    columns = {"guard": list(rows), "outcome": list(rows.values()), "found": ["So."] * len(rows)}
    write_table(GUARDS, build_table(GUARDS, columns), folder / "guards.parquet")
    return folder / "guards.parquet"


def test_guards_that_held_or_were_not_tested_raise_nothing(tmp_path):
    path = guarded(tmp_path, one="held", other="not tested")
    assert failed_guards(path) == []
    require_guards(path, "report.html")


def test_a_guard_that_failed_ends_in_one_sentence_that_names_it(tmp_path):
    path = guarded(tmp_path, one="held", other="failed")
    assert failed_guards(path) == ["other: failed. So."]
    with pytest.raises(GuardError, match=r"as report.html says, too: other: failed\. So\."):
        require_guards(path, "report.html")


def made(folder, features):
    files = write_run(folder)
    write_table(FEATURES, features, folder / "guarded.parquet")
    training = folder / "guards_of_training.parquet"
    make_training_guards(
        features=[folder / "guarded.parquet"],
        fixations=files.fixations,
        meshes=meshes_in(files.meshes),
        output=training,
        pipelines=["paper"],
        recognition=RecognitionParameters(),
        seed=1,
    )
    make_guards(training, files.predictions, files.metrics, folder / "guards.parquet", seed=1)
    rows = read_table(GUARDS, [folder / "guards.parquet"]).to_pylist()
    return {row["guard"]: row for row in rows}


@pytest.mark.slow
def test_every_guard_of_a_run_has_a_row(tmp_path):
    found = made(tmp_path, features_table(separation=2.0))
    outcomes = [row["outcome"] for row in found.values()]
    assert sorted(outcomes) == ["held"] * 3 + ["not tested"] * 2
    assert "are needed" in found["random places are uniform by area"]["found"]


def test_a_run_with_too_few_objects_says_so(tmp_path):
    found = made(tmp_path, features_table(objects=(2, 1)))
    row = found["test objects and training"]
    assert row["outcome"] == "not tested"
    assert "one class" in row["found"]
