"""Keep a table of agreement that was measured on recordings outside of this repository.

`agreement.parquet` beside this file is such a table, with its origin as metadata. To keep another table:
``python -m human_gaze.kept_agreement results/human_gaze/agreement.parquet COMMAND SOURCE``.
"""

from __future__ import annotations

import json
import sys
from datetime import UTC, datetime
from pathlib import Path

import pyarrow.parquet as pq

from human_gaze.agreement import AGREEMENT
from visuohaptic.tables.schema import read_table

KEPT = Path(__file__).with_name("agreement.parquet")


def keep(path: str | Path, command: str, source: str, kept: str | Path = KEPT) -> None:
    """Write the table at `path` to `kept`, with the date, the command and the source of the recordings as metadata."""
    table = read_table(AGREEMENT, path)
    date = datetime.now(UTC).date().isoformat()
    origin = json.dumps({"date": date, "command": command, "source": source})
    metadata = {**(table.schema.metadata or {}), b"origin": origin.encode()}
    pq.write_table(table.replace_schema_metadata(metadata), kept, compression="zstd")


if __name__ == "__main__":
    keep(*sys.argv[1:4])
