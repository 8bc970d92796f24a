"""Kept tables for tests."""

from dataclasses import asdict
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from visuohaptic.studies.keeping import Source, kept_file


def write_kept(
    table: pa.Table, folder: Path, name: str, commit: str = "0", date: str = "2026-11-28"
) -> Path:
    """Write a kept table of a set with a given commit and date."""
    path = kept_file(folder, name)
    pq.write_table(table.replace_schema_metadata(asdict(Source(name, commit, date))), path)
    return path
