"""The chart of seconds against error rate puts every setting where its figures say, errors of 0 apart."""

import json

import numpy as np
import pytest
from report.pages import read_page
from report.synthetic import OBJECTS, PARAMETERS, write_run
from studies.cost.test_front import BLIND, RENDER, cost_rows, cost_table

from visuohaptic.report import sections
from visuohaptic.report.cost import (
    HEIGHT,
    advise,
    advise_robot,
    cost_chart,
    cost_figures,
    cost_verdict,
    read_cost,
    time_parts,
)
from visuohaptic.report.page import render_page
from visuohaptic.report.run import RunFiles, read_run
from visuohaptic.studies.cost.front import on_robot
from visuohaptic.studies.cost.stored import StoredFrontier, store_frontier
from visuohaptic.tables.schema import write_table
from visuohaptic.tables.studies import COST

POINTS = [("1 touch", 0.01, 0.4), ("2 touches", 0.02, 0.5), ("5 touches", 0.1, 0.02)]


def chart_of(points, failed=()):
    rows = cost_table(points, failed).to_pylist()
    return cost_chart(rows, ("touches", "imprint"))


def test_axes_are_logarithmic_and_end_on_ticks():
    chart = chart_of([("a", 0.01, 0.4), ("b", 0.1, 0.04), ("c", 1.0, 0.004)])
    places = {mark.label.split(":")[0][-1]: mark for mark in chart.marks}
    assert places["b"].x - places["a"].x == pytest.approx(places["c"].x - places["b"].x, abs=0.02)
    assert places["b"].y - places["a"].y == pytest.approx(places["c"].y - places["b"].y, abs=0.2)
    assert chart.y_ticks[0][1] == "0.2 %"
    assert chart.y_ticks[0][0] == HEIGHT
    assert chart.x_ticks[0][0] == 0
    assert chart.x_ticks[-1][0] == 100
    assert all(0 <= mark.y <= HEIGHT for mark in chart.marks)
    assert chart.none_lane is None


def test_the_front_is_told_by_shape_and_stands_on_top():
    chart = chart_of(POINTS)
    assert [mark.kind for mark in chart.marks] == ["dominated", "front", "front"]
    first = next(mark for mark in chart.marks if "1 touch:" in mark.label)
    assert first.high < first.y < first.low
    assert first.left < first.x < first.right


def test_no_error_stands_in_a_strip_of_its_own_with_its_limit_on_the_axis():
    chart = chart_of([*POINTS, ("16 touches", 0.5, 0.0)])
    (flawless,) = [mark for mark in chart.marks if "16 touches" in mark.label]
    assert flawless.y == chart.none_lane > HEIGHT
    assert flawless.low == chart.none_lane
    assert 0 < flawless.high < HEIGHT
    assert all(mark.low <= HEIGHT for mark in chart.marks if mark is not flawless)


def test_a_failed_setting_has_a_mark_with_its_reason():
    chart = chart_of(POINTS, failed=["8 × 8"])
    (failed,) = [mark for mark in chart.marks if mark.kind == "failed"]
    assert failed.y == chart.failed_lane > HEIGHT
    assert failed.label == "imprint, 8 × 8: failed. images are too small."


def test_a_line_follows_its_family_not_the_seconds():
    chart = chart_of([("1 touch", 0.02, 0.4), ("2 touches", 0.01, 0.2), ("3 touches", 0.1, 0.1)])
    assert len(chart.lines) == 2
    first, second = chart.lines
    assert first[3:] == second[1:3]


def test_figures_that_are_all_alike_still_have_an_axis():
    chart = chart_of([("a", 0.1, 0.1), ("b", 0.1, 0.1)])
    assert {mark.kind for mark in chart.marks} == {"front"}
    assert len(chart.x_ticks) > 1


def test_what_was_not_measured_has_no_figures(tmp_path):
    assert read_cost(None, PARAMETERS) is None
    assert read_cost(tmp_path / "none.parquet", PARAMETERS) is None
    assert cost_chart(cost_table(POINTS, ["8 × 8"]).to_pylist()[3:], ("imprint",)) is None


