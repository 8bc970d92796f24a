"""Ablations are compared with the whole method, object by object."""

import json

import numpy as np
import pyarrow as pa
import pytest

from visuohaptic.errors import RecognitionError
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.studies.ablations.comparing import compare_ablations, make_ablations
from visuohaptic.tables.schema import build_table, read_table, write_table
from visuohaptic.tables.studies import ABLATION, ABLATIONS

INTERVALS = IntervalParameters(bootstrap_samples=200)


def part(name, accuracy, pipeline="best", weights=None):
    count = len(accuracy)
    return build_table(
        ABLATION,
        {
            "ablation": name,
            "pipeline": pipeline,
            "classifier": "support_vector_machine",
            "class": [f"class{number % 2}" for number in range(count)],
            "object": [f"object{number}" for number in range(count)],
            "accuracy": accuracy,
            "weight": np.ones(count) if weights is None else weights,
            "making_seconds": 2.0,
            "naming_seconds": 3.0,
        },
    )


WHOLE = part("whole_method", [0.9, 0.8, 1.0, 0.7])


def rows_of(*parts):
    table = compare_ablations(pa.concat_tables(parts), INTERVALS, 1)
    return {(row["ablation"], row["pipeline"]): row for row in table.to_pylist()}


def test_the_loss_is_paired_over_objects():
    row = rows_of(WHOLE, part("wavelet", [0.7, 0.6, 0.8, 0.5]))["wavelet", "best"]
    assert row["accuracy"] == pytest.approx(0.65)
    assert row["loss"] == pytest.approx(0.2)
    assert row["loss_high"] - row["loss_low"] < 1e-9
    assert row["high"] - row["low"] > 0.1
    assert row["p_value"] == pytest.approx(2 / 2**4)
    assert (row["making_seconds"], row["naming_seconds"], row["objects"]) == (2.0, 3.0, 4)


def test_the_whole_method_loses_nothing_against_itself():
    row = rows_of(WHOLE)["whole_method", "best"]
    assert (row["loss"], row["loss_low"], row["loss_high"], row["p_value"]) == (0, 0, 0, 1)


def test_equal_rows_have_equal_intervals():
    found = rows_of(WHOLE, part("ideal", [0.9, 0.8, 1.0, 0.7]))
    whole, same = (found[name, "best"] for name in ("whole_method", "ideal"))
    assert (whole["low"], whole["high"]) == (same["low"], same["high"])


def test_each_pipeline_is_compared_with_its_own_whole():
    paper = part("whole_method", [0.5, 0.5, 0.5, 0.5], "paper")
    found = rows_of(WHOLE, paper, part("wavelet", [0.4, 0.4, 0.4, 0.4], "paper"))
    assert found["wavelet", "paper"]["loss"] == pytest.approx(0.1)


def test_objects_are_matched_by_name_and_weigh_alike():
    shuffled = part("wavelet", [0.9, 0.8, 1.0, 0.7]).take([3, 1, 0, 2])
    assert rows_of(WHOLE, shuffled)["wavelet", "best"]["loss_high"] == 0
    weights = [3.0, 1.0, 1.0, 1.0]
    heavy = part("whole_method", [1.0, 0, 0, 0], weights=weights)
    assert rows_of(heavy)["whole_method", "best"]["accuracy"] == pytest.approx(0.5)


def test_other_objects_and_a_missing_whole_are_refused():
    with pytest.raises(RecognitionError, match="whole_method"):
        rows_of(part("wavelet", [0.5, 0.5]))
    with pytest.raises(RecognitionError, match="same 3 objects"):
        rows_of(WHOLE, part("wavelet", [0.5, 0.5, 0.5]))


def test_the_table_comes_whole_method_first(tmp_path):
    files = []
    for name in ("without_map", "wavelet", "whole_method"):
        files.append(tmp_path / f"{name}.parquet")
        write_table(ABLATION, part(name, [0.5, 0.6]), files[-1])
    figures = tmp_path / "reports" / "ablations.json"
    make_ablations(files, tmp_path / "ablations.parquet", figures, INTERVALS, 1)
    table = read_table(ABLATIONS, tmp_path / "ablations.parquet")
    assert set(table.column("ablation").to_pylist()) == {"without_map", "wavelet", "whole_method"}
    ordered = compare_ablations(read_table(ABLATION, files), INTERVALS, 1)
    assert ordered.column("ablation").to_pylist() == ["whole_method", "wavelet", "without_map"]
    (of_classifier,) = json.loads(figures.read_text())["best"].values()
    assert list(of_classifier) == ["whole_method", "wavelet", "without_map"]
    for row in ordered.to_pylist():
        told = of_classifier[row["ablation"]]
        assert told["accuracy"] == pytest.approx(row["accuracy"])
        assert not any("seconds" in name for name in told)
