"""What earlier runs made and today's parameters and objects no longer name."""

from __future__ import annotations

import os
import time
from collections.abc import Collection, Iterator
from contextlib import suppress
from pathlib import Path

from visuohaptic_workflow.keys import read_record

RECORDS = Path("results/records")
ASIDE = Path(".cache/aside")


def put_aside(named: Collection[str]) -> Iterator[str]:
    """Move what records name, but for the files of today's jobs, to a folder beside the results, and say so in a sentence.

    A reader of a folder would meet an object's rows twice where blocks were other ones. Nothing else is touched.
    """
    stale = []
    for record in sorted(set(map(str, RECORDS.rglob("*.json"))).difference(named)):
        kept = read_record(record)
        stale += [record, *(kept["tables"] if kept else ()), *([kept["log"]] if kept else ())]
    target = ASIDE / time.strftime("%Y-%m-%d-%H%M%S")
    moved = [file for file in dict.fromkeys(stale) if file not in named and os.path.lexists(file)]
    for file in map(Path, moved):
        (target / file).parent.mkdir(parents=True, exist_ok=True)
        file.rename(target / file)
        with suppress(OSError):  # until a folder that holds something
            for folder in file.parents[:-2]:
                folder.rmdir()
    if moved:
        yield f"{len(moved)} files that today's run no longer names were put into {target}."
