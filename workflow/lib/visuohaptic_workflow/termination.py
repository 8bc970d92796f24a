"""End a run after SIGTERM: Snakemake starts no further jobs, and waits for running jobs."""

from __future__ import annotations

import signal
import threading
from types import FrameType

_received = threading.Event()


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
