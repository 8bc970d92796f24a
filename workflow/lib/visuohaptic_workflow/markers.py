"""What makes Snakemake run a job whose record does not fit, and say why: an input that is newer than the record."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

from visuohaptic.whole_files import whole_file
from visuohaptic_workflow.keys import NEW
from visuohaptic_workflow.one_run import not_writable

FOLDER = Path("logs/why")

_OF_A_RECORD = 946684800  # 2000-01-01; 1970 breaks ZIP and FAT
_OF_A_MARKER = _OF_A_RECORD + 86400  # of a time to come Snakemake would say that a clock is wrong


def mark_stale(record: str, reason: str) -> list[str]:
    """Make a record older than all that its job takes, and give a folder that is named after the reason.

    A folder, as Snakemake remembers what a small file holds and would skip it the second time. Where there is no record, an
    empty one is put there: Snakemake would take tables that lie there, such as copied ones, for all of a job's files. Nothing
    is done, and no folder given, where its job is new: it runs anyway. Raises `FolderError` if this user may not write here.
    """
    if reason == NEW:
        return []
    path = Path(record)
    marker = FOLDER / reason.replace("../", "").replace("{", "(").replace("}", ")")
    try:
        marker.mkdir(parents=True, exist_ok=True)
        with suppress(PermissionError):  # another user's has that time
            os.utime(marker, (_OF_A_MARKER, _OF_A_MARKER))
        # A copy takes its place: it may be a link to DVC's cache, whose times are its own, or another user's.
        with whole_file(path) as copy:
            copy.write_bytes(path.read_bytes() if path.exists() else b"{}\n")
            os.utime(copy, (_OF_A_RECORD, _OF_A_RECORD))
    except PermissionError:
        raise not_writable("permission denied") from None
    return [str(marker)]
