"""The front holds what nothing beats; steps are what paired comparisons tell apart."""

from dataclasses import replace

import numpy as np
import pyarrow as pa
import pytest
from studies.surfaces import RUN, run_tables, small_surfaces

from visuohaptic.evaluation.intervals import DIFFERENCE, object_interval
from visuohaptic.recognition.experiment import run_pipeline
from visuohaptic.studies.conditions import is_measured_by_run, plan_study, with_changes
from visuohaptic.studies.cost.cost_rows import mark_front, read_costs
from visuohaptic.studies.cost.front import (
    NOT_PREDICTED,
    error_rate,
    make_frontier,
    more_accurate,
    setting_cells,
    setting_rows,
    setting_times,
    slower_settings,
    time_quantiles,
)
from visuohaptic.studies.cost.seconds import make_frontier_seconds
from visuohaptic.studies.cost.settings import FRONTIER, Setting, frontier_settings
from visuohaptic.studies.figures import Cell
from visuohaptic.studies.measuring import measure_conditions
from visuohaptic.studies.study import StepInputs
from visuohaptic.tables.phases import PREDICTIONS
from visuohaptic.tables.schema import build_rows, names_of, write_table
from visuohaptic.tables.studies import COST, COST_PARTS, COST_SECONDS, STUDY

SAME = {
    **dict.fromkeys(names_of(COST.columns)),
    **dict.fromkeys(("quicker", "as_quick", "step"), False),
    "family": "touches", "touches": 5, "viewpoints": 1, "looks": 1, "strategy": "fixation",
    "pipeline": "order_free", "classifier": "naive_bayes", "changes": "{}",
}  # fmt: skip
RENDER = '{"rendering.resolution": 64}'


def cost_rows(points, failed=()):
    """Return rows of (setting, seconds, error, other columns), then of the names of failed settings."""
    first = min((time for _, time, *_ in points), default=None)
    rows = []
    for place, (name, time, error, *others) in enumerate(points):
        times = time * np.array([0.8, 0.9, 1.1, 1.3])[:, None, None] * np.array([1, *[0.25] * 7])
        row = {"setting": name, "place": place, "objects": 12, "quicker": time < 0.1}
        row |= {"error": error, "error_low": error / 2, "error_high": min(1.0, 2 * error + 0.1)}
        row |= dict.fromkeys(("as_quick", "step"), time == first)
        rows.append({**SAME, **row, **time_quantiles(times), **dict(*others)})
    for place, name in enumerate(failed):
        row = {"family": "imprint", "setting": name, "place": place}
        rows.append({**SAME, **row, "failed": "images are too small."})
    return mark_front(rows)


def cost_table(points, failed=()):
    """Return `tables.COST` of the same."""
    return build_rows(COST, cost_rows(points, failed))


def test_the_front_is_that_of_the_definition():
    points = np.random.default_rng(0).integers(1, 6, size=(60, 2)).tolist()
    rows = mark_front([{"seconds": seconds, "error": error} for seconds, error in points])
    for (seconds, error), row in zip(points, rows, strict=True):
        beaten = any(
            other <= seconds and wrong <= error and (other < seconds or wrong < error)
            for other, wrong in points
        )
        assert row["on_front"] == (not beaten) != row["dominated"]
    assert 0 < sum(row["on_front"] for row in rows) < 60


def test_a_setting_without_figures_is_neither_on_the_front_nor_dominated():
    *_, failed = cost_rows([("a", 0.1, 0.2)], failed=["8 × 8"])
    assert not failed["on_front"]
    assert not failed["dominated"]


def cell(accuracy):
    objects = tuple(("a", str(place)) for place in range(len(accuracy)))
    return Cell(objects, np.array(accuracy), np.ones(len(accuracy)))


def test_an_error_rate_is_what_the_accuracy_leaves():
    rate = error_rate(cell([1.0, 0.5, 0.75, 0.25, 1.0, 0.5]), RUN)
    assert rate["error"] == pytest.approx(1 / 3)
    assert 0 <= rate["error_low"] < 1 / 3 < rate["error_high"] <= 1
    assert rate["objects"] == 6


NOISE = np.random.default_rng(1).uniform(-0.04, 0.04, (4, 12))
AROUND = [0.095, 0.11, 0.1, 0.101]


def rows_of(touches, accuracies, times):
    """Return rows of settings by the accuracies of objects, and by seconds of four objects that differ a lot."""
    settings = [Setting("touches", str(place), place, one) for place, one in enumerate(touches)]
    taken = np.stack([np.multiply(time, [0.2, 0.9, 1.0, 3.0]) for time in times])
    cells = [cell(one) for one in accuracies]
    return setting_rows(settings, cells, np.tile(taken[..., None, None], 8), RUN)


