"""Two runs are the same if their tables are, whatever the order of rows and the time; else the report shows where."""

import gzip
import io
import json

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from golden import golden_tables, keeping, run_tables
from PIL import Image

COLUMNS = {
    "class": ["x", "x", "x"],
    "object": ["b", "a", "c"],
    "viewpoint": [0, 0, 0],
    "strategy": ["fixation"] * 3,
    "touch": [0, 0, 0],
    "sensor_size": [0.25, 0.5, 1.0],
    "contact_state": ["full", "shrunk", "full"],
    "image": pa.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]], pa.list_(pa.float32())),
    "seconds": [1.0, 2.0, 3.0],
}


def write(folder, name="touches", schema="touches", **columns):
    path = folder / "results" / name / "part.parquet"
    path.parent.mkdir(parents=True, exist_ok=True)
    table = pa.table(COLUMNS | columns).replace_schema_metadata({"table": schema})
    pq.write_table(table, path)
    return run_tables.read_run(folder)


def differing(kept, found):
    lines = golden_tables.differences(golden_tables.kept_of(kept), found)
    return "\n".join(line for said in lines.values() for line in said)


def test_order_of_rows_and_seconds_are_no_difference(tmp_path):
    kept = write(tmp_path / "one")
    found = write(
        tmp_path / "two",
        object=["a", "b", "c"],
        sensor_size=[0.5, 0.25, 1.0],
        contact_state=["shrunk", "full", "full"],
        image=pa.array([[3.0, 4.0], [1.0, 2.0], [5.0, 6.0]], pa.list_(pa.float32())),
        seconds=[9.0, 8.0, 7.0],
    )
    assert differing(kept, found) == ""


def test_the_report_names_rows_both_values_and_the_largest_difference(tmp_path):
    kept = write(tmp_path / "one")
    found = write(
        tmp_path / "two",
        sensor_size=[0.25, 0.75, 0.875],
        contact_state=["full", "shrunk", "blocked"],
    )
    row = "class x, object {}, viewpoint 0, strategy fixation, touch 0"
    assert differing(kept, found).splitlines() == [
        "touches.sensor_size: 2 of 3 rows differ, by at most 0.25",
        f"    {row.format('a')}: kept 0.5, found 0.75",
        f"    {row.format('c')}: kept 1.0, found 0.875",
        "touches.contact_state: 1 of 3 rows differ",
        f"    {row.format('c')}: kept 'full', found 'blocked'",
    ]


def test_of_many_columns_the_first_are_shown_and_the_others_named(tmp_path):
    names = [f"contourlet_{number:02d}" for number in range(1, 8)]
    kept = write(tmp_path / "one", **{key: [0.1, 0.2, 0.3] for key in names})
    found = write(tmp_path / "two", **{key: [0.1, 0.2, 0.4] for key in names})
    lines = differing(kept, found).splitlines()
    assert [line.partition(":")[0] for line in lines[::2]] == [
        *(f"touches.{name}" for name in names[:4]),
        "touches",
    ]
    assert lines[-1] == f"touches: 3 more columns differ: {', '.join(names[4:])}"


def test_a_difference_of_one_bit_and_a_missing_value_are_differences(tmp_path):
    kept = write(tmp_path / "one")
    for value in (1.0 - 2**-53, None):
        found = write(tmp_path / "two", sensor_size=[0.25, 0.5, value])
        assert "sensor_size: 1 of 3 rows differ" in differing(kept, found)


def test_an_array_that_differs_is_shown_by_its_mean_and_standard_deviation(tmp_path):
    kept = write(tmp_path / "one")
    image = pa.array([[1.0, 4.0], [3.0, 4.0], [5.0, 6.0]], pa.list_(pa.float32()))
    said = differing(kept, write(tmp_path / "two", image=image))
    assert "image digest: 1 of 3 rows differ, their means by at most 1" in said
    assert (
        "object b, viewpoint 0, strategy fixation, touch 0: kept mean 1.5, found 2.5; deviation 0.5, found 1.5"
        in said
    )
    swapped = pa.array([[2.0, 1.0], [3.0, 4.0], [5.0, 6.0]], pa.list_(pa.float32()))
    assert "image digest: 1 of 3 rows differ" in differing(
        kept, write(tmp_path / "two", image=swapped)
    )


