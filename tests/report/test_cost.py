"""What accuracy costs: the steps and the sentences follow from the rows."""

import pytest
from report.pages import plain
from report.synthetic import PARAMETERS
from studies.cost.test_front import RENDER, cost_rows

from visuohaptic.report.cost import cost_figures, cost_verdict, cue_sentences, read_cost, time_parts
from visuohaptic.report.estimates import Figure
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
    assert parts["rendering"]["each"] == "10 ms a view"
    assert parts["attention: saliency and fixations"]["each"] == "15 ms a view"
    assert parts["casting rays"]["each"] == "0.5 ms a touch"
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
    pose, mapped = map(plain, cue_sentences(rows))
    assert "alone reach 99.0 %" in pose
    assert "imprints alone 75.0 % (40.0 % to 87.5 %)" in pose
    assert "With it its pipeline has 80.0 %" in mapped
    assert "without it 90.0 %" in mapped
    assert cue_sentences(rows[:1]) == []


TIME = "73 ms (half of the objects lie between 64 ms and 84 ms)"


def test_where_the_quickest_setting_is_the_most_accurate_the_answer_names_it_once():
    rows = cost_rows([("1 touch", 0.073, 0.0), ("5 touches", 0.15, 0.01)])
    for place, row in enumerate(rows):
        row |= {"as_quick": place == 0, "step": place == 0}
    answer = cost_verdict(rows)
    assert (answer.verdict, answer.number) == ("no", TIME)
    assert "lowest error rate, too" in answer.sentence
    rows[0]["error"], rows[1]["error"], rows[1]["on_front"] = 0.02, 0.0, True
    answer = cost_verdict(rows)
    assert (answer.verdict, answer.number) == ("depends", TIME)
    sentence = plain(answer.sentence)
    assert "an error rate of 2.0 % (touches, 1 touch, pipeline order_free)" in sentence
    assert "the lowest, 0.0 %, takes 150 ms" in sentence


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
    assert (row["lost"], row["verdict"]) == (Figure(*lost), verdict)
