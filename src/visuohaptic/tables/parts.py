"""The files that make up a table."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path


def prune_parts(folder: str | Path, expected: Iterable[str | Path]) -> list[Path]:
    """Delete Parquet files that no longer belong to a table, and folders that this empties.

    Files are left over when an object goes away, or viewpoints are split into
    jobs in another way; a reader of the folder would meet their rows twice.

    Parameters
    ----------
    folder : path
        A table's folder; nothing outside it is touched.
    expected : iterable of path
        The files that make up the table.

    Returns
    -------
    list of pathlib.Path
        What was deleted.
    """
    keep = {Path(path) for path in expected}
    stale = [file for file in sorted(Path(folder).rglob("*.parquet")) if file not in keep]
    for file in stale:
        file.unlink()
    for parent in sorted({file.parent for file in stale}, reverse=True):
        if parent != Path(folder) and not any(parent.iterdir()):
            parent.rmdir()
    return stale
