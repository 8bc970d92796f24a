"""The front holds what nothing beats, and the sentence says what the table says."""

import numpy as np
import pytest
from studies.surfaces import RUN

from visuohaptic.parameters import CostParameters, ExperimentParameters
from visuohaptic.recognition.intervals import exact_limit
from visuohaptic.studies.cost import front
from visuohaptic.studies.cost.front import (
    break_even,
    error_rate,
    error_rows,
    find_savings,
    front_rows,
    join_costs,
    mark_steps,
    merge_alike,
    on_robot,
    pareto_front,
    reference_row,
)
from visuohaptic.studies.cost.settings import make_settings
from visuohaptic.studies.figures import Cell
from visuohaptic.tables.schema import build_table
from visuohaptic.tables.studies import COST_SECONDS

NOTHING = {"error": None, "error_low": None, "error_high": None, "objects": None}
SAME = {
    "touches": 5, "viewpoints": 1, "looks": 1, "strategy": "fixation", "pipeline": "best",
    "classifier": "naive_bayes", "changes": "{}", "lost": None, "lost_low": None, "lost_high": None,
}  # fmt: skip


def cost_rows(points, failed=()):
    """Give rows of (setting, seconds, error, other columns), then of the names of failed settings."""
    errors, seconds = [], []
    for place, (name, time, error, *others) in enumerate(points):
        row = {"family": "touches", "setting": name, "place": place, "objects": 12, "failed": None}
        row |= {"error": error, "error_low": error / 2, "error_high": min(1.0, 2 * error + 0.1)}
        errors.append({**SAME, **row, **dict(*others)})
        phases = {f"seconds_{part}": time / 4 for part in ("look", "touch", "describe", "name")}
        phases |= {f"seconds_{part}": time / 8 for part in ("render", "attend", "cast")}
        quartiles = {"seconds_low": 0.9 * time, "seconds_high": 1.2 * time, "recognitions": 12}
        key = {name: errors[-1][name] for name in ("family", "setting")}
        seconds.append({**key, "seconds": time, **quartiles, **phases})
    for place, name in enumerate(failed):
        row = {"family": "imprint", "setting": name, "place": place, **NOTHING}
        errors.append({**SAME, **row, "failed": "images are too small."})
    names = [column.name for column in COST_SECONDS.columns]
    columns = {name: [row[name] for row in seconds] for name in names}
    return join_costs(errors, build_table(COST_SECONDS, columns))


def cost_table(points, failed=()):
    """Give `tables.COST` of the same."""
    return front.cost_table(cost_rows(points, failed))


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
    assert exact_limit(100, 0.95) == pytest.approx(0.0362, abs=1e-4)


BOTH = ExperimentParameters.from_mapping(
    {**RUN.model_dump(), "probing": {"strategies": ["fixation", "random"]}}
)


def cells_of(accuracies):
    """Give cells of the frontier's settings: an accuracy an object each, all others all right."""
    found = {}
    for setting in make_settings(BOTH, "frontier"):
        key = (setting.condition.name, setting.pipeline, setting.strategy, setting.classifier)
        found[key] = cell(accuracies.get((setting.family, setting.name), [1.0] * 12))
    return found


def test_a_setting_loses_what_the_reference_has_more():
    own = ("fixation", "2 touches, 1 viewpoint")
    quick = ("random", "1 touch, 1 viewpoint")
    cells = cells_of({own: [0.9] * 12, quick: [0.4, 0.8] * 6})
    rows = {(row["family"], row["setting"]): row for row in error_rows(cells, BOTH, "frontier")}
    assert (rows[own]["lost_low"], rows[own]["lost_high"]) == (0, 0)
    assert rows[quick]["lost"] == pytest.approx(0.3)
    assert 0.1 < rows[quick]["lost_low"] < 0.3 < rows[quick]["lost_high"] < 0.5
    assert reference_row([rows[quick], rows[own]]) is rows[own]


def test_equal_figures_of_few_objects_leave_their_difference_open():
    own = ("fixation", "2 touches, 1 viewpoint")
    rows = error_rows(cells_of({own: [1.0] * 12}), BOTH, "frontier")
    other = next(row for row in rows if (row["family"], row["setting"]) != own)
    limit = exact_limit(12, 0.95)
    assert (other["lost"], other["lost_low"], other["lost_high"]) == (0, -limit, limit)


def test_a_step_is_more_accurate_than_the_step_before_beyond_the_choice_of_objects():
    generator = np.random.default_rng(1)
    names = ["1 touch, 1 viewpoint", "2 touches, 1 viewpoint", "1 touch, 4 viewpoints"]
    noise = generator.uniform(-0.2, 0.2, 12)
    levels = [0.5 + noise, 0.52 + noise[::-1], 0.9 + noise / 4]
    cells = cells_of({("random", name): level for name, level in zip(names, levels, strict=True)})
    rows = cost_rows(
        [
            (name, 0.1 * (place + 1), 1 - level.mean(), {"family": "random", "strategy": "random"})
            for place, (name, level) in enumerate(zip(names, levels, strict=True))
        ]
    )
    for row in rows:
        row["classifier"] = "support_vector_machine"
    assert all(row["on_front"] for row in rows)
    mark_steps(rows, cells, BOTH)
    assert [row["step"] for row in rows] == [True, False, True]


