"""What the table of a run's guards says."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import pyarrow as pa

from visuohaptic.errors import GuardError
from visuohaptic.guards.verdicts import Verdict
from visuohaptic.tables.guards import GUARDS
from visuohaptic.tables.schema import build_rows, read_table


def table_of(verdicts: Sequence[Verdict]) -> pa.Table:
    """Give verdicts as rows of `tables.GUARDS`."""
    return build_rows(GUARDS, [asdict(verdict) for verdict in verdicts])


def failed_guards(path: str | Path) -> list[str]:
    """Name the guards that failed, in a sentence each."""
    return [
        f"{row['guard']}: failed. {row['found']}"
        for row in read_table(GUARDS, [path]).to_pylist()
        if row["outcome"] == "failed"
    ]


def require_guards(path: str | Path, report: str | Path) -> None:
    """Raise `GuardError` if a guard of the run failed."""
    failed = failed_guards(path)
    if failed:
        raise GuardError(
            f"The run's figures can't be trusted, as {report} says, too: {' '.join(failed)}"
        )
