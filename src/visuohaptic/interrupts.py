"""Ctrl-C taken by a thread of its own, as commands do."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable

STOPPED = 130
"""Status of a command that the user stopped, as shells have it: 128 + SIGINT."""

CLEAR_LINE = "\r\033[K"
"""What a terminal needs before a line that may follow a progress bar."""


def act_at_interrupt(act: Callable[[], None]) -> None:
    """Let another thread take the first Ctrl-C, in place of the main thread, which sees nothing of it.

    Processes that are started from now on take no interrupt.
    """
    interrupts, notes = os.pipe()
    os.set_blocking(notes, False)
    signal.signal(signal.SIGINT, lambda *_: None)
    # Python notes each signal there at once, whichever thread received it.
    signal.set_wakeup_fd(notes, warn_on_full_buffer=False)
    signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])

    def wait_and_act() -> None:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])
        while os.read(interrupts, 1) != bytes([signal.SIGINT]):
            pass
        act()

    threading.Thread(target=wait_and_act, name="ctrl-c", daemon=True).start()
