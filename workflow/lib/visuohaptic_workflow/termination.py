"""End a run after SIGTERM, so that running jobs end and no job starts, and without a traceback at Ctrl-C."""

from __future__ import annotations

import signal
import sys
import threading
from types import FrameType, TracebackType

_received = threading.Event()


def say_stopped_at_interrupt() -> None:
    """Print ``stopped.`` instead of a traceback if Ctrl-C ends this process while it plans the run."""
    inherited = sys.excepthook

    def end(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        if issubclass(kind, KeyboardInterrupt):
            sys.stderr.write("stopped.\n")
        else:
            inherited(kind, error, trace)

    sys.excepthook = end


def pass_termination_on() -> None:
    """Run Snakemake's handler of SIGTERM in a thread.

    The handler waits for a lock. In the main thread, the handler would wait for ever if the signal interrupted the
    owner of the lock.
    """
    handler = signal.getsignal(signal.SIGTERM)

    def pass_on(number: int, frame: FrameType | None) -> None:
        _received.set()
        if callable(handler):
            threading.Thread(target=handler, args=(number, frame), daemon=True).start()

    signal.signal(signal.SIGTERM, pass_on)


def is_termination_received() -> bool:
    """Return whether SIGTERM was received since `pass_termination_on`."""
    return _received.is_set()


def end_at_once() -> None:
    """Let SIGTERM end this process at once, after all jobs have ended."""
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
