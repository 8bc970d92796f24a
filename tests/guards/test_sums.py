"""Figures that are not the sums of their predictions are found."""

import copy
import json

import pytest
from recognition.synthetic import with_column
from report.synthetic import write_run

from visuohaptic.guards.sums import guard_sums
from visuohaptic.tables.phases import PREDICTIONS
from visuohaptic.tables.schema import read_table


@pytest.fixture(scope="module")
def published(tmp_path_factory):
    files = write_run(tmp_path_factory.mktemp("run"))
    return json.loads(files.metrics.read_text()), read_table(PREDICTIONS, files.predictions)


@pytest.fixture
def run(published):
    return copy.deepcopy(published[0]), published[1]


def test_the_figures_of_a_run_are_the_sums_of_its_predictions(run):
    verdict = guard_sums(*run)
    assert verdict.outcome == "held"
    assert f"{run[1].num_rows} predictions" in verdict.found


@pytest.mark.parametrize("figure", ["accuracy", "object_accuracy", "balanced_accuracy"])
def test_a_figure_that_is_off_by_a_thousandth_is_named(run, figure):
    run[0]["results"]["paper"]["random"]["naive_bayes"][figure]["mean"] += 1e-3
    verdict = guard_sums(*run)
    assert verdict.outcome == "failed"
    assert f"1 differ: {figure} of paper, random, naive_bayes first" in verdict.found


def test_a_one_sided_p_value_is_found(run):
    run[0]["comparisons"]["paper"]["naive_bayes"]["random"]["p_value"] /= 2
    assert "p value: fixation against random" in guard_sums(*run).found


def test_a_figure_that_is_missing_is_found(run):
    del run[0]["results"]["paper"]["random"]["naive_bayes"]
    assert guard_sums(*run).outcome == "failed"


def test_predictions_of_another_run_and_a_run_without_any_are_found(run):
    metrics, predictions = run
    right = with_column(predictions, "predicted", predictions["class"].combine_chunks())
    assert guard_sums(metrics, right).outcome == "failed"
    nothing = {"results": {}, "comparisons": {}}
    assert guard_sums(nothing, predictions.slice(0, 0)).outcome == "failed"
