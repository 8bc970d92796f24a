"""One run at a time in a folder: Snakemake's locks, and DVC's.

Snakemake leaves its lock behind when it is killed, and asks for `--unlock`; DVC deletes the outputs
of a stage without asking. A file that the kernel locks as long as a process lives shows
whether a run is active, also after earlier runs were killed.
"""

from __future__ import annotations

import atexit
import json
import os
import shutil
import sys
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import IO, Any

from visuohaptic.errors import VisuohapticError
from visuohaptic_workflow.stopping import before_end

STATE = Path(".snakemake")
DVC_STATE = Path(".dvc/tmp")

_OWNER = STATE / "run.lock"
_JOBS = STATE / "jobs.lock"
_SNAKEMAKE_LOCKS = STATE / "locks"
_SECONDS_TO_WAIT = 60.0
_held: list[IO[str]] = []


class FolderInUseError(VisuohapticError):
    """Another process is at work on the same results, or this one may not write them."""


def claim_folder(outputs: Iterable[str]) -> None:
    """Let this process be the only one that makes results in this folder, until it ends.

    A lock of Snakemake that a killed run has left is removed, with a sentence. `dvc repro`, which
    would delete what this run makes, finds the outputs locked. A run that DVC itself started
    relies on DVC's own locks.

    Parameters
    ----------
    outputs : iterable of str
        Folders that the run writes, relative to this one.

    Raises
    ------
    FolderInUseError
        If another run or `dvc` is at work here, or the folder can't be written.
    """
    if _held:
        return
    _held.append(_lock_owner_file())
    _wait_for_jobs_of_killed_runs()
    if _SNAKEMAKE_LOCKS.is_dir() and any(_SNAKEMAKE_LOCKS.iterdir()):
        _remove_snakemake_locks()
        sys.stderr.write("An earlier run was killed and left its lock; the lock is removed.\n")
    before_end(_remove_snakemake_locks)
    if "DVC_STAGE" not in os.environ and DVC_STATE.parent.is_dir():
        _lock_for_dvc(outputs)


def _remove_snakemake_locks() -> None:
    shutil.rmtree(_SNAKEMAKE_LOCKS, ignore_errors=True)


def check_writable() -> None:
    """Refuse a folder into which Snakemake can't write its notes.

    Raises
    ------
    FolderInUseError
        If this user may not write here.
    """
    if not os.access(STATE if STATE.exists() else Path.cwd(), os.W_OK):
        raise FolderInUseError(_not_writable("permission denied"))


def _not_writable(reason: str) -> str:
    return (
        f"{Path.cwd()} can't be written ({reason}); run the workflow in a folder of your own: "
        "snakemake -s PATH/Snakefile -d FOLDER."
    )


def is_claimed_by_another() -> bool:
    """Whether another run is at work in this folder; nothing is written."""
    try:
        with _OWNER.open(encoding="utf-8") as stream:
            return not _try_lock(stream, seconds=0, shared=True)
    except OSError:
        return False


@cache  # a block runs many scripts in one process
def hold_job_lock() -> None:
    """Let runs that start later wait until this process has ended, even if its own run is killed."""
    with suppress(OSError):
        stream = _JOBS.open("a", encoding="utf-8")
        _held.append(stream)
        _try_lock(stream, seconds=0, shared=True)


def _wait_for_jobs_of_killed_runs() -> None:
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


def _try_lock(stream: IO[str], seconds: float, *, shared: bool = False) -> bool:
    """Lock a file for this process; False where others have it locked for so long.

    Where the file system has no locks, it counts as locked by this process.
    """
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


def _lock_owner_file() -> IO[str]:
    try:
        STATE.mkdir(exist_ok=True)
        stream = _OWNER.open("a+", encoding="utf-8")
    except OSError as error:
        raise FolderInUseError(_not_writable(str(error.strerror))) from error
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


def _lock_for_dvc(outputs: Iterable[str]) -> None:
    """Enter the outputs into DVC's table of locks, as DVC's own commands do."""
    mine = {"pid": os.getpid(), "cmd": "snakemake"}
    paths = [os.path.abspath(folder) for folder in outputs]  # noqa: PTH100 - as DVC writes them
    with _dvc_locks() as locks:
        for path, infos in [*locks["write"].items(), *locks["read"].items()]:
            for info in [infos] if isinstance(infos, dict) else infos:
                if any(_overlap(path, own) for own in paths) and _is_alive(info["pid"]):
                    raise FolderInUseError(
                        f"{info['cmd']} (process {info['pid']}) is at work on {path}; wait until "
                        "it has ended."
                    )
        locks["write"].update(dict.fromkeys(paths, mine))
    atexit.register(_release_for_dvc, os.getpid(), mine)


def _release_for_dvc(owner: int, mine: dict[str, Any]) -> None:
    if os.getpid() != owner:  # a fork has nothing to release
        return
    with suppress(OSError, FolderInUseError), _dvc_locks() as locks:
        locks["write"] = {path: info for path, info in locks["write"].items() if info != mine}


@contextmanager
def _dvc_locks() -> Iterator[dict[str, dict[str, Any]]]:
    """Give DVC's table of locks, and write it back."""
    import fcntl

    DVC_STATE.mkdir(parents=True, exist_ok=True)
    table = DVC_STATE / "rwlock"
    with (DVC_STATE / "rwlock.lock").open("a") as guard:
        fcntl.flock(guard, fcntl.LOCK_EX)
        try:
            locks = json.loads(table.read_text(encoding="utf-8"))
        except FileNotFoundError:
            locks = {}
        except ValueError as error:
            raise FolderInUseError(
                f"{table} is damaged ({error}); delete it if no dvc command is running."
            ) from error
        locks = {"write": locks.get("write", {}), "read": locks.get("read", {})}
        yield locks
        table.write_text(json.dumps(locks), encoding="utf-8")


def _overlap(one: str, other: str) -> bool:
    return one == other or one.startswith(other + os.sep) or other.startswith(one + os.sep)


def _is_alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True
