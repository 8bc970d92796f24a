"""Figures that are not the sums of their predictions are found."""

import copy
import json

import pyarrow as pa
import pyarrow.compute as pc
import pytest
from report.synthetic import write_run

from visuohaptic.guards.sums import guard_sums
from visuohaptic.tables.phases import PREDICTIONS
from visuohaptic.tables.schema import read_table


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    files = write_run(tmp_path_factory.mktemp("run"))
    return json.loads(files.metrics.read_text()), read_table(PREDICTIONS, files.predictions)


def changed(metrics, change):
    metrics = copy.deepcopy(metrics)
    change(metrics)
    return metrics


def test_the_figures_of_a_run_are_the_sums_of_its_predictions(run):
    verdict = guard_sums(*run)
    assert verdict.outcome == "held"
    assert f"{run[1].num_rows} predictions" in verdict.found


@pytest.mark.parametrize("figure", ["accuracy", "object_accuracy", "balanced_accuracy"])
def test_a_figure_that_is_off_by_a_thousandth_is_named(run, figure):
    def shift(metrics):
        metrics["results"]["paper"]["random"]["naive_bayes"][figure]["mean"] += 1e-3

    verdict = guard_sums(changed(run[0], shift), run[1])
    assert verdict.outcome == "failed"
    assert f"1 differ: {figure} of paper, random, naive_bayes first" in verdict.found


def test_a_one_sided_p_value_is_found(run):
    def halve(metrics):
        metrics["comparisons"]["paper"]["naive_bayes"]["random"]["p_value"] /= 2

    assert "p value: fixation against random" in guard_sums(changed(run[0], halve), run[1]).found


def test_a_figure_that_is_missing_is_found(run):
    def drop(metrics):
        del metrics["results"]["paper"]["random"]["naive_bayes"]

    assert guard_sums(changed(run[0], drop), run[1]).outcome == "failed"


def test_predictions_of_another_run_are_found(run):
    metrics, predictions = run
    place = predictions.schema.get_field_index("predicted")
    true = predictions.column("class")
    right = predictions.set_column(place, predictions.schema.field("predicted"), true)
    assert pc.all(pc.equal(right.column("predicted"), true)).as_py()
    assert guard_sums(metrics, right).outcome == "failed"
    assert (
        guard_sums({"results": {}, "comparisons": {}}, pa.table(predictions).slice(0, 0)).outcome
        == "failed"
    )