def test_a_step_is_slower_beyond_the_noise_of_timing_and_the_most_accurate_of_its_equals():
    names = [one.name for one in make_settings(BOTH, "frontier") if one.family == "random"][:4]
    levels = dict(zip(names, (0.50, 0.60, 0.90, 0.91), strict=True))
    times = dict(zip(names, (0.100, 0.101, 0.300, 0.301), strict=True))
    noise = np.linspace(-0.05, 0.05, 12)
    cells = cells_of({("random", name): level + noise for name, level in levels.items()})
    of_family = {"family": "random", "strategy": "random", "classifier": "support_vector_machine"}
    rows = cost_rows([(name, times[name], 1 - level, of_family) for name, level in levels.items()])
    mark_steps(rows, cells, BOTH)
    assert [row["setting"] for row in rows if row["step"]] == [names[1], names[3]]


def alike(first, second):
    return [[row["setting"] for row in group] for group in merge_alike(cost_rows([first, second]))]


def test_settings_are_merged_where_neither_time_nor_error_tells_them_apart():
    assert alike(("a", 0.1, 0.2), ("b", 0.11, 0.21)) == [["a", "b"]]
    assert alike(("a", 0.1, 0.2), ("b", 0.2, 0.2)) == [["a"], ["b"]]
    # Of two intervals that overlap neither may leave out the other's rate.
    assert alike(("a", 0.1, 0.1), ("b", 0.1, 0.12)) == [["a", "b"]]
    assert alike(("a", 0.1, 0.1), ("b", 0.1, 0.25)) == [["a"], ["b"]]


def test_every_two_settings_of_a_group_are_alike():
    rows = cost_rows([("a", 0.100, 0.2), ("b", 0.120, 0.2), ("c", 0.140, 0.2)])
    assert [[row["setting"] for row in group] for group in merge_alike(rows)] == [["a", "b"], ["c"]]


@pytest.mark.parametrize(("low", "apart"), [(0.001, True), (-0.001, False)])
def test_a_paired_difference_to_the_runs_own_setting_tells_apart_too(low, apart):
    own = ("own", 0.1, 0.10, {"lost": 0.0, "lost_low": 0.0, "lost_high": 0.0})
    other = ("other", 0.1, 0.12, {"lost": 0.02, "lost_low": low, "lost_high": 0.04})
    assert (len(alike(own, other)) == 2) == apart


RENDER = '{"rendering.resolution": 64}'


def savings(*lost):
    own = ("own", 0.1, 0.01, {"lost": 0.0, "lost_low": 0.0, "lost_high": 0.0})
    figures = dict(zip(("lost", "lost_low", "lost_high"), lost, strict=True))
    lean = ("lean", 0.06, 0.02, {**figures, "changes": RENDER})
    named = ("other cues", 0.05, 0.02, {**figures, "changes": '{"recognition.best.cues": []}'})
    fewer = ("fewer touches", 0.04, 0.02, {**figures, "changes": RENDER, "touches": 2})
    slower = ("slower", 0.2, 0.02, {**figures, "changes": RENDER})
    return find_savings(cost_rows([own, lean, named, fewer, slower]))


@pytest.mark.parametrize(
    ("lost", "verdict"),
    [
        ((0.001, -0.002, 0.009), "free"),
        ((0.001, -0.002, 0.02), "open"),
        ((0.03, 0.005, 0.06), "costs"),
    ],
)
def test_a_saving_is_of_the_run_with_one_thing_made_smaller(lost, verdict):
    (found,) = savings(*lost)
    assert found.row["setting"] == "lean"
    assert found.saved == pytest.approx(0.4)
    assert found.verdict == verdict


BLIND = {"strategy": "random", "looks": 0}


def test_looking_pays_below_the_touches_that_it_saves_a_look():
    rows = cost_rows(
        [
            ("blind, many", 0.01, 0.05, {**BLIND, "touches": 3, "viewpoints": 4}),
            ("blind, few", 0.01, 0.3, {**BLIND, "touches": 1}),
            ("looking, few", 0.1, 0.2, {"touches": 1}),
            ("looking, two", 0.1, 0.04, {"touches": 2, "viewpoints": 2, "looks": 2}),
        ]
    )
    found = break_even(rows)
    assert found.error == 0.05
    assert (found.blind["setting"], found.looking["setting"]) == ("blind, many", "looking, two")
    assert found.touches_a_look == (12 - 4) / 2
    assert break_even(rows[:3]).touches_a_look is None
    assert break_even(rows[2:]) is None


def test_a_robot_pays_for_touches_and_looks_and_its_front_is_its_own():
    rows = cost_rows(
        [
            ("blind", 0.01, 0.05, {**BLIND, "touches": 3, "viewpoints": 4}),
            ("looking", 0.1, 0.04, {"touches": 2, "viewpoints": 2, "looks": 2}),
        ],
        failed=["8 × 8"],
    )
    assert [row["on_front"] for row in rows] == [True, True, False]
    robot = on_robot(rows, CostParameters(touch_seconds=5, look_seconds=0.5))
    assert [row["seconds"] for row in robot] == [pytest.approx(60.01), pytest.approx(21.1), None]
    assert [row["on_front"] for row in robot] == [False, True, False]
    assert rows[0]["seconds"] == 0.01
