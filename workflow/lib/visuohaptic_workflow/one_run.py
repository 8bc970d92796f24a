"""One run at a time in a folder, by a lock that the kernel takes back when its process ends, also where it is killed."""

from __future__ import annotations

import fcntl
import os
import sys
import time
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import IO

from visuohaptic.base.errors import VisuohapticError

STATE = Path(".cache")
_OWNER = STATE / "run.lock"
_JOBS = STATE / "jobs.lock"
_SECONDS_TO_WAIT = 60.0
_held: list[IO[str]] = []


class FolderError(VisuohapticError):
    """A run can't work in a folder: another run does, or its path or permissions do not allow it."""


def claim_folder() -> None:
    """Let this process be the only one that makes results in this folder, until it ends.

    Raises `FolderError` if another run, or the jobs of one that was killed, are at work here.
    """
    try:
        STATE.mkdir(exist_ok=True)
        owner = _OWNER.open("a+", encoding="utf-8")
    except OSError as error:
        raise not_writable(str(error.strerror)) from error
    # A dry run may look at the lock for a moment.
    if not _lock(owner, seconds=0.5):
        owner.seek(0)
        process = owner.read().strip() or "unknown"
        raise FolderError(
            f"another run (process {process}) is at work in {Path.cwd()}; wait until it has ended."
        )
    owner.truncate(0)
    owner.write(str(os.getpid()))
    owner.flush()
    _held.append(owner)
    with _JOBS.open("a", encoding="utf-8") as jobs:
        if _lock(jobs):
            return
        sys.stderr.write(
            "Jobs of a run that was killed are still at work; waiting for their end.\n"
        )
        if not _lock(jobs, seconds=_SECONDS_TO_WAIT):
            raise FolderError(
                f"jobs of an earlier run have been at work in {Path.cwd()} for more than "
                f"{_SECONDS_TO_WAIT:.0f} s; end them, or wait."
            )


def claim_results() -> None:
    """Keep runs that start later from changing results here until this process ends.

    Raises `FolderError` if a run other than the one that started this process is at work here.
    """
    hold_job_lock()
    if is_claimed_by_another() and _OWNER.read_text(encoding="utf-8").strip() != str(os.getppid()):
        raise FolderError(f"a run is at work in {Path.cwd()}; wait until it has ended.")


def check_folder(*folders: Path) -> None:
    """Refuse folders with braces in their paths, with a `FolderError`: Snakemake reads braces as wildcards."""
    for folder in folders:
        if {"{", "}"} & {*str(folder)}:
            raise FolderError(
                f"{folder} has a brace in its path, which Snakemake reads as a wildcard; rename or move it."
            )


def check_writable() -> None:
    """Refuse a folder into which this user may not write, with a `FolderError`."""
    if not os.access(Path.cwd(), os.W_OK):
        raise not_writable("permission denied")


def not_writable(reason: str) -> FolderError:
    """Give the error of a folder into which this user may not write."""
    return FolderError(
        f"{Path.cwd()} can't be written ({reason}); `make why` says what would run here. To run the workflow, choose "
        "a folder of your own: snakemake -s PATH/Snakefile -d FOLDER."
    )


@cache
def is_claimed_by_another() -> bool:
    """Whether another run is at work in this folder, as at a dry run beside it; nothing is written."""
    with suppress(OSError), _OWNER.open(encoding="utf-8") as stream:
        return not _lock(stream, shared=True)
    return False


def hold_job_lock() -> None:
    """Let runs that start later wait until this process has ended, even if its own run is killed."""
    with suppress(OSError):
        _held.append(_JOBS.open("a", encoding="utf-8"))
        _lock(_held[-1], shared=True)


def _lock(stream: IO[str], seconds: float = 0, *, shared: bool = False) -> bool:
    """Lock a file for this process; False where others have it locked for so long."""
    limit = time.monotonic() + seconds
    while True:
        try:
            fcntl.flock(stream, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
        except BlockingIOError:
            if time.monotonic() >= limit:
                return False
            time.sleep(0.05)
        except OSError:
            return True  # as if locked, where the file system has no locks
        else:
            return True
