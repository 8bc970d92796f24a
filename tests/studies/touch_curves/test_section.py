"""The curves and their words come from the tables: who wins, who does not, and by how much."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from report.pages import read_page
from report.synthetic import write_study
from report.test_figures import intervals, marks

from touch_curves import section as section_of_study
from touch_curves.section import SECTION, curves, draw_curves, verdict
from touch_curves.study import touches_name
from touch_curves.tables import TOUCHES_NEEDED
from visuohaptic.report.environment import make_environment
from visuohaptic.report.estimates import Estimate
from visuohaptic.report.studies import read_figures
from visuohaptic.tables.schema import build_table, write_table

KEYS = {"pipeline": "order_free", "classifier": "linear_discriminant"}


def row(strategy, area, touches, gain=None, p_value=None):
    low, high = (None, None) if gain is None else (gain - 0.05, gain + 0.05)
    return {
        "strategy": strategy, "level": 0.9, "touches": touches, "touches_low": touches and 1,
        "touches_high": None, "most_touches": 2, "area": area, "area_low": area - 0.1,
        "area_high": area + 0.1, "gain": gain, "gain_low": low, "gain_high": high,
        "gain_new_classes_low": low, "gain_new_classes_high": high, "p_value_new_classes": p_value,
        "p_value": p_value, "objects": 12,
    }  # fmt: skip


BEHIND = [
    row("fixation", 0.7, None),
    row("farthest_point", 0.8, 2, -0.1, 0.001),
    row("random", 0.6, None, 0.1, 0.4),
]
AHEAD = [row("fixation", 0.8, 1), row("random", 0.7, 2, 0.1, 0.2)]
POINTS = [
    ("fixation", 1, 0.6),
    ("fixation", 2, 0.8),
    ("farthest_point", 1, 0.7),
    ("random", 1, 0.5),
]


def write_tables(results):
    """Write the curves, and the touches that the strategies of `BEHIND` need, as a run does."""
    columns = {name: [one[name] for one in BEHIND] for name in BEHIND[0]}
    needed = build_table(TOUCHES_NEEDED, {**KEYS, **columns})
    write_table(TOUCHES_NEEDED, needed, results / "touches_needed.parquet")
    points = [(touches_name(touches), mean, None, None) for _, touches, mean in POINTS]
    strategies = [strategy for strategy, _, _ in POINTS]
    places = [touches - 1 for _, touches, _ in POINTS]
    write_study(
        results / "studies", "touch_curves", points, **KEYS, strategy=strategies, place=places
    )


def answer(rows):
    ranked = sorted(rows, key=lambda one: -one["area"])
    return verdict([{**one, "adjusted_p": one["p_value"]} for one in ranked])


def test_where_attention_wins_the_words_say_whether_beyond_chance():
    text = answer(AHEAD)
    assert "attention wins" in text
    assert "no difference is beyond chance (the least p after Holm's correction is 0.2)" in text
    assert "ttention" not in answer([row("random", 0.6, None)])  # without fixations


def test_a_plug_in_may_call_its_strategy_as_a_column():
    point = {"strategy": "touches", "place": 0, "accuracy": 0.5}
    found = curves("order_free", "naive_bayes", [], [point])
    assert found["by_touches"] == [{"touches": 1, "accuracy": {"touches": Estimate(0.5)}}]


@pytest.mark.parametrize("error", [None, "policy rogue, fit: it raised KeyError: <skin>."])
def test_a_refused_strategy_is_named_with_its_reason(measured, error):
    points = [{**measured[0], "strategy": "rogue", "accuracy": None, "error": error}, *measured]
    section = replace(SECTION, folder=Path(section_of_study.__file__).parent)
    environment = make_environment([section])
    environment.globals["confidence"] = "95 %"
    found = curves("paper", "naive_bayes", BEHIND, points if error else measured)
    values = {"pipelines": [found], "draw_curves": draw_curves}
    page = read_page(environment.get_template(section.template_path).render(values)).text
    assert ("has no area" in page) == bool(error)
    assert not error or f"Rogue has no area under the curve: {error}" in page


@pytest.fixture
def measured(tmp_path):
    rows = [("1 touch", 0.6, None, None), ("2 touches", 0.8, None, None)]
    return read_figures(write_study(tmp_path, "touch_curves", rows), "touch_curves")


def test_touches_are_counted_from_one_and_one_object_alone_has_no_intervals(measured):
    figure = draw_curves(measured)
    np.testing.assert_allclose(marks(figure, "eye fixations"), [[1, 0.6], [2, 0.8]])
    assert intervals(figure, 1) == {(row["low"], row["high"]) for row in measured}
    alone = draw_curves([{**row, "low": None, "high": None} for row in measured])
    assert all(low == high for low, high in intervals(alone, 1))
