"""Allow one run at a time in a folder, by file locks that the kernel releases when a process ends or is killed."""

from __future__ import annotations

import fcntl
import os
import sys
import time
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import IO

from visuohaptic.base.errors import FolderError

STATE = Path(".cache")
_OWNER = STATE / "run.lock"
_JOBS = STATE / "jobs.lock"
LEAST_FREE_BYTES = 10**6
"""Free space (bytes) of a disk below which no run begins, because the log and the plan of a run take about as much."""
_SECONDS_TO_WAIT = 60.0
_held: list[IO[str]] = []


def claim_folder() -> None:
    """Lock this folder for this process until it ends.

    Raises `FolderError` if another run, or jobs of a killed run, are active here.
    """
    try:
        STATE.mkdir(exist_ok=True)
        owner = _OWNER.open("a+", encoding="utf-8")
    except OSError as error:
        raise not_writable(str(error.strerror)) from error
    # A dry run may hold the lock for a moment.
    if not _lock(owner, seconds=0.5):
        owner.seek(0)
        process = owner.read().strip() or "unknown"
        raise FolderError(
            f"another run (process {process}) is active in {Path.cwd()}; wait until it has ended."
        )
    owner.truncate(0)
    owner.write(str(os.getpid()))
    owner.flush()
    _held.append(owner)
    with _JOBS.open("a", encoding="utf-8") as jobs:
        if _lock(jobs):
            return
        sys.stderr.write("Jobs of a killed run are still active; waiting until they have ended.\n")
        if not _lock(jobs, seconds=_SECONDS_TO_WAIT):
            raise FolderError(
                f"jobs of an earlier run are still active in {Path.cwd()} after "
                f"{_SECONDS_TO_WAIT:.0f} s; end them, or wait."
            )


def claim_results() -> None:
    """Make runs that start later wait until this process has ended.

    Raises `FolderError` if a run that did not start this process is active here.
    """
    hold_job_lock()
    if is_claimed_by_another() and _OWNER.read_text(encoding="utf-8").strip() != str(os.getppid()):
        raise FolderError(f"a run is active in {Path.cwd()}; wait until it has ended.")


def check_folder(*folders: Path) -> None:
    """Raise `FolderError` for a folder with a brace in its path, because Snakemake reads braces as wildcards."""
    for folder in folders:
        if {"{", "}"} & {*str(folder)}:
            raise FolderError(
                f"{folder} has a brace in its path, which Snakemake reads as a wildcard; rename or move it."
            )


def check_writable() -> None:
    """Raise `FolderError` if this user may not write into the working folder, or its disk is full or read-only."""
    disk = os.statvfs(Path.cwd())
    if not os.access(Path.cwd(), os.W_OK):
        is_read_only = disk.f_flag & os.ST_RDONLY
        raise not_writable("read-only file system" if is_read_only else "permission denied")
    # Some file systems do not tell their size. Snakemake would print a traceback for each line of its log.
    if disk.f_blocks and disk.f_bavail * disk.f_frsize < LEAST_FREE_BYTES:
        raise not_writable(f"less than {LEAST_FREE_BYTES / 1e6:g} MB of its disk are free")


def not_writable(reason: str) -> FolderError:
    """Return the error for a working folder that this user may not write to."""
    return FolderError(
        f"{Path.cwd()} can't be written ({reason}); `make why` lists the jobs that would run here. To run the "
        "workflow, choose a folder of your own: `visuohaptic new FOLDER`, or snakemake -s PATH/Snakefile -d FOLDER."
    )


@cache
def is_claimed_by_another() -> bool:
    """Return whether another run is active in this folder. Writes nothing, so a dry run may call it."""
    with suppress(OSError), _OWNER.open(encoding="utf-8") as stream:
        return not _lock(stream, shared=True)
    return False


def hold_job_lock() -> None:
    """Make later runs wait until this process has ended, even if its run is killed."""
    with suppress(OSError):
        _held.append(_JOBS.open("a", encoding="utf-8"))
        _lock(_held[-1], shared=True)


def _lock(stream: IO[str], seconds: float = 0, *, shared: bool = False) -> bool:
    """Lock a file for this process. Returns False if other processes hold the lock for that many seconds."""
    limit = time.monotonic() + seconds
    while True:
        try:
            fcntl.flock(stream, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
        except BlockingIOError:
            if time.monotonic() >= limit:
                return False
            time.sleep(0.05)
        except OSError:
            return True  # a file system without locks
        else:
            return True
