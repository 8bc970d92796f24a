"""Ctrl-C ends a run at any moment, with one line and status 130."""

from __future__ import annotations

import os
import queue
import signal
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any, NoReturn

from visuohaptic.interrupts import (
    CLEAR_LINE,
    STOPPED,
    act_at_interrupt,
    unblock_interrupts,
    wait_for_interrupt,
)

_SECONDS_TO_CLEAN_UP = 5.0
_SECONDS_TO_PRINT = 0.05
"""What another thread has just begun to print comes before the last line."""

_HALT = "SIGUSR2"


class _Run:
    """What is known of the run in this process."""

    waits = False
    is_asked_to_stop = False
    is_interrupted = False
    has_remote_jobs = False
    before_end: tuple[Callable[[], None], ...] = ()


def end_at_ctrl_c() -> None:
    """Let Ctrl-C end Snakemake and its jobs.

    An exception raised in the midst of Snakemake may be swallowed, or leave it waiting for ever.
    So interrupts are blocked here, and another thread takes them; it ends the jobs and then this
    process, which is as safe at any moment as to kill it. Processes that are started from now on
    inherit the block: none is interrupted before `interrupts_tidy_up` was called in it.
    """
    is_ignored = signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    if _Run.waits or is_ignored or sys.platform == "win32":
        return
    import psutil  # noqa: F401 - at the end nothing can be imported that the main thread is importing

    _Run.waits = True
    signal.signal(getattr(signal, _HALT), _halt_main_thread)
    act_at_interrupt(_end)


def before_end(function: Callable[[], None]) -> None:
    """Call a function before Ctrl-C ends this process."""
    _Run.before_end += (function,)


def let_snakemake_cancel_jobs() -> None:
    """Interrupt Snakemake as Python does, as it has jobs on other machines to cancel."""
    _Run.has_remote_jobs = True


def end_at_sigterm(scheduler: Any) -> None:
    """Let a thread of its own tell Snakemake's scheduler of SIGTERM, as `timeout` and clusters send it.

    Snakemake's own handler runs in the main thread and waits for a lock; if the main thread held it
    when the signal came, both wait for ever.
    """
    signals: queue.SimpleQueue[int] = queue.SimpleQueue()  # the one that a handler may write to

    def wait() -> None:
        signals.get()
        scheduler.exit_gracefully()

    threading.Thread(target=wait, daemon=True).start()
    signal.signal(signal.SIGTERM, lambda number, _: signals.put(number))


def end_if_stopped() -> None:
    """End with status 130 where the user asked to stop; Snakemake itself would end with 1.

    Raises
    ------
    SystemExit
        With status 130.
    """
    if _Run.is_asked_to_stop:
        raise SystemExit(STOPPED)


def interrupts_tidy_up() -> None:
    """Interrupt a job as Python does, but let what it tidies up then come to its end."""
    if not _Run.is_interrupted:
        signal.signal(signal.SIGINT, _interrupt_once)
    unblock_interrupts()


def is_interrupted() -> bool:
    """Whether this process was interrupted since `interrupts_tidy_up` was called."""
    return _Run.is_interrupted


def _interrupt_once(*_: object) -> NoReturn:
    _Run.is_interrupted = True
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    raise KeyboardInterrupt


def _end(interrupts: int) -> None:
    _Run.is_asked_to_stop = True
    clear = CLEAR_LINE if sys.stderr.isatty() else ""
    # What fails from now on fails because of the stop.
    shown = os.dup(2)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
    time.sleep(_SECONDS_TO_PRINT)
    os.write(shown, f"{clear}stopped; the same command continues.\n".encode())
    signal.pthread_kill(threading.main_thread().ident or 0, getattr(signal, _HALT))
    if _Run.has_remote_jobs:
        wait_for_interrupt(interrupts)
    else:
        _end_jobs()
    os._exit(STOPPED)


def _halt_main_thread(*_: object) -> None:
    """Go no further: this is where Snakemake starts jobs."""
    if _Run.has_remote_jobs:
        raise KeyboardInterrupt
    threading.Event().wait()


def _end_jobs() -> None:
    import psutil

    interrupted: set[psutil.Process] = set()
    limit = time.monotonic() + _SECONDS_TO_CLEAN_UP
    while jobs := set(psutil.Process().children(recursive=True)):
        for process in jobs - interrupted:
            with suppress(psutil.NoSuchProcess):
                process.send_signal(signal.SIGINT)
        if not interrupted:
            for function in _Run.before_end:
                function()
        interrupted |= jobs
        _, left = psutil.wait_procs(jobs, timeout=0.1)
        for process in left if time.monotonic() > limit else []:
            with suppress(psutil.NoSuchProcess):
                process.kill()
