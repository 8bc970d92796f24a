"""How SIGTERM ends a run: Snakemake starts no more jobs, and waits for the running ones."""

from __future__ import annotations

import signal
import threading
from types import FrameType

_asked = threading.Event()


def pass_termination_on() -> None:
    """Call the handler of SIGTERM, from now on, in a thread of its own.

    Snakemake's handler waits for a lock that the main thread may hold when the signal interrupts it: it would
    wait for ever.
    """
    handler = signal.getsignal(signal.SIGTERM)

    def pass_on(number: int, frame: FrameType | None) -> None:
        _asked.set()
        if callable(handler):
            threading.Thread(target=handler, args=(number, frame), daemon=True).start()

    signal.signal(signal.SIGTERM, pass_on)


def is_termination_asked() -> bool:
    """Return whether SIGTERM came since `pass_termination_on`."""
    return _asked.is_set()


def end_at_once() -> None:
    """Let SIGTERM end this process at once: no job runs any more."""
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
