"""The kept table is one of agreement, with its origin, and the page shows its means."""

import json

import pyarrow.parquet as pq

from human_gaze.agreement import AGREEMENT
from human_gaze.agreement_means import beside_peer, summarise
from human_gaze.kept_agreement import KEPT, keep
from visuohaptic.tables.schema import read_table

TABLE = read_table(AGREEMENT, KEPT)


def words(value):
    return f"{value.mean:.3f} ({value.low:.3f} to {value.high:.3f})"


def test_the_kept_table_has_an_origin_and_one_recording_per_object():
    origin = json.loads(pq.read_schema(KEPT).metadata[b"origin"])
    assert set(origin) == {"date", "command", "source"}
    digests, objects = (set(TABLE.column(name).to_pylist()) for name in ("digest", "object"))
    assert len(digests) == len(objects) == 58


def test_the_tables_of_the_page_are_those_of_the_kept_table():
    page = KEPT.with_name("README.md").read_text()
    held = {row.predictor.name: row for row in summarise(TABLE, "training")}
    shown = [row for name, row in held.items() if name != "curvature"]
    shown += [
        row
        for row in beside_peer(TABLE)
        if row.predictor.name in ("peer", "chosen", "place", "equal")
    ]
    for row in shown:
        for measure in ("correlation", "auc_top"):
            assert words(row.measures[measure]) in page, (row.predictor.name, measure)


def test_another_table_is_kept_with_its_command_and_source(tmp_path):
    keep(KEPT, "make gaze", "people", tmp_path / "kept.parquet")
    assert read_table(AGREEMENT, tmp_path / "kept.parquet").equals(TABLE)
    origin = json.loads(pq.read_schema(tmp_path / "kept.parquet").metadata[b"origin"])
    assert (origin["command"], origin["source"]) == ("make gaze", "people")
