"""Date files of the future at the present: Snakemake fails a job whose outputs are older than an input."""

from __future__ import annotations

import os
import time
from collections.abc import Iterable
from pathlib import Path

from visuohaptic.base.errors import VisuohapticError
from visuohaptic_workflow.digests import TIMESTAMP


class ClockError(VisuohapticError):
    """A file has a modification time in the future, and this user may not change the time."""


def date_at_present(files: Iterable[str]) -> list[str]:
    """Set the time of files that were modified in the future to the present time; their content stays.

    Parameters
    ----------
    files : iterable of str
        Paths of files and of output folders of Snakemake. Missing files are skipped.

    Returns
    -------
    list of str
        The files whose time was changed.

    Raises
    ------
    ClockError
        If this user may not change the time of a file.
    """
    now = time.time()
    dated = []
    for path in (path for file in files for path in (Path(file), Path(file, TIMESTAMP))):
        if not path.exists() or path.stat().st_mtime <= now:
            continue
        try:
            os.utime(path, (now, now))
        except OSError as error:
            raise ClockError(
                f"{path} was modified in the future, {time.ctime(path.stat().st_mtime)}, and its time can't be changed "
                f"({error.strerror}); give the file a time in the past with `touch`."
            ) from error
        dated.append(str(path))
    return dated
