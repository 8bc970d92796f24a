"""The front holds what nothing beats, and the sentence says what the table says."""

import itertools

import numpy as np
import pytest
from studies.surfaces import RUN

from visuohaptic.parameters import CostParameters, ExperimentParameters
from visuohaptic.recognition.intervals import exact_limit
from visuohaptic.studies.cost import front
from visuohaptic.studies.cost.front import (
    SettingPairs,
    break_even,
    error_rate,
    error_rows,
    find_savings,
    first_step,
    front_rows,
    join_costs,
    mark_groups,
    mark_steps,
    on_robot,
    pareto_front,
    reference_row,
    time_logarithms,
)
from visuohaptic.studies.cost.seconds import PARTS, PHASES
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
        key = {name: errors[-1][name] for name in ("family", "setting")}
        seconds += timed_rows(key, [time * factor for factor in (0.8, 0.9, 1.1, 1.3)])
    for place, name in enumerate(failed):
        row = {"family": "imprint", "setting": name, "place": place, **NOTHING}
        errors.append({**SAME, **row, "failed": "images are too small."})
    rows = join_costs(errors, seconds_table(seconds))
    for row in rows:
        row["as_quick"] = row["step"] = row is min(
            (row for row in rows if row["seconds"]), key=lambda row: row["seconds"], default=None
        )
    return rows


def timed_rows(key, times):
    """Give rows of `tables.COST_SECONDS` of one setting: a time an object, each in two turns."""
    rows = []
    for place, turn in itertools.product(range(len(times)), range(2)):
        parts = {f"seconds_{part}": times[place] / 4 for part in (*PHASES, *PARTS)}
        row = {**key, "object": f"cup/{place}", "turn": turn, "seconds": times[place], **parts}
        rows.append(row)
    return rows


def seconds_table(rows):
    names = [column.name for column in COST_SECONDS.columns]
    return build_table(COST_SECONDS, {name: [row[name] for row in rows] for name in names})


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


NAMES = [one.name for one in make_settings(BOTH, "frontier") if one.family == "random"]
OF_RANDOM = {"family": "random", "strategy": "random", "classifier": "support_vector_machine"}
NOISE = np.random.default_rng(1).uniform(-0.04, 0.04, (len(NAMES), 12))
FACTORS = np.array([0.2, 0.9, 1.0, 3.0])


def marked(levels, times):
    """Mark settings by accuracies, a level each, and seconds of four objects that differ a lot."""
    accuracies = [level + noise for level, noise in zip(levels, NOISE, strict=False)]
    cells = cells_of({("random", name): one for name, one in zip(NAMES, accuracies, strict=False)})
    points = [
        (name, 1.0, 1 - one.mean(), OF_RANDOM) for name, one in zip(NAMES, accuracies, strict=False)
    ]
    errors = cost_rows(points)
    timed = [
        row
        for name, time in zip(NAMES, times, strict=False)
        for row in timed_rows({"family": "random", "setting": name}, np.multiply(time, FACTORS))
    ]
    joined = {"seconds": None} | {f"seconds_{part}": None for part in (*PHASES, *PARTS)}
    rows = join_costs(
        [{key: row[key] for key in row if key not in joined} for row in errors],
        seconds_table(timed),
    )
    logarithms = time_logarithms(seconds_table(timed))
    pairs = SettingPairs(cells, logarithms, BOTH)
    mark_steps(rows, pairs)
    mark_groups(rows, pairs)
    return rows


def steps(rows):
    return [NAMES.index(row["setting"]) for row in rows if row["step"]]


def test_a_step_is_slower_and_more_accurate_than_the_step_before():
    rows = marked([0.5, 0.51, 0.9], [0.1, [0.2, 0.21, 0.2, 0.2], [0.3, 0.31, 0.3, 0.29]])
    assert steps(rows) == [0, 2]
    assert first_step(rows) is rows[0]


def test_objects_that_differ_a_lot_do_not_hide_that_one_setting_is_slower_on_each():
    rows = marked([0.5, 0.9], [0.1, [0.12, 0.121, 0.119, 0.12]])
    assert rows[1]["seconds_low"] < rows[0]["seconds_high"]
    assert [row["as_quick"] for row in rows] == [True, False]
    assert steps(rows) == [0, 1]


