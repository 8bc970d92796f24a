"""`visuohaptic gaze` says how well attention predicts recorded gaze, or why it can't."""

import json

import pytest
from gaze.made_up import write_object


def test_a_folder_without_recordings_is_refused_in_a_sentence(visuohaptic, tmp_path):
    ended = visuohaptic("gaze", tmp_path)
    assert (ended.code, ended.out) == (1, "")
    assert "has no recording of gaze" in ended.err
    write_object(tmp_path, "pole", "test", (0.5, 1, 0.5), mesh=False)
    assert "recordings for tests alone" in visuohaptic("gaze", tmp_path).err


@pytest.mark.slow
def test_predictors_and_weights_are_printed_and_written(visuohaptic, tmp_path):
    for place, letter in enumerate("abcdef"):
        write_object(tmp_path, f"egg{letter}", "training", (0.8, 1, 0.5 + 0.05 * place))
    ended = visuohaptic("gaze", tmp_path, "--json", "--weights", tmp_path / "weights.json")
    assert (ended.code, ended.err) == (0, "")
    rows = {row["predictor"]: row for row in json.loads(ended.out)["training"]}
    assert rows["place"]["correlation"]["mean"] > 0.8
    assert rows["human"]["objects"] == 6
    assert set(json.loads((tmp_path / "weights.json").read_text())["terms"]) >= {"height"}