def test_pictures_differ_by_their_pixels_and_not_by_their_packing(tmp_path):
    def picture(level, value):
        stream = io.BytesIO()
        Image.fromarray(np.full((4, 4), value, np.uint8)).save(stream, "PNG", compress_level=level)
        return stream.getvalue()

    kept = write(tmp_path / "one", view=[picture(1, 7)] * 3)
    assert picture(1, 7) != picture(0, 7)
    assert differing(kept, write(tmp_path / "two", view=[picture(0, 7)] * 3)) == ""
    assert "view digest: 3 of 3" in differing(
        kept, write(tmp_path / "two", view=[picture(1, 8)] * 3)
    )


def test_maps_of_pictures_are_compared_by_their_keys(tmp_path):
    def maps(colour):
        rows = [[("colour", colour), ("edge", b"1")], [("edge", b"2")], []]
        return pa.array(rows, pa.map_(pa.string(), pa.binary()))

    kept = write(tmp_path / "one", conspicuity=maps(b"3"))
    said = differing(kept, write(tmp_path / "two", conspicuity=maps(b"4")))
    assert "conspicuity_colour digest: 1 of 3 rows differ" in said
    assert "edge" not in said


def test_rows_and_columns_and_tables_of_one_run_only_are_differences(tmp_path):
    kept = write(tmp_path / "one", chance=["a", "b", "c"])
    write(tmp_path / "two", "scores")
    found = write(tmp_path / "two", viewpoint=[0, 1, 0])
    said = differing(kept, found)
    assert "scores: is in this run and not kept" in said
    assert "touches.chance: is kept and not in this run" in said
    row = "    class x, object a, viewpoint {}, strategy fixation, touch 0"
    assert f"touches: 1 rows are only kept\n{row.format(0)}" in said
    assert f"touches: 1 rows are only found\n{row.format(1)}" in said


@pytest.mark.parametrize(
    ("schema", "column", "allowed"),
    [
        ("touches", "probability", 1e-11),
        ("features", "imprint_mean", 1e-12),
        ("touches", "penetration", 0),
    ],
)
def test_only_documented_columns_have_a_tolerance(schema, column, allowed, tmp_path):
    kept = write(tmp_path / "one", schema, schema, **{column: [0.5, 0.5, 0.5]})
    for moved, equal in ((0.5 * allowed, True), (2 * allowed or 2**-53, False)):
        values = [0.5, 0.5, 0.5 + moved]
        found = write(tmp_path / f"two {moved}", schema, schema, **{column: values})
        assert (differing(kept, found) == "") is equal


def test_a_simplified_model_is_compared_by_its_vertices_to_a_tolerance(tmp_path):
    def packed(shift):
        vertices = np.array([[0.0, 0.5, 0.25], [shift, 0.0, 0.0]]) * run_tables.COORDINATE_STEPS
        rows = gzip.compress(np.rint(vertices).astype("<i2").tobytes() + b"corners")
        return {"model": [rows] * 3, "vertices": pa.array([2] * 3, pa.int32())}

    kept = write(tmp_path / "one", "pictures", "pictures", **packed(0.5))
    for shift, equal in ((0.501, True), (0.6, False)):
        found = write(tmp_path / f"two {shift}", "pictures", "pictures", **packed(shift))
        assert (differing(kept, found) == "") is equal


def test_metrics_are_compared_by_name_without_parameters_and_words(tmp_path):
    runs = []
    for folder, accuracy in (("one", 0.5), ("two", 0.625)):
        (tmp_path / folder / "reports").mkdir(parents=True)
        held = {
            "parameters": {"seed": accuracy},
            "method": {"accuracy": folder},
            "results": {"paper": {"accuracy": {"mean": accuracy, "low": None}, "notes": []}},
        }
        (tmp_path / folder / "reports/metrics.json").write_text(json.dumps(held))
        runs.append(write(tmp_path / folder))
    assert differing(*runs).splitlines() == [
        "reports/metrics.number: 1 of 3 rows differ, by at most 0.125",
        "    figure results.paper.accuracy.mean: kept 0.5, found 0.625",
    ]


def kept_run(tables, folder, values_of=("touches", "reports/metrics"), *, single=False):
    golden_tables.write_kept(tables, folder, values_of, single=single)
    return golden_tables.read_kept(folder, single=single)


def lines_of(kept, found):
    return [line for said in golden_tables.differences(kept, found).values() for line in said]


