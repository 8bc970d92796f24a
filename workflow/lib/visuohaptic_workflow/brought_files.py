"""Files that something else than this folder's Snakemake has put there, such as `dvc pull`.

Snakemake judges a file by what it remembers of making it, and by times. Of a file that was brought
it remembers nothing, or something of the file that was there before; and times say nothing. Such
files are judged by their records instead, each time the workflow starts: those that are what the
rules would make now are kept, the others are made again.
"""

from __future__ import annotations

import json
import os
import shutil
import stat
import time
from base64 import urlsafe_b64encode
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from visuohaptic_workflow.plan import PlannedJob
from visuohaptic_workflow.records import TIMESTAMP, is_current

METADATA = Path(".snakemake/metadata")
_DATABASE = METADATA.with_suffix(".db")  # another place for the same, which is not edited here

_CLOCK_SECONDS = 0.01  # the kernel's clock of files lags behind the one of programs
_OUT_OF_DATE = (1, 1)  # older than all inputs; 0 would mean to Snakemake that there is no time


def judge_brought_files(jobs: Sequence[PlannedJob]) -> list[PlannedJob]:
    """Make Snakemake see brought files as what they are: current or out of date.

    No file is deleted unless it is a link (whose content lies in DVC's cache) or Snakemake's memory can't be corrected.
    Where a link leads to a file of another user, whose times can't be set, a copy takes its place.

    Parameters
    ----------
    jobs : sequence of PlannedJob
        All jobs, in the order in which data flows.

    Returns
    -------
    list of PlannedJob
        Jobs whose files are out of date, and will be made again.
    """
    origins: dict[str, bool] = {}
    made_elsewhere = {file for job in jobs for file in job.outputs}

    def is_made_here(file: str) -> bool:
        if file not in origins:
            origins[file] = _is_made_here(file)
        return origins[file]

    outdated = []
    for job in jobs:
        outputs = [file for file in job.outputs if os.path.lexists(file)]
        if not outputs:  # its inputs would take long to list
            continue
        inputs = [file for file in job.inputs if file in made_elsewhere and Path(file).exists()]
        foreign = [file for file in outputs if not is_made_here(file)]
        if not foreign and all(map(is_made_here, inputs)):
            continue
        if is_current(job):
            if foreign:
                _keep(job, outputs)
        else:
            outdated.append(job)
            for file in outputs:
                _mark_outdated(file)
    return outdated


def _is_made_here(file: str) -> bool:
    """Whether this folder's Snakemake has written a file as it is now."""
    try:
        parts = [os.lstat(part) for part in _files_in(file)]
        record = json.loads(_metadata_of(file).read_text(encoding="utf-8"))
        first, last = float(record["starttime"]), float(record["endtime"])
    except (OSError, ValueError, KeyError, TypeError):
        return False
    # A hard or symbolic link leads to DVC's cache, and has the cache's time.
    return all(
        not stat.S_ISLNK(part.st_mode)
        and (part.st_nlink == 1 or stat.S_ISDIR(part.st_mode))
        and first - _CLOCK_SECONDS <= part.st_mtime <= last + _CLOCK_SECONDS
        for part in parts
    )


def _files_in(file: str) -> list[Path]:
    """Give a file, or a folder and what is in it but Snakemake's own."""
    path = Path(file)
    if path.is_symlink() or not path.is_dir():
        return [path]
    return [path] + [part for part in path.iterdir() if part.name != TIMESTAMP]


def _with_time(file: str) -> str:
    """Give the file whose time is a file's; a folder's is that of an empty file in it."""
    if not Path(file).is_dir():
        return file
    timestamp = Path(file, TIMESTAMP)
    if not timestamp.exists():
        timestamp.touch()
    return str(timestamp)


def _metadata_of(file: str) -> Path:
    """Give the file in which Snakemake keeps what it remembers of another one."""
    name = urlsafe_b64encode(file.encode()).decode()
    longest = os.pathconf(".", "PC_NAME_MAX") - 1
    pieces = [name[start : start + longest] for start in range(0, len(name), longest)]
    return METADATA.joinpath(*(f"@{piece}" for piece in pieces[:-1]), pieces[-1])


def _keep(job: PlannedJob, outputs: Sequence[str]) -> None:
    """Let the outputs be newer than all inputs, with no memory of what was there before them."""
    for file in outputs:
        _metadata_of(file).unlink(missing_ok=True)
    newest = max((max(_times(file)) for file in [*job.inputs, *job.code]), default=0)
    if min(min(_times(file)) for file in outputs) < newest:
        now = time.time_ns()
        for file in map(_with_time, outputs):
            try:
                os.utime(file, ns=(now, now))
            except PermissionError:
                _replace_by_copy(file)
            else:
                os.utime(file, ns=(now, now), follow_symlinks=False)


def _replace_by_copy(file: str) -> None:
    """Put a file of one's own, with the time of now, in the place of a link to another user's."""
    copy = f"{file}.part"
    shutil.copyfile(file, copy)
    Path(copy).replace(file)


def _times(file: str) -> tuple[int, int]:
    """Give the times of a file and of the link that leads to it, in ns; Snakemake looks at both."""
    path = Path(_with_time(file))
    return path.stat().st_mtime_ns, path.lstat().st_mtime_ns


def _mark_outdated(file: str) -> None:
    """Let a file be older than its inputs, with no memory of how it was made."""
    with suppress(FileNotFoundError):
        if Path(file).is_symlink() or _DATABASE.exists():
            Path(file).unlink()
            return
        _metadata_of(file).unlink(missing_ok=True)
        timed = _with_time(file)
        try:
            os.utime(timed, _OUT_OF_DATE)
        except PermissionError:  # a hard link to another user's file
            Path(timed).unlink()
