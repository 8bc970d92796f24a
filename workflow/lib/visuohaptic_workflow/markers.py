"""Make Snakemake run a stale job and print the reason: an input, named after the reason, that is newer than the record."""

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

_TIME_OF_RECORD = 946684800  # 2000-01-01; 1970 breaks ZIP and FAT
_TIME_OF_MARKER = _TIME_OF_RECORD + 86400  # Snakemake warns of times in the future


def mark_stale(record: str, reason: str, tables: Iterable[str] = ()) -> list[str]:
    """Make a record older than all inputs of its job, and make a folder that is named after the reason.

    The marker is a folder, because Snakemake compares small files by content and would skip an equal file. A missing
    record is replaced by an empty record; else Snakemake would take existing tables, such as copies, for results of the
    job.

    Parameters
    ----------
    record : str
        The record.
    reason : str
        The reason to run the job. For `keys.NEW`, no file is changed.
    tables : iterable of str
        Tables of the job. Write-protected tables, which are hard links to the cache of DVC, become writable copies,
        because Snakemake does not replace protected files.

    Returns
    -------
    list of str
        The marker, to be an input of the job; empty for a new job.

    Raises
    ------
    FolderError
        If this user may not write here.
    """
    if reason == NEW:
        return []
    path = Path(record)
    marker = FOLDER / reason.replace("../", "").replace("{", "(").replace("}", ")")
    try:
        marker.mkdir(parents=True, exist_ok=True)
        with suppress(PermissionError):  # a marker of another user already has that time
            os.utime(marker, (_TIME_OF_MARKER, _TIME_OF_MARKER))
        # Replace the record by a copy: it may belong to another user, or be a link to DVC's cache, which must not change.
        with atomic_file(path) as copy:
            copy.write_bytes(path.read_bytes() if path.exists() else b"{}\n")
            os.utime(copy, (_TIME_OF_RECORD, _TIME_OF_RECORD))
        for table in filter(_is_protected, map(Path, tables)):
            with atomic_file(table) as copy:
                shutil.copyfile(table, copy)
    except PermissionError:
        raise not_writable("permission denied") from None
    return [str(marker)]


def _is_protected(file: Path) -> bool:
    is_own_file = file.is_file() and not file.is_symlink()
    return is_own_file and not file.stat().st_mode & stat.S_IWUSR
