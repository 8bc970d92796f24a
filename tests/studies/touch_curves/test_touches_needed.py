"""Areas, touches needed and what fixations gain, over objects."""

import json

import numpy as np
import pytest

from touch_curves import touches_needed as module
from touch_curves.study import LONGEST_SEQUENCE, touches_name
from touch_curves.touches_needed import (
    curve_areas,
    make_touches_needed,
    stays_at,
    touches_needed,
)
from visuohaptic.base.errors import RecognitionError
from visuohaptic.evaluation.intervals import compare_differences
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.studies.figures import Cell, condition_interval
from visuohaptic.studies.study import StepInputs

INTERVALS = IntervalParameters()
RISE = np.linspace(0.4, 0.94, LONGEST_SEQUENCE)


def curve(means, objects=4, weights=None, apart=0.01):
    names = tuple((f"class{number % 2}", f"object{number}") for number in range(objects))
    aside = apart * np.arange(objects)
    weights = np.ones(objects) if weights is None else np.array(weights)
    return [Cell(names, mean + aside, weights) for mean in means]


def cells(curves):
    return {
        (touches_name(count), "order_free", strategy, "linear_discriminant"): cell
        for strategy, points in curves.items()
        for count, cell in enumerate(points, start=1)
    }


CELLS = cells(
    {"fixation": curve(RISE), "random": curve(RISE - 0.1), "curvature": curve(RISE - 0.3)}
)


def rows_of(found):
    return {row["strategy"]: row for row in touches_needed(found, INTERVALS).to_pylist()}


def test_the_area_is_that_of_trapezoids_under_each_objects_curve():
    areas = curve_areas(curve([0.2, 0.6, 0.7]))
    np.testing.assert_allclose(areas, (0.4 + 0.65) / 2 + 0.01 * np.arange(4))
    np.testing.assert_allclose(curve_areas(curve([0.5])), 0.5 + 0.01 * np.arange(4))
    found = rows_of(CELLS)["fixation"]
    assert found["area"] == pytest.approx(0.67 + 0.015)
    assert found["area_low"] < found["area"] < found["area_high"]


def test_touches_needed_are_those_from_which_accuracy_stays():
    assert stays_at(0.9, [0.5, 0.92, 0.8, 0.95]) == 4
    assert stays_at(0.9, [0.95, 0.92, 0.9, 0.95]) == 1
    assert rows_of(CELLS)["fixation"]["touches"] == 15
    never = rows_of(CELLS)["curvature"]
    assert (never["touches"], never["most_touches"]) == (None, LONGEST_SEQUENCE)
    apart = rows_of(cells({"random": curve(RISE - 0.06, apart=0.04)}))["random"]
    assert apart["touches_low"] < apart["touches"] == 15
    assert apart["touches_high"] is None


def test_gains_are_those_of_fixations_and_paired():
    found = rows_of(CELLS)
    assert found["fixation"]["gain"] is None
    for name, gain in (("random", 0.1), ("curvature", 0.3)):
        assert found[name]["gain"] == pytest.approx(gain)
        classes = [0, 1, 0, 1]
        same = compare_differences(np.full(4, gain), np.ones(4), INTERVALS, classes=classes)
        assert found[name]["gain_low"] == same.difference.low
        wide = same.difference_new_classes
        assert found[name]["gain_new_classes_low"] == pytest.approx(wide.low)
        assert found[name]["gain_new_classes_high"] == pytest.approx(wide.high)
        assert found[name]["p_value"] == pytest.approx(same.p_value)


def test_objects_weigh_as_in_the_mean_over_splits():
    found = rows_of(cells({"random": curve(RISE, weights=[1, 1, 1, 3])}))["random"]
    assert found["area"] == pytest.approx(0.67 + 0.01 * (0 + 1 + 2 + 9) / 6)


def test_a_strategy_on_other_objects_has_a_curve_and_no_gain():
    mixed = cells({"fixation": curve(RISE), "random": curve(RISE, objects=3)})
    found = rows_of(mixed)["random"]
    assert found["gain"] is found["p_value"] is None
    assert found["objects"] == 3


def test_a_curve_that_failed_somewhere_is_left_out():
    broken = curve(RISE)
    broken[5] = Cell((), np.empty(0), np.empty(0), error="too few.")
    assert set(rows_of(cells({"fixation": curve(RISE), "random": broken}))) == {"fixation"}
    with pytest.raises(RecognitionError, match="No curve"):
        touches_needed(cells({"random": broken}), INTERVALS)


def test_the_json_has_each_curve_with_its_interval_and_the_touches_needed(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "read_cells", lambda _: CELLS)
    outputs = [str(tmp_path / "needed.parquet"), str(tmp_path / "curves.json")]
    make_touches_needed(StepInputs("touch_curves", {"blocks": []}, outputs, ExperimentParameters()))
    figures = json.loads((tmp_path / "curves.json").read_text())
    of_random = figures["curves"]["order_free"]["random"]["linear_discriminant"]["points"]
    first = condition_interval(
        CELLS[touches_name(1), "order_free", "random", "linear_discriminant"], INTERVALS
    )
    assert len(of_random) == LONGEST_SEQUENCE
    assert of_random[0] == pytest.approx([first.mean, first.low, first.high])
    needed = figures["needed"]["order_free"]["fixation"]["linear_discriminant"]
    assert needed["touches"] == 15
