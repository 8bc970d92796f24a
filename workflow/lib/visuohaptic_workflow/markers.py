"""What makes Snakemake run a job whose record does not fit, and say why: an input that is newer than the record."""

from __future__ import annotations

import os
import shutil
import stat
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from visuohaptic.base.atomic_files import atomic_file
from visuohaptic_workflow.keys import NEW
from visuohaptic_workflow.one_run import not_writable

FOLDER = Path("logs/why")

_OF_A_RECORD = 946684800  # 2000-01-01; 1970 breaks ZIP and FAT
_OF_A_MARKER = _OF_A_RECORD + 86400  # of a time to come Snakemake would say that a clock is wrong


def mark_stale(record: str, reason: str, tables: Iterable[str] = ()) -> list[str]:
    """Make a record older than all inputs of its job, and return a folder that is named after the reason.

    The marker is a folder: Snakemake remembers the content of a small file, and would skip it the second time. A missing
    record is replaced by an empty one: otherwise Snakemake would take tables that lie there, such as copied ones, for
    results of the job. Write-protected `tables`, hard links to the cache of DVC, become writable copies: Snakemake does
    not replace protected files. A new job needs no marker: nothing is changed, and no folder returned. Raises
    `FolderError` if this user may not write here.
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
        with atomic_file(path) as copy:
            copy.write_bytes(path.read_bytes() if path.exists() else b"{}\n")
            os.utime(copy, (_OF_A_RECORD, _OF_A_RECORD))
        for table in filter(_is_protected, map(Path, tables)):
            with atomic_file(table) as copy:
                shutil.copyfile(table, copy)
    except PermissionError:
        raise not_writable("permission denied") from None
    return [str(marker)]


def _is_protected(file: Path) -> bool:
    is_own_file = file.is_file() and not file.is_symlink()
    return is_own_file and not file.stat().st_mode & stat.S_IWUSR
