"""What accuracy costs: the steps and the sentences follow from the rows."""

import pytest
from report.pages import plain
from report.synthetic import PARAMETERS
from studies.cost.test_front import RENDER, cost_rows

from visuohaptic.parameters import CostParameters
from visuohaptic.report.cost import (
    compared_sentence,
    cost_answer,
    cost_figures,
    read_cost,
    time_parts,
)
from visuohaptic.report.estimates import Estimate
from visuohaptic.tables.schema import write_table
from visuohaptic.tables.studies import COST


def test_what_was_not_measured_has_no_figures(tmp_path):
    assert read_cost(None, PARAMETERS) is None
    write_table(COST, COST.arrow.empty_table(), tmp_path / "empty.parquet")
    assert read_cost(tmp_path / "empty.parquet", PARAMETERS) is None


def test_the_parts_of_a_recognition_are_those_of_its_row():
    (row,) = cost_rows([("5", 0.1, 0.1, {"looks": 2, "touches": 5, "viewpoints": 2})])
    row |= {"seconds_look": 0.06, "seconds_render": 0.02, "seconds_attend": 0.03}
    row |= {"seconds_touch": 0.02, "seconds_cast": 0.005}
    parts = {part["name"]: part for part in time_parts(row)}
    assert parts["rendering"]["each"] == "10 ms per view"
    assert parts["attention: saliency and fixations"]["each"] == "15 ms per view"
    assert parts["casting rays"]["each"] == "0.5 ms per touch"
    assert parts["rest of touching"]["seconds"] == pytest.approx(0.015)
    assert parts["preparing the surface"]["seconds"] == pytest.approx(0.01)
    assert time_parts({**row, "seconds": None}) == time_parts(None) == []


def test_the_steps_are_rows_the_quickest_first():
    rows = cost_rows([("5 touches", 0.1, 0.08), ("1 touch", 0.01, 0.4), ("2 touches", 0.02, 0.1)])
    for row in rows:
        row |= {"step": row["setting"] != "5 touches", "as_quick": row["setting"] == "1 touch"}
    steps = cost_figures(rows, PARAMETERS)["steps"]
    assert [row["setting"] for row in steps] == ["1 touch", "2 touches"]
    assert cost_figures([], PARAMETERS)["steps"] == []


def test_what_positions_imprints_and_the_map_give_is_stated_where_it_was_measured():
    errors = {"pose alone": 0.01, "skin alone": 0.25, "with its map": 0.2, "without the map": 0.1}
    rows = cost_rows([(name, 0.1, error) for name, error in errors.items()])
    for row in rows:
        row["family"] = "cues" if "alone" in row["setting"] else "paper"
    pose, mapped = (plain(compared_sentence(rows, family)) for family in ("cues", "paper"))
    assert "normals without imprints reach 99.0 %" in pose
    assert "imprints without positions and normals 75.0 % (40.0 % to 87.5 %)" in pose
    assert "Without the map, the paper's pipeline reaches 90.0 %" in mapped
    assert compared_sentence(rows[:1], "cues") == ""


def test_the_answer_goes_by_the_clock_of_a_robot():
    own = {"family": "fixation"}
    points = [("1 touch", 0.073, 0.4, {"touches": 1, **own}), ("5 touches", 0.15, 0.01, own)]
    rows = cost_rows([*points, ("another sensor", 0.01, 0.0, {"touches": 1})])
    answer = cost_answer(rows, CostParameters(touch_seconds=4, look_seconds=0.5))
    assert answer.number == "4.6 s"
    said = plain(answer.sentence)
    assert said.startswith(
        "is the quickest recognition, with an error rate of 40.0 % (20.0 % to 90.0 %) (eye fixations, 1"
    )
    assert "takes 21 s (eye fixations, 5 touches, pipeline order_free)" in said
    assert said.endswith(
        "4 s per touch and 0.5 s per look, both assumed, and 10 ms to 150 ms of computing."
    )
    rows[0]["error"] = 0.0
    answer = cost_answer(rows, CostParameters())
    assert "; no slower setting has a lower error rate." in plain(answer.sentence)
    assert cost_answer([], CostParameters()) is None


@pytest.mark.parametrize(
    ("lost", "verdict"),
    [
        ((0.001, -0.002, 0.009), "costs less than 1 point"),
        ((0.001, -0.002, 0.02), "no clear difference"),
        ((0.03, 0.005, 0.06), "costs accuracy"),
    ],
)
def test_a_saving_is_a_row_with_how_sure_its_price_is(lost, verdict):
    own = ("own", 0.1, 0.01, {"lost": 0.0, "lost_low": 0.0, "lost_high": 0.0})
    figures = dict(zip(("lost", "lost_low", "lost_high"), lost, strict=True))
    rows = cost_rows([own, ("lean", 0.06, 0.02, {**figures, "changes": RENDER})])
    (row,) = cost_figures(rows, PARAMETERS)["savings"]
    assert (row["setting"], row["changes"]) == ("Touches, lean", "rendering.resolution 64")
    assert row["saved"] == pytest.approx(0.4)
    assert (row["lost"], row["verdict"]) == (Estimate(*lost), verdict)