def test_a_kept_run_gives_back_every_value(tmp_path):
    tables = write(tmp_path / "one", sensor_size=[0.1, None, 1 / 3])
    kept = kept_run(tables, tmp_path / "kept")
    assert kept.tables["touches"].equals(tables["touches"])
    assert lines_of(kept, tables) == []
    found = write(tmp_path / "one", sensor_size=[0.1, None, 1 / 3 + 2**-54])
    assert "by at most 5.55112e-17" in lines_of(kept, found)[0]


def test_single_precision_keeps_rows_and_digests_find_what_is_smaller(tmp_path):
    tables = write(tmp_path / "one", sensor_size=[0.1, 0.2, 1 / 3])
    kept = kept_run(tables, tmp_path / "kept", single=True)
    assert lines_of(kept, tables) == []
    found = write(tmp_path / "one", sensor_size=[0.1, 0.2, 0.34])
    assert lines_of(kept, found)[1].endswith("touch 0: kept 0.33333334, found 0.34")
    found = write(tmp_path / "one", sensor_size=[0.1, 0.2, 1 / 3 + 1e-12])
    (line,) = lines_of(kept, found)
    assert line.startswith("touches.sensor_size: 3 rows, now 3; mean 0.211111, now 0.211111111;")
    assert line.endswith("no row differs in the digits that are kept")


@pytest.mark.parametrize("values_of", [(), ("touches",)])
def test_a_tolerance_holds_for_values_in_single_precision_and_for_figures_alone(
    values_of, tmp_path
):
    tables = write(tmp_path / "one", probability=[0.1, 0.2, 1 / 3])
    kept = kept_run(tables, tmp_path / "kept", values_of, single=True)
    assert lines_of(kept, write(tmp_path / "one", probability=[0.1, 0.2, 1 / 3 + 1e-11])) == []
    found = write(tmp_path / "one", probability=[0.1, 0.2, 1 / 3 + 1e-9])
    assert "touches.probability: 3 rows, now 3; mean 0.211111111" in lines_of(kept, found)[0]


def test_two_runs_are_compared_by_their_folders(tmp_path, capsys):
    write(tmp_path / "one")
    write(tmp_path / "two", sensor_size=[0.25, 0.5, 2.0])
    one, two = str(tmp_path / "one"), str(tmp_path / "two")
    assert golden_tables.main(one, one) == 0
    assert golden_tables.main(two, one) == 1
    assert "kept 1.0, found 2.0" in capsys.readouterr().out
    assert golden_tables.main(str(tmp_path / "none"), one) == 1
    assert golden_tables.main(str(tmp_path / "none"), str(tmp_path / "none")) == 1


def test_a_run_is_kept_in_place_of_the_former_and_compared(tmp_path, monkeypatch):
    monkeypatch.setattr(keeping, "KEPT", tmp_path / "kept")
    cell = {"accuracy": {"mean": 0.75}, "object_accuracy": {"mean": 0.5}}
    held = {
        "results": {"paper": {"fixation": {"tree": cell}, "random": {"tree": cell}}},
        "comparisons": {
            "paper": {"tree": {"random": {"difference": {"mean": -0.125}, "p_value": 0.03125}}}
        },
    }
    (tmp_path / "run/reports").mkdir(parents=True)
    (tmp_path / "run/reports/metrics.json").write_text(json.dumps(held))
    write(tmp_path / "run", "scores")
    keeping.keep("default_run", write(tmp_path / "run", sensor_size=[0.25, 0.5, 2.0]))
    (tmp_path / "run/results/scores/part.parquet").unlink()
    tables = write(tmp_path / "run")
    assert "sensor_size: 1 of 3" in keeping.compare_with_kept("default_run", tables)
    keeping.keep("default_run", tables)
    assert keeping.compare_with_kept("default_run", tables) == ""
    assert not (tmp_path / "kept/default_run/scores.parquet").exists()
    assert (tmp_path / "kept/default_run/accuracies.csv").read_text().splitlines() == [
        "pipeline,classifier,strategy,accuracy,by_vote,lead,p_value",
        "paper,tree,fixation,75.00,50.00,,",
        "paper,tree,random,75.00,50.00,-12.50,0.0312",
    ]


def test_what_is_kept_is_small():
    assert sum(file.stat().st_size for file in keeping.KEPT.rglob("*.*")) < 2_000_000
