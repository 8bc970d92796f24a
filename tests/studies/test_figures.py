"""Every condition has its interval, and its difference in pairs over the same objects."""

import json

import numpy as np
import pytest

from visuohaptic.evaluation.intervals import compare_paired, holm
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.studies.figures import Cell, CellKey, cells_of, make_study_figures, study_figures
from visuohaptic.tables.schema import build_table, read_table, write_table
from visuohaptic.tables.studies import STUDY, STUDY_FIGURES

INTERVALS = IntervalParameters()
NAMES = ("whole", "better", "worse", "broken")
STUDY_OF = {
    "name": "mine",
    "title": "Mine",
    "conditions": [
        {"name": name, "compared_with": None, "recomputed": "recognition"} for name in NAMES
    ],
}
WHOLE = np.array([0.5, 0.6, 0.7, 0.8, 0.9, 0.3])


def cell(accuracy):
    objects = tuple((f"class{place % 2}", f"object{place}") for place in range(len(accuracy)))
    return Cell(objects, np.array(accuracy), np.ones(len(accuracy)), 1.5)


def key(name, strategy="fixation"):
    return CellKey(name, "paper", strategy, "naive_bayes")


CELLS = {
    key("worse"): cell(WHOLE - 0.2),
    key("whole"): cell(WHOLE),
    key("better"): cell(WHOLE + np.array([0.1, 0.0, 0.1, 0.0, 0.1, 0.0])),
    key("broken"): Cell((), np.empty(0), np.empty(0), error="too small."),
}


def rows_of(cells, strategy="fixation"):
    rows = study_figures(STUDY_OF, CELLS | cells, INTERVALS).to_pylist()
    return {row["condition"]: row for row in rows if row["strategy"] == strategy}


def test_a_strategy_is_compared_with_fixation_in_the_same_condition():
    random = {key(name, "random"): cell(WHOLE - 0.1) for name in ("whole", "worse")}
    assert rows_of(random)["whole"]["lead"] is None
    found = rows_of(random, "random")
    whole, worse = found["whole"], found["worse"]
    assert (whole["lead"], worse["lead"]) == (pytest.approx(0.1), pytest.approx(-0.1))
    assert whole["lead_low"] <= whole["lead"] <= whole["lead_high"]
    assert 0 < whole["lead_p"] <= 1


def test_conditions_come_in_their_order_with_a_difference_to_the_first():
    found = rows_of({})
    assert tuple(found) == NAMES
    differences = [row["difference"] for row in found.values()]
    assert differences == [None, pytest.approx(0.05), pytest.approx(-0.2), None]
    assert [row["compared_with"] for row in found.values()] == [None, *["whole"] * 3]
    assert found["better"]["low"] < found["better"]["accuracy"] < found["better"]["high"]
    assert (found["broken"]["accuracy"], found["broken"]["error"]) == (None, "too small.")


def test_differences_are_paired_and_adjusted_over_the_conditions():
    better, worse = (rows_of({})[name] for name in ("better", "worse"))
    paired = compare_paired(CELLS[key("better")].accuracy, WHOLE, np.ones(6), INTERVALS)
    assert (better["p_value"], better["difference_low"]) == (paired.p_value, paired.difference.low)
    adjusted = holm([better["p_value"], worse["p_value"]])
    assert [better["adjusted_p"], worse["adjusted_p"]] == adjusted


def test_differences_and_leads_have_intervals_of_new_classes():
    # Objects alternate between two classes.
    row = rows_of({})["better"]
    gain = np.array([0.1, 0.0, 0.1, 0.0, 0.1, 0.0])
    wide = compare_paired(gain, 0 * gain, np.ones(6), INTERVALS, [0, 1, 0, 1, 0, 1])
    found = [row[f"difference_new_classes_{end}"] for end in ("low", "high")]
    expected = wide.difference_new_classes
    assert found == pytest.approx([expected.low, expected.high])
    assert row["p_value_new_classes"] == pytest.approx(wide.p_value_new_classes)
    lead = rows_of({key("whole", "random"): cell(WHOLE - 0.1)}, "random")["whole"]
    assert lead["lead_new_classes_low"] <= lead["lead_low"]
    assert lead["lead_new_classes_high"] >= lead["lead_high"]
    assert lead["lead_p_new_classes"] >= lead["lead_p"]
    first = rows_of({})["whole"]
    assert first["difference_new_classes_low"] is first["p_value_new_classes"] is None


def test_equal_conditions_have_no_difference_and_those_of_other_objects_are_not_compared():
    found = rows_of({key("better"): cell(WHOLE), key("worse"): cell(WHOLE[:4])})
    assert found["better"]["low"] == found["whole"]["low"]
    assert (found["better"]["difference"], found["better"]["p_value"]) == (0, 1)
    assert found["worse"]["difference"] is None
    assert found["worse"]["accuracy"] == pytest.approx(0.65)


def study_rows():
    # Object a is tested in two splits: 2 of 4 sequences, then 3 of 3; b shares the first split.
    return build_table(
        STUDY,
        {
            "study": "mine", "condition": "whole", "pipeline": "paper", "strategy": "fixation",
            "classifier": "naive_bayes", "class": ["a", "b", "a"], "object": ["x", "y", "x"],
            "split": [0, 0, 1], "repeat": 0, "sequences": [4, 1, 3], "accuracy": [0.5, 1.0, 1.0],
            "seconds": 2.0, "error": [None] * 3,
        },
    )  # fmt: skip


def test_the_weighted_mean_over_objects_is_the_mean_over_splits():
    (found,) = cells_of(study_rows()).values()
    assert found.objects == (("a", "x"), ("b", "y"))
    mean = np.average(found.accuracy, weights=found.weights)
    assert mean == pytest.approx(((2 + 1) / 5 + 1) / 2)


def test_the_json_holds_the_same_numbers_and_no_seconds(tmp_path):
    write_table(STUDY, study_rows(), tmp_path / "block")
    files = [tmp_path / name for name in ("figures", "figures.json")]
    make_study_figures(STUDY_OF, [tmp_path / "block"], *files, INTERVALS)
    (row,) = read_table(STUDY_FIGURES, files[0]).to_pylist()
    figures = json.loads(files[1].read_text())["paper"]["fixation"]["naive_bayes"]["whole"]
    assert figures["accuracy"] == pytest.approx(row["accuracy"])
    assert row["seconds"] == 2.0
    assert "seconds" not in figures
