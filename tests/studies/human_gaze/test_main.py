"""`python -m human_gaze` says how well attention predicts recorded gaze, or why it can't."""

import json

import pyarrow.compute as pc
import pytest
from studies.human_gaze.made_up import write_object

from human_gaze.__main__ import main
from human_gaze.predicting import PREDICTORS
from human_gaze.tables import AGREEMENT
from visuohaptic.attention import CHANNELS, TERMS
from visuohaptic.tables.schema import read_table

PARAMETERS = "viewpoints: {count: 3}\nrendering: {resolution: 48}\n"


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    """Run the command in a folder with parameters, and return its status, standard output and standard error."""
    (tmp_path / "params.yaml").write_text(PARAMETERS)
    monkeypatch.chdir(tmp_path)

    def ended(*arguments):
        with pytest.raises(SystemExit) as end:
            main([*arguments, "--jobs", "1"])
        printed = capsys.readouterr()
        return end.value.code or 0, printed.out, printed.err

    return ended


def test_a_folder_without_recordings_is_refused_in_a_sentence(run, tmp_path):
    (tmp_path / "gaze").mkdir()
    status, out, err = run("gaze")
    assert (status, out) == (1, "")
    assert err == "error: gaze has no recording of gaze; files ending in .txt or .npz are needed.\n"
    write_object(tmp_path / "gaze", "pole", "test", (0.5, 1, 0.5), mesh=False)
    assert "has only recordings for tests" in run("gaze")[2]


def test_no_name_of_a_folder_and_a_setting_out_of_range_are_refused(run):
    assert run("")[0] == run("gaze", "--folds", "1")[0] == 2


@pytest.mark.slow
def test_a_folder_becomes_a_table_weights_and_pictures(run, tmp_path):
    for name, part, stretch in (
        ("egg", "training", (0.8, 1, 0.7)),
        ("disk", "training", (1, 0.6, 1)),
        ("pole", "test", (0.5, 1, 0.5)),
    ):
        write_object(tmp_path / "gaze", name, part, stretch)
    write_object(tmp_path / "gaze", "cloud", "training", (0.9, 1, 0.9), mesh=False)
    status, out, err = run("gaze", "--tests", "--folds", "2", "--spread", "0.1", "--out", "made")
    assert (status, err) == (0, "")
    assert "3 objects held out in turn" in out
    assert "1 objects for tests" in out
    table = read_table(AGREEMENT, tmp_path / "made/agreement.parquet")
    rows = table.to_pylist()
    assert {row["object"] for row in rows} == {"egg", "disk", "pole", "cloud"}
    ours = {one.name for one in PREDICTORS if one.kind != "peer"}
    assert {row["predictor"] for row in rows} == ours
    assert {row["object"] for row in rows if row["part"] == "test"} == {"pole"}
    assert {row["object"] for row in rows if row["reconstructed"]} == {"cloud"}
    assert max(row["alignment_error"] for row in rows) < 0.02
    human = table.filter(pc.field("predictor") == "human").column("correlation")
    assert pc.min(human).as_py() > 0.5
    weights = json.loads((tmp_path / "made/weights.json").read_text())
    assert (list(weights["channels"]), list(weights["terms"])) == (list(CHANNELS), list(TERMS))
    assert weights["objects"] == ["cloud", "disk", "egg"]
    pictures = sorted((tmp_path / "made/pictures").iterdir())
    assert [one.name[:4] for one in pictures] == ["000_", "001_", "002_", "003_"]
    assert all(one.read_bytes().startswith(b"\x89PNG") for one in pictures)
