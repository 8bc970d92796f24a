"""The figures by which a table compares experiments."""

import json

import pytest

from visuohaptic.parameters import CostParameters
from visuohaptic.report.headline import headline_of

SUMMARY = {
    "results": {
        "order_free": {"fixation": {"naive_bayes": {"accuracy": {"mean": 1.0}}}},
        "paper": {
            name: {
                "k_nearest_neighbours": {"accuracy": {"mean": 0.1}},
                "support_vector_machine": {"accuracy": {"mean": mean}},
            }
            for name, mean in (("fixation", 0.810164), ("random", 0.75))
        },
    }
}
OWN = {
    "family": "fixation", "setting": "5 touches, 1 viewpoint", "touches": 5, "viewpoints": 1, "looks": 1,
    "error": 0.0, "lost": 0.0, "lost_low": 0.0, "lost_high": 0.0,
    "seconds": 0.0668, "seconds_low": 0.05, "seconds_high": 0.08,
}  # fmt: skip
OTHER = {**OWN, "lost_low": -0.1, "lost_high": 0.1, "seconds": 9.0}


def test_accuracies_are_per_cent_and_the_papers_pipeline_comes_first_under_plain_names():
    figures = headline_of(SUMMARY, [], CostParameters())
    assert list(figures.items()) == [
        ("fixation", 81.02),
        ("random", 75.0),
        ("order_free_fixation", 100.0),
    ]


def test_the_lead_and_its_spread_over_draws_are_in_points_where_there_are_draws():
    lead = {"difference": {"mean": 0.0171}, "draws": {"count": 5, "standard_deviation": 0.0261}}
    compared = {"paper": {"support_vector_machine": {"random": lead}}}
    figures = headline_of({**SUMMARY, "comparisons": compared}, [], CostParameters())
    assert (figures["lead"], figures["lead_draw_sd"]) == (1.71, 2.61)
    del lead["draws"]
    assert "lead" not in headline_of({**SUMMARY, "comparisons": compared}, [], CostParameters())


def test_seconds_are_of_the_runs_own_setting_by_a_robots_clock_and_by_the_computers():
    cost = CostParameters(touch_seconds=4.0, look_seconds=0.5)
    figures = headline_of(SUMMARY, [OTHER, OWN], cost)
    assert figures["robot_s"] == pytest.approx(5 * 4.0 + 0.5 + 0.07, abs=0.005)
    assert figures["cpu_s"] == 0.067


def test_a_setting_that_was_not_timed_has_no_seconds():
    figures = headline_of(SUMMARY, [{**OWN, "seconds": None}], CostParameters())
    assert not {"robot_s", "cpu_s"} & set(json.loads(json.dumps(figures)))
