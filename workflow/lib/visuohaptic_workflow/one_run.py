"""One run at a time in a folder, by a lock that the kernel takes back when its process ends, also where it is killed."""

from __future__ import annotations

import os
import sys
import time
from contextlib import suppress
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
    if _held:
        return
    _held.append(_lock_owner_file())
    with _JOBS.open("a", encoding="utf-8") as stream:
        if _try_lock(stream, seconds=0):
            return
        sys.stderr.write(
            "Jobs of a run that was killed are still at work; waiting for their end.\n"
        )
        if not _try_lock(stream, seconds=_SECONDS_TO_WAIT):
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


def is_claimed_by_another() -> bool:
    """Whether another run is at work in this folder; nothing is written."""
    try:
        with _OWNER.open(encoding="utf-8") as stream:
            return not _try_lock(stream, seconds=0, shared=True)
    except OSError:
        return False


def hold_job_lock() -> None:
    """Let runs that start later wait until this process has ended, even if its own run is killed."""
    with suppress(OSError):
        stream = _JOBS.open("a", encoding="utf-8")
        _held.append(stream)
        _try_lock(stream, seconds=0, shared=True)


def _lock_owner_file() -> IO[str]:
    try:
        STATE.mkdir(exist_ok=True)
        stream = _OWNER.open("a+", encoding="utf-8")
    except OSError as error:
        raise not_writable(str(error.strerror)) from error
    # A dry run may look at the lock for a moment.
    if not _try_lock(stream, seconds=0.5):
        stream.seek(0)
        owner = stream.read().strip() or "unknown"
        stream.close()
        raise FolderInUseError(
            f"another run (process {owner}) is at work in {Path.cwd()}; wait until it has ended."
        )
    stream.truncate(0)
    stream.write(str(os.getpid()))
    stream.flush()
    return stream


def _try_lock(stream: IO[str], seconds: float, *, shared: bool = False) -> bool:
    """Lock a file for this process; False where others have it locked for so long."""
    # Where the file system has no locks, it counts as locked by this process.
    import fcntl

    mode = fcntl.LOCK_SH if shared else fcntl.LOCK_EX
    limit = time.monotonic() + seconds
    while True:
        try:
            fcntl.flock(stream, mode | fcntl.LOCK_NB)
        except BlockingIOError:
            if time.monotonic() >= limit:
                return False
            time.sleep(0.05)
        except OSError:
            return True
        else:
            return True
