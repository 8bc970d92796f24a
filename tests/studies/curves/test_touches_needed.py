"""Areas, touches needed and what fixations gain, over objects."""

import json

import numpy as np
import pytest

from visuohaptic.errors import RecognitionError
from visuohaptic.recognition.intervals import object_interval
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.seeds import spawn_generator
from visuohaptic.studies.curves.touches_needed import ObjectCurves, make_touches_needed, sum_curves
from visuohaptic.tables.schema import build_table, read_table, write_table
from visuohaptic.tables.studies import CURVES, TOUCH_CURVES, TOUCHES_NEEDED

INTERVALS = IntervalParameters(bootstrap_samples=200)
COUNTS = (1, 2, 4)
KEYS = {"pipeline": "best", "classifier": "support_vector_machine"}


def curves(accuracy, counts=COUNTS, objects=4):
    """Rows by strategy: accuracy of object k after each count, plus 0.01 k."""
    rows = [
        (strategy, count, f"class{number % 2}", f"object{number}", min(mean + 0.01 * number, 1.0))
        for strategy, means in accuracy.items()
        for count, mean in zip(counts, means, strict=True)
        for number in range(objects)
    ]
    names = ("strategy", "touches", "class", "object", "accuracy")
    columns = {name: [row[place] for row in rows] for place, name in enumerate(names)}
    return build_table(CURVES, {**KEYS, **columns, "weight": np.ones(len(rows))})


TABLE = curves(
    {"fixation": (0.5, 0.7, 0.9), "random": (0.6, 0.8, 0.91), "curvature": (0.3, 0.5, 0.6)}
)


def rows_of(table):
    return {row["strategy"]: row for row in table.to_pylist()}


def test_the_area_is_that_of_the_mean_curve():
    found = rows_of(sum_curves(TABLE, INTERVALS, 1)[1])
    # Trapezoids over 1 to 2 and 2 to 4 touches, and 0.015 for the objects' offsets.
    assert found["fixation"]["area"] == pytest.approx((0.6 + 2 * 0.8) / 3 + 0.015)
    assert (
        found["fixation"]["area_low"] < found["fixation"]["area"] < found["fixation"]["area_high"]
    )


def test_touches_needed_are_told_or_missing():
    found = rows_of(sum_curves(TABLE, INTERVALS, 1)[1])
    assert (found["fixation"]["touches"], found["random"]["touches"]) == (4, 4)
    assert found["curvature"]["touches"] is None
    assert found["curvature"]["most_touches"] == 4


def test_gains_are_those_of_fixations_and_paired():
    found = rows_of(sum_curves(TABLE, INTERVALS, 1)[1])
    assert found["fixation"]["gain"] is None
    areas = {name: row["area"] for name, row in found.items()}
    for name in ("random", "curvature"):
        assert found[name]["gain"] == pytest.approx(areas["fixation"] - areas[name])
        # Every object has the same difference, so pairing leaves no spread.
        assert found[name]["gain_high"] - found[name]["gain_low"] < 1e-9
        assert found[name]["p_value"] == pytest.approx(2 / 2**4)


def test_points_have_the_interval_over_objects():
    points = sum_curves(TABLE, INTERVALS, 1)[0].to_pylist()
    row = next(row for row in points if row["strategy"] == "random" and row["touches"] == 2)
    generator = spawn_generator(1, "curves", "best", "random", "support_vector_machine", 2)
    expected = object_interval(0.8 + 0.01 * np.arange(4), np.ones(4), INTERVALS, generator)
    assert (row["accuracy"], row["low"], row["high"]) == pytest.approx(
        (expected.mean, expected.low, expected.high)
    )


def test_objects_weigh_as_in_the_mean_over_splits():
    place = TABLE.schema.get_field_index("weight")
    weights = [3.0 if name == "object3" else 1.0 for name in TABLE.column("object").to_pylist()]
    weighted = TABLE.set_column(place, TABLE.schema.field("weight"), [weights])
    row = sum_curves(weighted, INTERVALS, 1)[0].to_pylist()[0]
    assert row["accuracy"] == pytest.approx(0.3 + 0.01 * (0 + 1 + 2 + 9) / 6)


def test_a_curve_of_one_point_is_its_own_area():
    one = ObjectCurves(curves({"fixation": (0.5,)}, counts=(3,)))
    np.testing.assert_allclose(np.sort(one.areas), 0.5 + 0.01 * np.arange(4))


def test_strategies_on_other_objects_are_refused():
    import pyarrow as pa

    mixed = pa.concat_tables(
        [curves({"fixation": (0.5, 0.6, 0.7)}), curves({"random": (0.5, 0.6, 0.7)}, objects=3)]
    )
    with pytest.raises(RecognitionError, match="same objects"):
        sum_curves(mixed, INTERVALS, 1)


def test_a_missing_point_is_refused():
    with pytest.raises(RecognitionError, match="needs a point"):
        sum_curves(TABLE.slice(1), INTERVALS, 1)


def test_tables_and_figures_hold_the_same_numbers(tmp_path):
    write_table(CURVES, TABLE, tmp_path / "curves.parquet")
    files = {name: tmp_path / name for name in ("points", "needed", "figures")}
    make_touches_needed([tmp_path / "curves.parquet"], **files, intervals=INTERVALS, seed=1)
    figures = json.loads(files["figures"].read_text())["best"]["random"]["support_vector_machine"]
    needed = rows_of(read_table(TOUCHES_NEEDED, files["needed"]))["random"]
    assert figures["area"] == pytest.approx(needed["area"], rel=1e-5)
    points = read_table(TOUCH_CURVES, files["points"]).to_pylist()
    expected = [row["accuracy"] for row in points if row["strategy"] == "random"]
    assert [point["accuracy"] for point in figures["curve"]] == pytest.approx(expected, rel=1e-5)
