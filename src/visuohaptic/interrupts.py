"""Ctrl-C taken by a thread of its own, as commands and runs of the workflow do."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable

STOPPED = 130
"""Status of a command that the user stopped, as shells have it: 128 + SIGINT."""

CLEAR_LINE = "\r\033[K"
"""What a terminal needs before a line that may follow a progress bar."""


def act_at_interrupt(act: Callable[[int], None]) -> None:
    """Let another thread take Ctrl-C, in place of the main thread, which sees nothing of it.

    After the first interrupt it calls `act`; `wait_for_interrupt` of what that is given waits for
    the next. Processes that are started from now on take no interrupt until they unblock it.
    """
    interrupts, notes = os.pipe()
    os.set_blocking(notes, False)
    signal.signal(signal.SIGINT, lambda *_: None)
    # Python notes each signal there at once, whichever thread received it.
    signal.set_wakeup_fd(notes, warn_on_full_buffer=False)
    signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])

    def wait_and_act() -> None:
        unblock_interrupts()
        wait_for_interrupt(interrupts)
        act(interrupts)

    threading.Thread(target=wait_and_act, name="ctrl-c", daemon=True).start()


def wait_for_interrupt(interrupts: int) -> None:
    """Wait for the next Ctrl-C."""
    while os.read(interrupts, 1) != bytes([signal.SIGINT]):
        pass


def unblock_interrupts() -> None:
    """Take interrupts again, which a process does not that was started after `act_at_interrupt`."""
    if sys.platform != "win32":
        signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])