def test_the_parts_of_a_recognition_are_those_of_its_row():
    (row,) = cost_rows([("5", 0.1, 0.1, {"looks": 2, "touches": 5, "viewpoints": 2})])
    row |= {"seconds_look": 0.06, "seconds_render": 0.02, "seconds_attend": 0.03}
    row |= {"seconds_touch": 0.02, "seconds_cast": 0.005}
    parts = {part.name: part for part in time_parts(row)}
    assert parts["rendering"].each == "10 ms a view"
    assert parts["attention: saliency and fixations"].each == "15 ms a view"
    assert parts["casting rays"].each == "0.5 ms a touch"
    assert parts["rest of touching"].seconds == pytest.approx(0.015)
    assert parts["preparing the surface"].seconds == pytest.approx(0.01)
    assert time_parts({**row, "seconds": None}) == time_parts(None) == []


def said(rows):
    return [sentence.replace("\N{NO-BREAK SPACE}", " ") for sentence in advise(rows, PARAMETERS)]


def test_the_advice_names_steps_with_their_price_and_what_can_not_be_told_apart():
    rows = cost_rows([("1 touch", 0.01, 0.4), ("2 touches", 0.02, 0.1), ("5 touches", 0.1, 0.08)])
    rows[1]["step"] = True
    first, time, second, rest = said(rows)
    assert first == (
        "Of the settings that are not significantly slower than the quickest, the most accurate is touches, 1 touch: 40.0 % wrong "
        "(20.0 % to 90.0 %)."
    )
    assert time == "It takes 10 ms."
    assert second == (
        "Each of these is significantly slower and more accurate than the one before, at 95 % confidence: touches, 2 touches, "
        "20 ms, 10.0 % wrong (5.0 % to 30.0 %)."
    )
    assert (
        rest
        == "With 12 objects, of 1 further setting of the front none is both significantly slower and "
        "significantly more accurate than touches, 2 touches."
    )
    assert said([]) == ["No setting could be both run and timed."]


def test_the_first_sentences_do_not_depend_on_an_order_that_timing_leaves_open():
    generator = np.random.default_rng(0)
    sentences, answers = set(), set()
    for _ in range(20):
        noise = 1 + 0.05 * generator.random(4)
        times = noise * [0.01, 0.01, 0.01, 0.1]
        settings = zip(("1", "2", "3", "5"), times, (0.4, 0.3, 0.35, 0.1), strict=True)
        rows = cost_rows([(f"{name} touches", time, error) for name, time, error in settings])
        for place, row in enumerate(rows):
            row |= {"as_quick": place < 3, "step": place == 1}
        sentences.add(said(rows)[0])
        answers.add(cost_verdict(cost_figures(rows, PARAMETERS)).sentence)
    assert len(sentences) == len(answers) == 1
    assert "2 touches" in sentences.pop()


def test_where_the_quickest_setting_is_the_most_accurate_the_answer_names_it_once():
    rows = cost_rows([("1 touch", 0.073, 0.0), ("5 touches", 0.15, 0.01)])
    for place, row in enumerate(rows):
        row |= {"as_quick": place == 0, "step": place == 0}
    answer = cost_verdict(cost_figures(rows, PARAMETERS))
    assert (answer.verdict, answer.number) == ("no", "73 ms")
    assert "least error of all" in answer.sentence
    rows[0]["error"], rows[1]["error"], rows[1]["on_front"] = 0.02, 0.0, True
    answer = cost_verdict(cost_figures(rows, PARAMETERS))
    assert (answer.verdict, answer.number) == ("depends", "73 ms to 150 ms")


def test_settings_of_a_group_are_one_row():
    rows = cost_rows([("a", 0.010, 0.30), ("b", 0.011, 0.31), ("c", 0.5, 0.3)], failed=["8 × 8"])
    rows[1]["group"] = rows[0]["group"]
    together, alone, failed = cost_figures(rows, PARAMETERS).groups
    assert together.settings == [("touches", "a; b")]
    assert (together.milliseconds, together.quartiles) == ("10–11", "9–13")
    assert (together.error, together.interval) == ("30.00–31.00", "15.0–72.0")
    assert together.part("look") == "2.5–2.8"
    assert (together.verdict, alone.verdict) == ("on the front", "dominated")
    assert alone.milliseconds == "500"
    assert (failed.milliseconds, failed.verdict) == ("–", "failed: images are too small.")


