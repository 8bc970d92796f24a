"""A stored frontier is what was measured, with where it comes from."""

import json

import pytest
from studies.cost.test_front import cost_table

from visuohaptic.studies.cost.stored import StoredFrontier, store_frontier
from visuohaptic.tables.schema import write_table
from visuohaptic.tables.studies import COST


def test_a_stored_frontier_has_the_tables_rows_and_says_where_they_come_from(tmp_path):
    table = cost_table([("1 touch", 0.01, 0.4), ("5 touches", 0.1, 0.02)], failed=["8 × 8"])
    write_table(COST, table, tmp_path / "frontier.parquet")
    store_frontier(
        tmp_path / "frontier.parquet", tmp_path / "kept.json", "snakemake", "a processor"
    )
    kept = StoredFrontier(**json.loads((tmp_path / "kept.json").read_text()))
    assert (kept.objects, kept.command, kept.machine) == (12, "snakemake", "a processor")
    assert len(kept.date) == len("2000-01-01")
    for found, row in zip(kept.rows, table.to_pylist(), strict=True):
        assert {name: found[name] for name in ("setting", "on_front", "failed")} == {
            name: row[name] for name in ("setting", "on_front", "failed")
        }
        assert found["error"] == pytest.approx(row["error"])