def test_of_settings_that_are_as_quick_the_most_accurate_is_the_step():
    around, again = [0.11, 0.09, 0.1, 0.101], [0.31, 0.29, 0.3, 0.301]
    rows = marked([0.50, 0.60, 0.90, 0.91], [0.1, around, 0.3, again])
    assert [row["as_quick"] for row in rows] == [True, True, False, False]
    assert steps(rows) == [1, 3]


def test_a_step_among_many_settings_that_differ_by_chance_is_rare():
    # By each setting's own 95 % interval one of seven would be a step in about every tenth trial.
    generator = np.random.default_rng(5)
    found = 0
    for _ in range(60):
        cells = cells_of({("random", name): generator.uniform(0.3, 0.7, 12) for name in NAMES})
        points = [(name, 0.1 * (1 + place), 0.5, OF_RANDOM) for place, name in enumerate(NAMES)]
        rows = cost_rows(points)
        seconds = {
            ("random", name): {(key, 0): np.log(0.1 * (1 + place)) + factor
                               for key, factor in zip("abcd", FACTORS, strict=True)}
            for place, name in enumerate(NAMES)
        }  # fmt: skip
        pairs = SettingPairs(cells, seconds, BOTH)
        slower = pairs.slower(rows, rows[0])
        assert slower == rows[1:]
        found += bool(pairs.more_accurate(slower, rows[0]))
    assert found <= 4


def test_settings_of_a_group_differ_neither_in_time_nor_in_error():
    around = [0.11, 0.09, 0.1, 0.101]
    groups = [row["group"] for row in marked([0.9, 0.9, 0.5, 0.9], [0.1, around, around, 0.2])]
    assert groups == [0, 0, 1, 2]


def test_a_paired_difference_tells_apart_settings_whose_intervals_overlap(monkeypatch):
    # Objects differ by much, and the second setting is worse by the same on each of them.
    spread = np.linspace(0.5, 0.9, 12)
    monkeypatch.setattr(f"{__name__}.NOISE", np.stack([spread, spread - 0.03]) - 0.5)
    rows = marked([0.5, 0.5], [0.1, [0.11, 0.09, 0.1, 0.101]])
    assert rows[0]["group"] != rows[1]["group"]


def test_a_time_of_one_object_alone_says_nothing_of_which_is_slower():
    seconds = {("random", name): {("a", 0): float(place)} for place, name in enumerate(NAMES)}
    rows = cost_rows([(name, 1.0 + place, 0.5, OF_RANDOM) for place, name in enumerate(NAMES)])
    assert SettingPairs({}, seconds, BOTH).as_quick(rows) == rows


def test_objects_are_compared_in_the_turns_in_which_both_settings_were_timed():
    # The second setting could not be timed in the first turn, which is a slow one.
    first, second = cost_rows([("1", 0.1, 0.5), ("2", 0.1, 0.5)])
    seconds = {
        ("touches", "1"): {(key, turn): float(5 * turn) for key in "abc" for turn in range(2)},
        ("touches", "2"): {(key, 0): 0.25 for key in "abc"},
    }
    found = SettingPairs({}, seconds, BOTH).time_ratio(first, second)
    assert (found.mean, found.low, found.high) == (0.25, 0.25, 0.25)


RENDER = '{"rendering.resolution": 64}'


def savings(*lost):
    own = ("own", 0.1, 0.01, {"lost": 0.0, "lost_low": 0.0, "lost_high": 0.0})
    figures = dict(zip(("lost", "lost_low", "lost_high"), lost, strict=True))
    lean = ("lean", 0.06, 0.02, {**figures, "changes": RENDER})
    named = ("other cues", 0.05, 0.02, {**figures, "changes": '{"recognition.best.cues": []}'})
    fewer = ("fewer touches", 0.04, 0.02, {**figures, "changes": RENDER, "touches": 2})
    slower = ("slower", 0.2, 0.02, {**figures, "changes": RENDER})
    alike = ("alike", 0.09, 0.02, {**figures, "changes": RENDER})
    rows = cost_rows([own, lean, named, fewer, slower, alike])
    rows[-1]["group"] = rows[0]["group"]
    return find_savings(rows)


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
    assert rows[0]["seconds"] == pytest.approx(0.01)