@pytest.mark.parametrize(
    ("lost", "verdict"),
    [
        ((0.001, -0.002, 0.009), "and costs less than 1 point of accuracy with 95 % confidence."),
        (
            (0.001, -0.002, 0.02),
            (
                "; its accuracy can't be told apart from the run's own with 12 objects "
                "(\N{MINUS SIGN}0.2 to +2.0 points of error)."
            ),
        ),
        ((0.03, 0.005, 0.06), "and costs +3.0 points of error (+0.5 to +6.0)."),
    ],
)
def test_a_saving_is_given_with_how_sure_its_price_is(lost, verdict):
    own = ("own", 0.1, 0.01, {"lost": 0.0, "lost_low": 0.0, "lost_high": 0.0})
    figures = dict(zip(("lost", "lost_low", "lost_high"), lost, strict=True))
    rows = cost_rows([own, ("lean", 0.06, 0.02, {**figures, "changes": RENDER})])
    assert said(rows)[-1].startswith(
        "Touches, lean (rendering.resolution 64) saves 40 % of the time"
    )
    assert said(rows)[-1].endswith(verdict)


def test_the_advice_says_from_which_price_on_looking_pays():
    rows = cost_rows(
        [
            ("blind", 0.01, 0.05, {**BLIND, "touches": 3, "viewpoints": 4}),
            ("looking", 0.1, 0.04, {"touches": 2, "viewpoints": 2, "looks": 2}),
        ]
    )
    cost = PARAMETERS.cost
    computing, robot, price = advise_robot(rows, on_robot(rows, cost), cost)
    assert computing.replace("\N{NO-BREAK SPACE}", " ") == (
        "By computing time, the quickest is random probing down to 5.0 % wrong (2.5 % to 20.0 %), then eye "
        "fixations down to 4.0 % wrong (2.0 % to 18.0 %)."
    )
    assert robot.replace("\N{NO-BREAK SPACE}", " ").endswith(
        "5 s for a touch and 0.5 s for a look, the quickest is eye fixations down to 4.0 % wrong (2.0 % to 18.0 %)."
    )
    assert price.replace("\N{NO-BREAK SPACE}", " ") == (
        "Without a look the error rate falls to 5.0 % at best, with 12 touches; 4 touches and 2 looks "
        "reach the same or better, so looking pays as long as a look takes less time than 4 touches "
        "(here 0.5 s, and 20 s)."
    )
    assert advise_robot(rows[:1], rows[:1], cost) == advise_robot(rows[1:], rows[1:], cost) == []


@pytest.mark.slow
def test_the_page_tells_what_accuracy_costs(tmp_path, monkeypatch):
    monkeypatch.setattr(sections, "stored_frontier", lambda: None)
    table = cost_table([*POINTS, ("16 touches", 0.5, 0.0)], failed=["8 × 8"])
    write_table(COST, table, tmp_path / "cost.parquet")
    files = write_run(tmp_path)
    with_costs = RunFiles(**{**vars(files), "extras": {"cost": tmp_path / "cost.parquet"}})
    page = read_page(render_page(read_run(with_costs, PARAMETERS, OBJECTS)))
    assert page.mismatches == []
    text = page.text.replace("\N{NO-BREAK SPACE}", " ")
    assert "the most accurate is touches, 1 touch: 40.0 % wrong" in text
    assert "failed: images are too small." in text
    assert "All 5 settings" in text
    assert "dominated" in text
    shapes = [element.attributes.get("class") for element in page.named("path", "circle")]
    assert shapes.count("filled") == 3 + 1  # the front, and the legend
    assert shapes.count("open") == 1 + 1
    assert shapes.count("crossed") == 1 + 1
    assert "The same settings on" not in text
    store_frontier(
        tmp_path / "cost.parquet", tmp_path / "kept.json", "make frontier", "a processor"
    )
    kept = StoredFrontier(**json.loads((tmp_path / "kept.json").read_text()) | {"objects": 142})
    monkeypatch.setattr(sections, "stored_frontier", lambda: kept)
    page = read_page(render_page(read_run(with_costs, PARAMETERS, OBJECTS)))
    assert page.mismatches == []
    assert "The same settings on 142 objects" in page.text
    measured = f"not in this run: {kept.date}, a processor, make frontier"
    assert measured in page.text
    assert "of the run's" not in page.text
    few = PARAMETERS.cost.model_copy(update={"maximum_objects": 2})
    sampled = PARAMETERS.model_copy(update={"cost": few})
    text = read_page(render_page(read_run(with_costs, sampled, OBJECTS))).text
    tested = max(row["objects"] or 0 for row in table.to_pylist())
    assert f"Measured with {tested} of the run's {len(OBJECTS)}" in text
