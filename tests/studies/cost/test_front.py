"""The front holds what nothing beats, and the sentence says what the table says."""

import numpy as np
import pytest
from studies.surfaces import RUN

from visuohaptic.studies.cost.front import (
    advise,
    clopper_pearson_high,
    error_rate,
    front_rows,
    join_costs,
    pareto_front,
)
from visuohaptic.studies.figures import Cell
from visuohaptic.tables.schema import build_table
from visuohaptic.tables.studies import COST_SECONDS

NOTHING = {"error": None, "error_low": None, "error_high": None, "objects": None}


def cost_table(points, failed=()):
    """Give `tables.COST` of (setting, seconds, error), then of the names of failed settings."""
    errors, seconds = [], []
    for place, (name, time, error) in enumerate(points):
        key = {"family": "touches", "setting": name}
        figures = {"error": error, "error_low": error / 2, "error_high": min(1.0, 2 * error + 0.1)}
        errors.append({**key, "place": place, **figures, "objects": 12, "failed": None})
        phases = {f"seconds_{part}": time / 4 for part in ("look", "touch", "describe", "name")}
        quartiles = {"seconds_low": 0.9 * time, "seconds_high": 1.2 * time}
        seconds.append({**key, "seconds": time, **quartiles, **phases, "recognitions": 12})
    for place, name in enumerate(failed):
        key = {"family": "imprint", "setting": name, "place": place}
        errors.append({**key, **NOTHING, "failed": "images are too small."})
    same = {"touches": 5, "viewpoints": 1, "pipeline": "best", "classifier": "naive_bayes"}
    same |= {"changes": "{}"}
    return join_costs(
        [{**same, **row} for row in errors],
        build_table(COST_SECONDS, {k: [row[k] for row in seconds] for k in seconds[0]}),
    )


def test_the_front_is_that_of_the_definition():
    generator = np.random.default_rng(0)
    seconds, errors = generator.integers(1, 6, size=(2, 60)).astype(float)
    front = pareto_front(seconds, errors)
    for point in range(60):
        beaten = any(
            seconds[other] <= seconds[point]
            and errors[other] <= errors[point]
            and (seconds[other] < seconds[point] or errors[other] < errors[point])
            for other in range(60)
        )
        assert front[point] == (not beaten)
    assert 0 < front.sum() < 60


def test_a_setting_without_figures_is_neither_on_the_front_nor_dominated():
    rows = cost_table([("1 touch", 0.1, 0.2)], failed=["8 × 8"]).to_pylist()
    assert [(row["on_front"], row["dominated"]) for row in rows] == [(True, False), (False, False)]
    assert rows[1]["seconds"] is None
    assert rows[1]["failed"] == "images are too small."


def test_each_setting_with_figures_is_either_on_the_front_or_dominated():
    points = [("a", 0.1, 0.2), ("b", 0.2, 0.2), ("c", 0.3, 0.01), ("d", 0.05, 0.5)]
    rows = cost_table(points).to_pylist()
    assert [row["setting"] for row in front_rows(rows)] == ["d", "a", "c"]
    assert [row["dominated"] for row in rows] == [False, True, False, False]


def test_the_sentence_names_the_cheapest_that_reaches_the_aim_and_the_next_point():
    points = [("1 touch", 0.01, 0.3), ("5 touches", 0.04, 0.04), ("16 touches", 0.1, 0.01)]
    said = advise(cost_table(points).to_pylist())
    assert said.startswith("For 95 % take 5 touches (family touches): it costs 40 ms a recognition")
    assert "16 touches (family touches), costs 2.5 times as much (100 ms)" in said
    assert "interval 2.0 % to 18.0 %" in said
    last = advise(cost_table(points[:2]).to_pylist())
    assert last.endswith("Nothing that was measured is more accurate.")


def test_an_aim_that_nothing_reaches_is_told():
    said = advise(cost_table([("1 touch", 0.01, 0.3), ("5 touches", 0.04, 0.2)]).to_pylist())
    assert said.startswith("No setting reaches 95 %: the most accurate, 5 touches")
    assert "classifies 80.0 % correctly and costs 40 ms" in said


@pytest.mark.parametrize("rows", [[], cost_table([("a", 1.0, 0.1)], ["b"]).to_pylist()[1:]])
def test_nothing_measured_gives_a_sentence(rows):
    assert advise(rows) == "No setting could be both run and timed."


def cell(accuracy):
    objects = tuple(("a", str(place)) for place in range(len(accuracy)))
    return Cell(objects, np.array(accuracy), np.ones(len(accuracy)))


def test_an_error_rate_is_what_the_accuracy_leaves():
    rate = error_rate(cell([1.0, 0.5, 0.75, 0.25, 1.0, 0.5]), RUN)
    assert rate["error"] == pytest.approx(1 / 3)
    assert 0 <= rate["error_low"] < 1 / 3 < rate["error_high"] <= 1
    assert rate["objects"] == 6


def test_no_error_is_not_taken_for_certainty():
    rate = error_rate(cell([1.0] * 9), RUN)
    assert (rate["error"], rate["error_low"]) == (0.0, 0.0)
    # Of nine objects: 1 - 0.025 ** (1 / 9), as any table of binomial limits has it.
    assert rate["error_high"] == pytest.approx(0.3363, abs=1e-4)
    assert clopper_pearson_high(100, 0.95) == pytest.approx(0.0362, abs=1e-4)
