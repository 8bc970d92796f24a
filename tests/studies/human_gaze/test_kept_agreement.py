"""The kept table is one of agreement, with its origin, and the page shows its means."""

import pyarrow.parquet as pq

from human_gaze.agreement_means import beside_peer, summarise
from human_gaze.section import KEPT
from human_gaze.tables import AGREEMENT
from visuohaptic.studies.keeping import read_source
from visuohaptic.tables.schema import read_table

TABLE = read_table(AGREEMENT, KEPT)


def words(value):
    return f"{value.mean:.3f} ({value.low:.3f} to {value.high:.3f})"


def test_the_kept_table_names_its_recordings_and_has_one_recording_per_object():
    assert read_source(KEPT).date == "2026-11-27"
    assert b"Universidad de Zaragoza" in pq.read_schema(KEPT).metadata[b"recordings"]
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
