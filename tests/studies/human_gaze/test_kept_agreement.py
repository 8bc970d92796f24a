"""The kept table is one of agreement, with its origin, and the page shows its means."""

import re

import numpy as np
import pyarrow.parquet as pq

from human_gaze.agreement_means import beside_peer, summarise
from human_gaze.section import KEPT
from human_gaze.tables import AGREEMENT
from visuohaptic.evaluation.intervals import compare_differences
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.studies.keeping import read_source
from visuohaptic.tables.schema import read_table

TABLE = read_table(AGREEMENT, KEPT)


def words(value):
    return f"{value.mean:.3f} ({value.low:.3f} to {value.high:.3f})"


def written(value):
    """Return an interval with the minus sign of prose."""
    return words(value).replace("-", "\N{MINUS SIGN}")


def test_the_kept_table_names_its_recordings_and_has_one_recording_per_object():
    assert read_source(KEPT).date == "2026-11-27"
    assert b"Universidad de Zaragoza" in pq.read_schema(KEPT).metadata[b"recordings"]
    digests, objects = (set(TABLE.column(name).to_pylist()) for name in ("digest", "object"))
    assert len(digests) == len(objects) == 58


def test_the_numbers_of_the_page_are_those_of_the_kept_table():
    page = " ".join(KEPT.with_name("README.md").read_text().split())
    held = {row.predictor.label: row for row in summarise(TABLE, "training")}
    lines = re.findall(r"\| ([^|]+) \| \**(\d[^|*]+)\** \| \**(\d[^|*]+)\** \|", page)
    assert len(lines) == 7
    for label, correlation, area in lines:
        measures = held[label].measures
        assert (correlation, area) == (words(measures["correlation"]), words(measures["auc_top"]))
    peers = {row.predictor.name: row for row in beside_peer(TABLE)}
    for name in ("peer", "chosen"):
        assert words(peers[name].measures["correlation"]) in page
    assert written(peers["chosen"].gain) in page
    tests = {row.predictor.name: row for row in summarise(TABLE, "test")}
    assert written(tests["chosen"].measures["correlation"]) in page


def test_the_leads_of_the_page_are_paired_over_objects():
    page = " ".join(KEPT.with_name("README.md").read_text().split())
    rows = TABLE.to_pandas()
    rows = rows[rows["part"] == "training"].pivot(
        index="object", columns="predictor", values="correlation"
    )
    for name in ("facing", "place"):
        differences = (rows["chosen"] - rows[name]).to_numpy()
        lead = compare_differences(differences, np.ones(54), IntervalParameters(), (-2.0, 2.0))
        assert f"by {words(lead.difference)}" in page
