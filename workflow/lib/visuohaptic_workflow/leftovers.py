"""What earlier runs made and today's parameters and objects no longer name."""

from __future__ import annotations

import time
from collections.abc import Collection
from contextlib import suppress
from pathlib import Path

from visuohaptic_workflow.keys import read_record

RECORDS = Path("results/records")
ASIDE = Path(".cache/aside")


def put_aside(named: Collection[str]) -> str | None:
    """Move what records name, but for the files of today's jobs, to a folder beside the results, and say so in a sentence.

    A reader of a folder would meet an object's rows twice where blocks were other ones. Nothing else is touched.
    """
    wanted = set(named)
    stale = []
    for record in sorted(RECORDS.rglob("*.json")):
        if str(record) not in wanted:
            stale += [record, *(file for file in _files_of(record) if str(file) not in wanted)]
    target = ASIDE / time.strftime("%Y-%m-%d-%H%M%S")
    moved = 0
    for file in stale:
        with suppress(FileNotFoundError):
            (target / file).parent.mkdir(parents=True, exist_ok=True)
            file.rename(target / file)
            moved += 1
            _remove_empty(file.parent)
    return (
        f"{moved} files that today's run no longer names were put into {target}." if moved else None
    )


def _files_of(record: Path) -> list[Path]:
    kept = read_record(record)
    return [Path(file) for file in (*kept["tables"], kept["log"])] if kept else []


def _remove_empty(folder: Path) -> None:
    with suppress(OSError):
        while len(folder.parts) > 1:
            folder.rmdir()
            folder = folder.parent
