"""The report's sentence on people's gaze is that of the table that the workflow hands it."""

import json

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from visuohaptic.base.errors import ReportError
from visuohaptic.report.gaze import gaze_sentence

ROWS = [
    {"object": one, "predictor": predictor, "part": part, "correlation": correlation}
    for predictor, equal in (("equal", 0.1), ("chosen", 0.5), ("facing", 0.9))
    for one, part, correlation in (
        ("cow", "training", equal),
        ("cup", "training", equal + 0.2),
        ("new", "test", 1.0),
    )
]


def written(folder, rows, metadata=None):
    table = pa.Table.from_pylist(rows).replace_schema_metadata(metadata)
    pq.write_table(table, folder / "agreement.parquet")
    return folder / "agreement.parquet"


def test_means_are_those_of_the_objects_held_out(tmp_path):
    found = gaze_sentence(written(tmp_path, ROWS, {"origin": json.dumps({"date": "2026-01-02"})}))
    assert "on 2 objects with recorded gaze (measured on 2026-01-02, not in this run)" in found
    assert "is 0.20 (" in found
    assert "fitted to other objects it is 0.60 (" in found


def test_without_a_table_there_is_no_sentence_and_another_table_is_refused(tmp_path):
    assert gaze_sentence(None) == ""
    (tmp_path / "text.parquet").write_text("no table")
    for path in (tmp_path / "text.parquet", written(tmp_path, ROWS)):
        with pytest.raises(
            ReportError,
            match=rf"{path.name} holds no table of agreement with gaze .*; `git checkout .* restores",
        ):
            gaze_sentence(path)