LIMIT = object_interval(np.zeros(12), np.ones(12), RUN.recognition.intervals, DIFFERENCE).high


@pytest.mark.parametrize(
    ("own", "other", "mean", "low", "high"),
    [
        ([0.9] * 12, [0.4, 0.8] * 6, 0.3, (0.1, 0.3), (0.3, 0.5)),
        # Twelve equal objects leave open that others differ.
        ([1.0] * 12, [1.0] * 12, 0, (-LIMIT, -LIMIT), (LIMIT, LIMIT)),
    ],
)
def test_a_setting_loses_what_the_reference_has_more(own, other, mean, low, high):
    less, reference, again = rows_of([1, 2, 2], [other, own, own], [0.1] * 3)
    assert reference["lost_low"] == reference["lost"] == reference["lost_high"] == 0
    assert again["lost_low"] == -LIMIT
    assert less["lost"] == pytest.approx(mean)
    assert low[0] <= less["lost_low"] <= low[1]
    assert high[0] <= less["lost_high"] <= high[1]


@pytest.mark.parametrize(
    ("levels", "times", "quick", "steps"),
    [
        # Slower and more accurate than the step before.
        ([0.5, 0.51, 0.9], [0.1, [0.2, 0.21, 0.2, 0.2], [0.3, 0.31, 0.3, 0.29]], [0], [0, 2]),
        # Slower on each object, by less than objects differ.
        ([0.5, 0.9], [0.1, [0.12, 0.121, 0.119, 0.12]], [0], [0, 1]),
        # The most accurate of those as quick.
        ([0.3, 0.4, 0.9, 0.91], [0.1, AROUND, 0.3, [0.31, 0.29, 0.3, 0.301]], [0, 1], [1, 3]),
    ],
)
def test_steps_are_worth_their_time(levels, times, quick, steps):
    accuracies = np.array(levels)[:, None] + NOISE[: len(levels)]
    rows = rows_of([2] * len(levels), accuracies, times)
    assert [row["place"] for row in rows if row["as_quick"]] == quick
    assert [row["place"] for row in rows if row["step"]] == steps


@pytest.mark.parametrize(("touches", "quicker"), [(2, [1]), (1, [])])
def test_a_setting_is_quicker_than_the_runs_own_where_it_is_on_each_object(touches, quicker):
    rows = rows_of([touches, 1, 1], [[0.5] * 12] * 3, [0.1, 0.08, AROUND])
    assert [row["place"] for row in rows if row["quicker"]] == quicker


def test_a_gain_that_is_significant_alone_is_not_among_many():
    # Six objects that all gain much have p = 2 / 2 ** 6 = 0.031; Holm multiplies it by the settings.
    last, better, worse = (cell([accuracy] * 6) for accuracy in (0.1, 0.95, 0.05))
    cells = [last, better, better, worse, cell([0.95] * 5)]
    found = [more_accurate(places, 0, cells, RUN) for places in ([1], [1, 2], [3], [4])]
    assert found == [[1], [], [], []]


def test_a_time_of_one_object_alone_says_nothing_of_which_is_slower():
    assert not slower_settings(np.arange(6.0).reshape(6, 1, 1), 0.95).any()


def test_objects_are_compared_in_the_turns_in_which_both_settings_were_timed():
    # The second setting is slower by a quarter; it could not be timed in the second turn, a slow one.
    first, second = np.tile([0.0, 5.0], (3, 1)), np.tile([0.25, np.nan], (3, 1))
    slower = slower_settings(np.stack([first, second]), 0.95)
    assert slower.tolist() == [[False, True], [False, False]]


def test_times_stand_by_setting_object_and_turn_and_what_was_not_timed_is_missing():
    settings = [Setting("touches", name, 0, 2) for name in ("quick", "never", "slow")]
    timed = [("slow", "a/b", 0, 3.0), ("quick", "a/a", 1, 1.0), ("quick", "a/a", 0, 2.0)]
    keys = ("setting", "object", "turn", "seconds")
    same = {"family": "touches", **{name: 0.5 for name, _ in COST_PARTS}}
    rows = [{**same, **dict(zip(keys, one, strict=True))} for one in timed]
    found = setting_times(settings, build_rows(COST_SECONDS, rows))
    nan = np.nan
    expected = [[[2, 1], [nan, nan]], [[nan, nan], [nan, nan]], [[nan, nan], [3, nan]]]
    np.testing.assert_array_equal(found[..., 0], expected)
    quick = time_quantiles(found[0])
    assert (quick["seconds_low"], quick["seconds"], quick["seconds_high"]) == (1.25, 1.5, 1.75)
    assert (quick["seconds_cast"], quick["recognitions"]) == (0.5, 2)
    assert time_quantiles(found[1]) == {}


