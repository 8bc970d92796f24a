"""Two runs are the same if their tables are, whatever the order of rows and however long they took."""

import json

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from golden import golden_tables


def write(folder, name="scores", **columns):
    table = pa.table(
        {
            "object": ["b", "a", "c"],
            "accuracy": [0.5, None, 1.0],
            "image": pa.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]], pa.list_(pa.float32())),
            "seconds": [1.0, 2.0, 3.0],
        }
        | columns
    )
    path = folder / "results" / name / "part.parquet"
    path.parent.mkdir(parents=True, exist_ok=True)
    pq.write_table(table.replace_schema_metadata({"table": name}), path)
    return golden_tables.digest_run(folder)


def test_order_and_seconds_are_no_difference(tmp_path):
    kept = write(tmp_path / "one")
    found = write(
        tmp_path / "two",
        object=["a", "b", "c"],
        accuracy=[None, 0.5, 1.0],
        image=pa.array([[3.0, 4.0], [1.0, 2.0], [5.0, 6.0]], pa.list_(pa.float32())),
        seconds=[9.0, 8.0, 7.0],
    )
    assert golden_tables.differences(kept, found) == []


@pytest.mark.parametrize(
    ("column", "values"),
    [
        ("accuracy", [0.5, 0.0, 1.0]),
        ("accuracy", [0.5, None, 1.0 - 2**-53]),
        ("image", pa.array([[1.0], [2.0, 3.0, 4.0], [5.0, 6.0]], pa.list_(pa.float32()))),
    ],
)
def test_the_column_that_differs_is_named(tmp_path, column, values):
    kept, found = write(tmp_path / "one"), write(tmp_path / "two", **{column: values})
    assert golden_tables.differences(kept, found) == [f"scores scores: {column}"]


def test_a_missing_column_and_metrics_are_differences(tmp_path):
    for folder, accuracy in (("one", 0.5), ("two", 0.6)):
        (tmp_path / folder / "reports").mkdir(parents=True)
        text = json.dumps({"accuracy": accuracy})
        (tmp_path / folder / "reports" / "metrics.json").write_text(text)
    kept, found = write(tmp_path / "one"), write(tmp_path / "two", note=["x", "y", "z"])
    assert golden_tables.differences(kept, found) == [
        "reports/metrics.json: bytes",
        "scores scores: note",
    ]


def test_a_run_that_differs_ends_with_status_1(tmp_path, monkeypatch, capsys):
    write(tmp_path / "one")
    monkeypatch.setattr(golden_tables, "KEPT", tmp_path / "kept.json")
    assert golden_tables.main("keep", str(tmp_path / "one")) == 0
    assert golden_tables.main("compare", str(tmp_path / "one")) == 0
    write(tmp_path / "one", accuracy=[0.5, 0.25, 1.0])
    assert golden_tables.main("compare", str(tmp_path / "one")) == 1
    assert "scores scores: accuracy" in capsys.readouterr().out
    write(tmp_path / "two")
    assert golden_tables.main("compare", str(tmp_path / "one"), str(tmp_path / "two")) == 1
    assert golden_tables.main("compare", str(tmp_path / "one"), str(tmp_path / "one")) == 0
