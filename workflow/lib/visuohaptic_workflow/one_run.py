"""One run at a time in a folder, by a lock that the kernel takes back when its process ends, also where it is killed."""

from __future__ import annotations

import os
import sys
import time
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import IO

from visuohaptic.errors import VisuohapticError

STATE = Path(".cache")
_OWNER = STATE / "run.lock"
_JOBS = STATE / "jobs.lock"
_SECONDS_TO_WAIT = 60.0
_held: list[IO[str]] = []


class FolderInUseError(VisuohapticError):
    """Another run is at work on the same results, or this one may not write them."""


def claim_folder() -> None:
    """Let this process be the only one that makes results in this folder, until it ends.

    Raises `FolderInUseError` if another run, or the jobs of one that was killed, are at work here.
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
        raise FolderInUseError(
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
            raise FolderInUseError(
                f"jobs of an earlier run have been at work in {Path.cwd()} for more than "
                f"{_SECONDS_TO_WAIT:.0f} s; end them, or wait."
            )


def check_writable() -> None:
    """Refuse a folder into which this user may not write, with a `FolderInUseError`."""
    if not os.access(Path.cwd(), os.W_OK):
        raise not_writable("permission denied")


def not_writable(reason: str) -> FolderInUseError:
    """Give the error of a folder into which this user may not write."""
    return FolderInUseError(
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
    import fcntl

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