def test_a_strategy_that_needs_no_view_looks_at_none():
    settings = [Setting(name, "own", 0, 2, 3, name) for name in ("fixation", "random")]
    rows = setting_rows(settings, [cell([0.5] * 12)] * 2, np.full((2, 1, 1, 8), np.nan), RUN)
    assert [row["looks"] for row in rows] == [3, 0]


def test_a_frontier_without_settings_reads_no_mesh(tmp_path):
    run = RUN.model_copy(update={"cost": RUN.cost.model_copy(update={"frontier_touches": ()})})
    files = {"meshes": ["none.ply"], "features": []}
    made = [tmp_path / "seconds", tmp_path / "cost"]
    make_frontier_seconds(StepInputs("frontier", files, made[:1], run))
    make_frontier(
        StepInputs("frontier", {"blocks": [], "predictions": [], "tables": made[:1]}, made[1:], run)
    )
    assert read_costs(made[1]) == []


def test_the_run_measured_its_own_touches_by_its_own_classifiers():
    run = with_changes(RUN, {"probing.strategies": ["fixation", "random"]})
    settings, planned = frontier_settings(run), plan_study(FRONTIER, run).conditions
    own = {
        (one.family, one.name)
        for one, condition in zip(settings, planned, strict=True)
        if is_measured_by_run(condition, run)
    }
    assert own == {
        ("fixation", "2 touches, 1 viewpoint"),
        ("random", "2 touches, 1 viewpoint"),
        ("paper", "with its map"),
    }
    few = with_changes(run, {"recognition.classifiers": ["k_nearest_neighbours"]})
    missing = [one for one in plan_study(FRONTIER, few).conditions if is_measured_by_run(one, few)]
    assert [one.condition.name for one in missing] == [
        "fixation, 2 touches, 1 viewpoint", "random, 2 touches, 1 viewpoint",
    ]  # fmt: skip


@pytest.mark.slow
def test_what_the_run_predicted_is_what_the_study_measures(tmp_path):
    features = run_tables(small_surfaces())[2]
    planned = plan_study(FRONTIER, RUN).conditions
    settings = frontier_settings(RUN)
    own = [one for one in planned if is_measured_by_run(one, RUN)]
    measured = [
        part for one in own for part in measure_conditions("frontier", [one], features, RUN.seed)
    ]
    files = []
    for pipeline in RUN.recognition.pipelines:
        _, predictions = run_pipeline(features, RUN.recognition, RUN.seed, pipeline)
        files.append(tmp_path / f"{pipeline}.parquet")
        write_table(PREDICTIONS, predictions, files[-1])
    write_table(STUDY, pa.concat_tables(measured), tmp_path / "block.parquet")
    blocks = {"blocks": [tmp_path / "block.parquet"]}
    chosen = [one for one, condition in zip(settings, planned, strict=True) if condition in own]
    only = replace(FRONTIER, conditions=lambda _: [one.condition for one in own])
    step = StepInputs("frontier", {**blocks, "predictions": []}, (), RUN)
    expected = setting_cells(step, only, chosen)
    step = StepInputs("frontier", {"blocks": [], "predictions": files}, (), RUN)
    found = setting_cells(step, only, chosen)
    assert len(found) == len(expected) == 2
    for one, other in zip(found, expected, strict=True):
        assert one.objects == other.objects
        assert one.accuracy.tolist() == other.accuracy.tolist()
        assert one.weights.tolist() == other.weights.tolist()


def test_a_classifier_that_could_not_be_fitted_has_the_reason(tmp_path):
    predictions = tmp_path / "predictions.parquet"
    write_table(PREDICTIONS, PREDICTIONS.arrow.empty_table(), predictions)
    planned = plan_study(FRONTIER, RUN).conditions
    own = [
        one
        for one in zip(frontier_settings(RUN), planned, strict=True)
        if is_measured_by_run(one[1], RUN)
    ]
    only = replace(FRONTIER, conditions=lambda _: [one.condition for _, one in own])
    step = StepInputs("frontier", {"blocks": [], "predictions": [predictions]}, (), RUN)
    assert {one.error for one in setting_cells(step, only, [one for one, _ in own])} == {
        NOT_PREDICTED.error
    }
